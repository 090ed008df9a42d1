// Gives memory that was freed back to the system, off the loop.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

#include <uv.h>

struct memory_return;

enum { MEMORY_RETURN_PARSED = 16 }; // bytes that a byte of JSON takes, about, as a tree

// Keeps what threads free in few places, or each of them might keep a tree of 60 MB. To be called before there are
// threads.
void memory_return_prepare(void);
struct memory_return *memory_return_open(uv_loop_t *loop);
void memory_return_close(struct memory_return *memory); // frees itself when the loop has closed its timer; accepts NULL
// Notes that so many bytes were freed, in pieces that the allocator may have kept. A second after there are 16 MiB,
// they go back to the system (malloc_trim).
void memory_return_note(struct memory_return *memory, size_t freed_bytes);
// To be called in a thread that freed so many bytes: gives them back at once where they are as many.
void memory_return_trim(size_t freed_bytes);
