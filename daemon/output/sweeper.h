// Removes part files that will not be published, off the loop.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include <uv.h>

struct job_record;
struct sweeper;

// `was_away`: the output root was not there, and nothing could be removed.
typedef void sweeper_on_done(void *user, struct job_record *record, bool was_away);

// `farm` is the farm's id, borrowed.
struct sweeper *sweeper_create(uv_loop_t *loop, const char *farm, sweeper_on_done *on_swept, void *user);
void sweeper_destroy(struct sweeper *sweeper); // legal once idle; accepts NULL
// Removes the part file of one attempt.
void sweeper_remove_part(struct sweeper *sweeper, const struct job_record *record, int32_t frame, int64_t epoch,
                         int attempt);
// Removes every part file of the job from its folder, then calls `on_swept` on the loop.
void sweeper_sweep_job(struct sweeper *sweeper, struct job_record *record);
bool sweeper_is_idle(const struct sweeper *sweeper);

// Whether `name` is "NAME.<farm>.<job>.<epoch>.<attempt>.part", where NAME is a file of the job and the farm is `farm`,
// or is left out, as older versions did.
bool sweeper_is_part_of(const struct job_record *record, const char *farm, const char *name);
