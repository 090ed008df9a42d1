// Removes part files that will not be published, off the loop.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include <uv.h>

struct job_record;
struct sweeper;

typedef void sweeper_on_done(void *user, struct job_record *record);

struct sweeper *sweeper_create(uv_loop_t *loop, sweeper_on_done *on_swept, void *user);
void sweeper_destroy(struct sweeper *sweeper); // legal once idle; accepts NULL
// Removes the part file of one attempt.
void sweeper_remove_part(struct sweeper *sweeper, const struct job_record *record, int32_t frame, int64_t epoch,
                         int attempt);
// Removes every part file of the job from its folder, then calls `on_swept` on the loop.
void sweeper_sweep_job(struct sweeper *sweeper, struct job_record *record);
bool sweeper_is_idle(const struct sweeper *sweeper);

// Whether `name` is "NAME.<job>.<epoch>.<attempt>.part", where NAME is a file of the job.
bool sweeper_is_part_of(const struct job_record *record, const char *name);
