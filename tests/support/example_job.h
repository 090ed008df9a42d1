// Reads the example jobs of jobs/ as the command line does.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

// Loads jobs/NAME.json, relative input paths from its folder; fails the test when it is wrong. Free with job_finish.
// The quality is that of stated_quality.json beside this file, where it has one: a test of one method states it.
void example_job_load(struct job *job, const char *name);
// The document as it is.
void example_job_load_file(struct job *job, const char *path);
// The same picture at another size, and frame 0 at `time` seconds.
void example_job_shrink(struct job *job, int width_px, int height_px, double time);
