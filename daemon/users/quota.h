// Sums of what each user has on the farm, and checks against limits. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

// In limits 0 means no limit. Sums do not overflow: a frame takes 16 bytes of memory and has at most 2^26 pixels, so
// 2^63 pixels do not fit into memory.
struct quota_amounts {
    int64_t jobs;       // jobs that are not over
    int64_t frames;     // their frames that are not done
    int64_t pixels;     // pixels of those frames
    int64_t disk_bytes; // published files of all jobs that are not deleted
};

struct quota_user {
    int64_t uid;
    char *name;               // owned; from the latest connection or job
    bool is_unlimited;        // whether they were an administrator at the latest check
    uint64_t pools;           // those that they may use; for the caller
    struct quota_amounts has; // the sum of all shares
};

// Users by ascending uid. The zero value is empty.
struct quota {
    struct quota_user **users; // owned; each lives until quota_finish
    size_t count, capacity;
};

void quota_finish(struct quota *quota);
// Finds or adds the user.
struct quota_user *quota_find_user(struct quota *quota, int64_t uid, const char *name);
// Sets one job's share of the user's sums to `now`.
void quota_set(struct quota_user *user, struct quota_amounts *share, struct quota_amounts now);

// Whether the user may have `added` more. The message names the amount, the limit, what the user has and what `what`
// ("this job") adds. An amount that does not grow is not checked.
bool quota_check(const struct quota_user *user, const struct quota_amounts *limits, const struct quota_amounts *added,
                 const char *what, struct error *error);
// Whether the user may publish another file.
bool quota_check_disk(const struct quota_user *user, const struct quota_amounts *limits, struct error *error);
