// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/submit_checks.h"

#include "core/job/job.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/after_desk.h"
#include "daemon/requests/request.h"

bool submit_checks_peer(struct request *request)
{
    if (rights_is_known(&request->client->peer)) return true;
    request_fail(request, MESSAGE_CODE_NOT_ALLOWED,
                 "the system does not say who you are (user %s): the job would have no owner", request->client->user);
    return false;
}

// A worker may write to everything below its job's folder. In the root itself that would be the files of all users.
bool submit_checks_folder(struct request *request, const struct job *job, const char *root)
{
    if (*job->output.path.folder || rights_is_admin(&request->farm->rights, &request->client->peer)) return true;
    request_fail(
        request, MESSAGE_CODE_NOT_ALLOWED,
        "output.path: expected a folder below %s, as in \"first/first.####.exr\": files in the root itself are "
        "for administrators",
        root);
    return false;
}

bool submit_checks_after(struct request *request, const struct job *job)
{
    request->code = MESSAGE_CODE_NOT_FOUND;
    return after_desk_check(request->farm, &job->after, &request->error);
}

bool submit_checks_targets(struct request *request, const struct job *job)
{
    request->code = MESSAGE_CODE_CONFLICT;
    return notice_targets_check(&request->farm->targets, &job->notify, &request->error);
}
