// Writes what can be said of a job's cost without rendering anything.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct job;
struct json_writer;

// Writes the member "counted" of an explanation (docs/protocol.md). The job's method is neither auto nor draft.
void explain_count_write(const struct job *job, struct json_writer *writer);
