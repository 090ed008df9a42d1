// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/limits.h"

#include "core/base/error.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"

static struct quota_amounts limits_of(const struct farm *farm)
{
    const struct options *options = farm->options;

    return (struct quota_amounts){.jobs = options->user_jobs,
                                  .frames = options->user_frames,
                                  .pixels = options->user_pixels,
                                  .disk_bytes = options->user_disk_bytes};
}

void limits_refresh(struct farm *farm)
{
    rights_init(&farm->rights, farm->rights.daemon_uid, farm->options->admin_group);
    rights_set_web_user(&farm->rights, farm->options->web_user);
    for (size_t i = 0; i < farm->quota.count; i++) {
        struct quota_user *user = farm->quota.users[i];

        user->is_unlimited = rights_user_is_admin(&farm->rights, user->uid, user->name);
    }
}

void limits_count_job(struct farm *farm, struct job_record *record)
{
    const struct queue_job *queued = record->queued;
    bool is_live = queue_job_is_live(queued);
    int64_t frames = is_live ? queued->states.counts[FRAME_QUEUED] + queued->states.counts[FRAME_RUNNING] : 0;

    if (!record->user) record->user = quota_find_user(&farm->quota, record->owner_uid, record->owner);
    quota_set(record->user, &record->share,
              (struct quota_amounts){.jobs = is_live,
                                     .frames = frames,
                                     .pixels = frames * record->facts.frame_pixels,
                                     .disk_bytes = record->disk_bytes});
}

void limits_forget_job(struct job_record *record)
{
    if (record->user) quota_set(record->user, &record->share, (struct quota_amounts){0});
}

struct quota_user *limits_find_user(struct farm *farm, const struct rights_peer *peer, const char *name)
{
    struct quota_user *user = quota_find_user(&farm->quota, peer->uid, name);

    if (!peer->is_ordinary) user->is_unlimited = rights_is_admin(&farm->rights, peer);
    return user;
}

bool limits_check_submit(const struct farm *farm, const struct quota_user *user, const struct quota_amounts *job,
                         struct error *error)
{
    const struct quota_amounts limits = limits_of(farm);

    return quota_check(user, &limits, job, "this job", error);
}

bool limits_check_retry(const struct farm *farm, const struct job_record *record, int64_t frames, bool by_admin,
                        struct error *error)
{
    const struct quota_amounts limits = limits_of(farm);
    const struct quota_amounts added = {
        .jobs = !queue_job_is_live(record->queued), .frames = frames, .pixels = frames * record->facts.frame_pixels};

    if (frames == 0) return true;
    return by_admin ? quota_check_disk(record->user, &limits, error)
                    : quota_check(record->user, &limits, &added, "this retry", error);
}

bool limits_check_disk(const struct farm *farm, const struct job_record *record, struct error *error)
{
    const struct quota_amounts limits = limits_of(farm);

    return quota_check_disk(record->user, &limits, error);
}
