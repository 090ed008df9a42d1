// What no single value of a job shows: geometry and phase weights at the frames, and whether the method suits the scene.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_node;

// All of `job` but its hash is read from `document`, which messages name places in.
bool job_check(const struct job *job, const struct json_node *document, struct error *error);

// True when a program that runs elsewhere can read what the job reads: files by absolute paths, GLSL as text.
bool job_check_inputs(const struct job *job, const struct json_node *document, struct error *error);
