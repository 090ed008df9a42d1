// Summarizes a job before it is rendered.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct job;
struct json_writer;

// The job was read with "/" as the output root.
void job_summary_print(const struct job *job);                                     // on stdout
void job_summary_write_members(const struct job *job, struct json_writer *writer); // into an open object
