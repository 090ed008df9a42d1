// Resolves the input files of a job relative to the job file, so that the job can run in any folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;

// Makes relative paths in `*document` absolute, starting from the folder of `job_path` ("-": the current folder), and
// inserts the text of GLSL files. Other errors of the job are left to job_parse. Messages name the place in the job.
bool job_inputs_resolve(char **document, const char *job_path, struct error *error);
// Checks that the files of all frames (at most 10,000 of them) exist and may be read. Messages name the place in the
// job.
bool job_inputs_check(const struct job *job, struct error *error);
