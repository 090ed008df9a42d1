// What each user has on the farm, and whether more would be too much: sums and words, nothing else.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

// As limits, 0 is none. No sum overflows: a frame takes 16 bytes of memory and has at most 2^26 pixels, so that 2^63
// pixels are more memory than there is.
struct quota_amounts {
    int64_t jobs;       // that are not over
    int64_t frames;     // of those, not done yet
    int64_t pixels;     // of those frames
    int64_t disk_bytes; // of files published for jobs that are known, over or not
};

struct quota_user {
    int64_t uid;
    char *name;               // owned; as it was last seen
    bool is_unlimited;        // as it was last seen
    struct quota_amounts has; // what all shares sum up to
};

// The zero value is empty. Ascending by uid.
struct quota {
    struct quota_user **users; // owned; each lives as long as this
    size_t count, capacity;
};

void quota_finish(struct quota *quota);
// Made when it is not there.
struct quota_user *quota_find_user(struct quota *quota, int64_t uid, const char *name);
// What one job has of the sums becomes `now`.
void quota_set(struct quota_user *user, struct quota_amounts *share, struct quota_amounts now);

// Whether the user may have that much more; the message says of what, how much they may have, how much they have and how
// much `what` ("this job") adds. Of what is not added nothing is asked.
bool quota_check(const struct quota_user *user, const struct quota_amounts *limits, const struct quota_amounts *added,
                 const char *what, struct error *error);
// Whether there is room for another file.
bool quota_check_disk(const struct quota_user *user, const struct quota_amounts *limits, struct error *error);
