// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/index_heap.h"

#include "core/base/alloc.h"

#include <stdlib.h>

void index_heap_finish(struct index_heap *heap)
{
    free(heap->indices);
    *heap = (struct index_heap){0};
}

void index_heap_add(struct index_heap *heap, int32_t index)
{
    size_t at = heap->count++;

    heap->indices = xgrow(heap->indices, &heap->capacity, heap->count, sizeof heap->indices[0]);
    for (; at > 0 && heap->indices[(at - 1) / 2] > index; at = (at - 1) / 2)
        heap->indices[at] = heap->indices[(at - 1) / 2];
    heap->indices[at] = index;
}

bool index_heap_take(struct index_heap *heap, int32_t *index)
{
    size_t at = 0;
    int32_t last;

    if (heap->count == 0) return false;
    *index = heap->indices[0];
    last = heap->indices[--heap->count];
    for (size_t child = 1; child < heap->count; child = 2 * at + 1) {
        if (child + 1 < heap->count && heap->indices[child + 1] < heap->indices[child]) child++;
        if (heap->indices[child] >= last) break;
        heap->indices[at] = heap->indices[child];
        at = child;
    }
    if (heap->count > 0) heap->indices[at] = last;
    return true;
}
