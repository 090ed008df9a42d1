// What is allowed in a job, but probably not meant.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct job;

typedef void job_warnings_on_found(void *user, const char *text); // names the place, as errors do

// A tolerance that people would call a percent; a medium that no frame shows, where its bounds are known without its
// file, and nothing mirrors it.
void job_warnings_find(const struct job *job, job_warnings_on_found *on_found, void *user);
