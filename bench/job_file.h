// Jobs of benches, from files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;

// Reads a job, whose files are relative to the folder in which the program runs. The caller finishes it.
bool job_file_load(struct job *job, const char *path, struct error *error);
