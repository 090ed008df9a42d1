// The files that a job reads: found from the job file's folder, so that who runs the job later need not know it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;

// Makes the paths of `*document` absolute, relative ones from the folder of `job_path` ("-": the current one), and puts
// the text of GLSL files in. What is no job yet is left for job_parse to complain about. Messages name the place in the job.
bool job_inputs_resolve(char **document, const char *job_path, struct error *error);
// Whether the files of all frames (of at most 10,000) are there and may be read. Messages name the place in the job.
bool job_inputs_check(const struct job *job, struct error *error);
