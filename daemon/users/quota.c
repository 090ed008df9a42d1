// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/quota.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static_assert((int64_t)FRAME_COUNT_LIMIT <= INT64_MAX / JOB_PIXEL_LIMIT, "a job's pixels fit into int64_t");

void quota_finish(struct quota *quota)
{
    for (size_t i = 0; i < quota->count; i++) {
        free(quota->users[i]->name);
        free(quota->users[i]);
    }
    free(quota->users);
    *quota = (struct quota){0};
}

// The index of the user, or where to insert it.
static size_t find_index(const struct quota *quota, int64_t uid)
{
    size_t low = 0, high = quota->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;

        if (quota->users[middle]->uid < uid)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

struct quota_user *quota_find_user(struct quota *quota, int64_t uid, const char *name)
{
    size_t index = find_index(quota, uid);
    struct quota_user *user;

    if (index == quota->count || quota->users[index]->uid != uid) {
        quota->users = xgrow(quota->users, &quota->capacity, quota->count + 1, sizeof(struct quota_user *));
        memmove(&quota->users[index + 1], &quota->users[index], (quota->count - index) * sizeof(struct quota_user *));
        quota->users[index] = xcalloc(1, sizeof **quota->users);
        quota->users[index]->uid = uid;
        quota->count++;
    }
    user = quota->users[index];
    if (!user->name || strcmp(user->name, name) != 0) {
        free(user->name);
        user->name = xstrdup(name);
    }
    return user;
}

void quota_set(struct quota_user *user, struct quota_amounts *share, struct quota_amounts now)
{
    user->has.jobs += now.jobs - share->jobs;
    user->has.frames += now.frames - share->frames;
    user->has.pixels += now.pixels - share->pixels;
    user->has.disk_bytes += now.disk_bytes - share->disk_bytes;
    *share = now;
}

// Computes no sum that could overflow.
static bool is_too_much(int64_t limit, int64_t has, int64_t added)
{
    return limit > 0 && added > 0 && (has > limit || added > limit - has);
}

bool quota_check_disk(const struct quota_user *user, const struct quota_amounts *limits, struct error *error)
{
    if (user->is_unlimited || limits->disk_bytes == 0 || user->has.disk_bytes < limits->disk_bytes) return true;
    error_set(error,
              "output: %s may have %" PRId64 " bytes of published files, has %" PRId64
              ": `march delete --files` of a job that is over makes room",
              user->name, limits->disk_bytes, user->has.disk_bytes);
    return false;
}

bool quota_check(const struct quota_user *user, const struct quota_amounts *limits, const struct quota_amounts *added,
                 const char *what, struct error *error)
{
    const struct quota_amounts *has = &user->has;

    if (user->is_unlimited) return true;
    if (is_too_much(limits->jobs, has->jobs, added->jobs)) {
        error_set(error, "jobs: %s may have %" PRId64 " that are not over, has %" PRId64 ", and %s adds %" PRId64,
                  user->name, limits->jobs, has->jobs, what, added->jobs);
        return false;
    }
    if (is_too_much(limits->frames, has->frames, added->frames)) {
        error_set(error, "frames: %s may have %" PRId64 " unfinished frames, has %" PRId64 ", and %s adds %" PRId64,
                  user->name, limits->frames, has->frames, what, added->frames);
        return false;
    }
    if (is_too_much(limits->pixels, has->pixels, added->pixels)) {
        error_set(error,
                  "resolution: %s may have %" PRId64 " pixels of unfinished frames, has %" PRId64
                  ", and %s adds %" PRId64,
                  user->name, limits->pixels, has->pixels, what, added->pixels);
        return false;
    }
    return added->frames == 0 || quota_check_disk(user, limits, error);
}
