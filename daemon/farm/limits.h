// Limits of users: counts what each job takes, and checks before a job takes more.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/users/quota.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct farm;
struct job_record;
struct rights_peer;

// Looks up which users are administrators; called at the start and after a reload.
void limits_refresh(struct farm *farm);
// To be called whenever frames of the job changed their states, or its files changed.
void limits_count_job(struct farm *farm, struct job_record *record);
void limits_forget_job(struct job_record *record); // the job is removed

// The owner of a job that is being submitted. What is known of their rights is as this connection has them, unless it
// is one of a token that gives less.
struct quota_user *limits_find_user(struct farm *farm, const struct rights_peer *peer, const char *name);
bool limits_check_submit(const struct farm *farm, const struct quota_user *user, const struct quota_amounts *job,
                         struct error *error);
// To be called before `frames` of the job are queued again. `by_admin` checks the owner's disk limit only.
bool limits_check_retry(const struct farm *farm, const struct job_record *record, int64_t frames, bool by_admin,
                        struct error *error);
// To be called before a paused job goes on: over this limit it would pause again with its next file.
bool limits_check_disk(const struct farm *farm, const struct job_record *record, struct error *error);
