// Small allocations that end the program when memory is out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

void *xmalloc(size_t size_bytes) __attribute__((malloc));
void *xcalloc(size_t count, size_t size_bytes) __attribute__((malloc));
void *xrealloc(void *memory, size_t size_bytes);
char *xstrdup(const char *text) __attribute__((malloc));
char *xstrndup(const char *text, size_t length) __attribute__((malloc));
char *xasprintf(const char *format, ...) __attribute__((malloc, format(printf, 1, 2)));

// Asks the system for large pages, of 2 MiB on most machines, below what is large enough for them. Memory that is new
// to the process is then much cheaper to touch first. Does nothing where there are none.
void alloc_prefer_large_pages(void *memory, size_t size_bytes);

// Makes room for `wanted` elements in a growing array: doubles *capacity until it suffices.
void *xgrow(void *array, size_t *capacity, size_t wanted, size_t element_size_bytes);
