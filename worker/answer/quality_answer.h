// A chosen quality as JSON, as a job would state it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct job;
struct job_quality;
struct json_writer;

// Writes one object. The method is one that a plan or a draft chooses.
void quality_answer_write(struct json_writer *writer, const struct job *job, const struct job_quality *quality);
