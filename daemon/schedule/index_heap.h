// A binary heap of indices: the smallest is taken first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The zero value is empty.
struct index_heap {
    int32_t *indices; // owned
    size_t count, capacity;
};

void index_heap_finish(struct index_heap *heap);
void index_heap_add(struct index_heap *heap, int32_t index);
bool index_heap_take(struct index_heap *heap, int32_t *index); // false when the heap is empty
