// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/root_desks.h"

#include "core/base/alloc.h"
#include "daemon/loop/work_desk.h"

#include <stdlib.h>

struct root_desk {
    const struct root *root; // borrowed
    struct work_desk *desk;  // owned
};

struct root_desks {
    uv_loop_t *loop;        // borrowed
    struct root_desk *list; // owned
    size_t count, capacity;
};

struct root_desks *root_desks_create(uv_loop_t *loop)
{
    struct root_desks *desks = xcalloc(1, sizeof *desks);

    desks->loop = loop;
    return desks;
}

void root_desks_destroy(struct root_desks *desks)
{
    if (!desks) return;
    for (size_t i = 0; i < desks->count; i++)
        work_desk_destroy(desks->list[i].desk);
    free(desks->list);
    free(desks);
}

void root_desks_put(struct root_desks *desks, const struct root *root, struct work_piece *piece)
{
    size_t i = 0;

    while (i < desks->count && desks->list[i].root != root)
        i++;
    if (i == desks->count) {
        desks->list = xgrow(desks->list, &desks->capacity, desks->count + 1, sizeof desks->list[0]);
        desks->list[desks->count++] = (struct root_desk){root, work_desk_create(desks->loop)};
    }
    work_desk_put(desks->list[i].desk, piece);
}
