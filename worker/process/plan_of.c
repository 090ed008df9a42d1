// SPDX-License-Identifier: Apache-2.0
#include "worker/process/plan_of.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_check.h"
#include "core/job/plan_json.h"
#include "core/json/json_read.h"
#include "worker/picture/image_exr.h"
#include "worker/process/assignment.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool read_header(const char *path, struct image_exr_facts *facts, struct error *error)
{
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    bool ok;

    if (fd < 0) {
        error_set_errno(error, errno, "cannot open it");
        return false;
    }
    ok = image_exr_read(fd, NULL, facts, 1, error);
    close(fd);
    return ok;
}

static bool check_facts(const struct image_exr_facts *facts, const struct job *job, struct error *error)
{
    if (facts->plan_number == 0 || !facts->quality[0])
        error_set(error, "expected marchd:planNumber and marchd:quality, which frames have whose job states no method");
    else if (strcmp(facts->sequence_hash, job->hash) != 0)
        error_set(error, "marchd:sequenceHash: expected %s, a frame of this job, got %s", job->hash,
                  facts->sequence_hash);
    else if (job->quality.method != JOB_METHOD_AUTO)
        error_set(error, "expected a job that names no method");
    else
        return true;
    return false;
}

static bool read_quality(struct held_job *job, const char *quality, const struct json_node *document,
                         struct error *error)
{
    char *text = xasprintf("{\"quality\":%s}", quality);
    struct cJSON *tree = NULL;
    bool ok = json_parse(&tree, text, strlen(text), error);

    if (ok) {
        struct json_node root = json_node_root(tree);
        struct job planned = job->job;

        ok = plan_quality_from_json(&job->stated, &root, &job->job, error);
        planned.quality = job->stated;
        ok = ok && job_check(&planned, document, error);
    }
    json_delete(tree);
    free(text);
    return ok;
}

bool plan_of_read(struct held_job *job, const struct json_node *document, struct error *error)
{
    struct image_exr_facts facts;

    if (read_header(job->plan_of, &facts, error) && check_facts(&facts, &job->job, error) &&
        read_quality(job, facts.quality, document, error)) {
        job->stated_number = facts.plan_number;
        job->stated_beyond = facts.beyond;
        return true;
    }
    error_prefix(error, "%s", job->plan_of);
    return false;
}
