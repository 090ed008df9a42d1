// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_evidence.h"

#include <stdlib.h>

void plan_evidence_finish(struct plan_evidence *evidence)
{
    audit_pool_finish(&evidence->pool);
    for (int i = 0; i < evidence->view_count; i++) {
        image_finish(&evidence->views[i].finer);
        image_finish(&evidence->views[i].coarser);
    }
    *evidence = (struct plan_evidence){0};
}

const struct plan_view *plan_evidence_find(const struct plan_evidence *evidence, int32_t frame)
{
    const struct plan_view *nearest = NULL;

    for (int i = 0; i < evidence->view_count; i++) {
        const struct plan_view *view = &evidence->views[i];

        if (!nearest || labs((long)view->frame - frame) < labs((long)nearest->frame - frame)) nearest = view;
    }
    return nearest;
}
