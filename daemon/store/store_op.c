// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_op.h"

#include "core/base/alloc.h"

#include <stdlib.h>

struct store_op store_op_reset_frame(int64_t job, int32_t index)
{
    struct store_op op = {.kind = STORE_RESET_FRAMES, .reset = {.job = job, .count = 1}};

    op.reset.indices = xmalloc(sizeof op.reset.indices[0]);
    op.reset.indices[0] = index;
    return op;
}

static void finish_job(struct store_job *job)
{
    free(job->document);
    free(job->name);
    free(job->owner);
    free(job->reason);
    free(job->root);
}

static void finish_token(struct store_token *token)
{
    free(token->hash);
    free(token->name);
    free(token->owner);
    free(token->scope);
}

void store_op_finish(struct store_op *op)
{
    switch (op->kind) {
    case STORE_ADD_JOB:
    case STORE_SET_JOB:
    case STORE_DELETE_JOB:
        finish_job(&op->job);
        break;
    case STORE_SET_FRAME:
        free(op->frame.error);
        break;
    case STORE_ADD_ATTEMPT:
        free(op->attempt.log);
        break;
    case STORE_ADD_PLAN:
        free(op->plan.text);
        break;
    case STORE_SET_ROOT:
        free(op->root.path);
        free(op->root.id);
        break;
    case STORE_ADD_NOTICE:
    case STORE_DROP_NOTICE:
        free(op->notice.event);
        free(op->notice.target);
        free(op->notice.body);
        break;
    case STORE_SET_USAGE:
    case STORE_SET_TOLD:
        break;
    case STORE_SET_TOKEN:
    case STORE_DELETE_TOKEN:
        finish_token(&op->token);
        break;
    case STORE_RESET_FRAMES:
        free(op->reset.indices);
        break;
    case STORE_SET_MARKS:
        free(op->marks.bytes);
        break;
    }
    *op = (struct store_op){0};
}
