// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { LARGE_BYTES = 4 << 20 }; // holds a large page wherever it begins

static void *check(void *memory)
{
    if (!memory) {
        fputs("out of memory\n", stderr);
        abort();
    }
    return memory;
}

void alloc_prefer_large_pages(void *memory, size_t size_bytes)
{
    size_t page, before;

    if (!memory || size_bytes < LARGE_BYTES) return;
    page = (size_t)sysconf(_SC_PAGESIZE);
    before = (page - (uintptr_t)memory % page) % page;
    madvise((char *)memory + before, size_bytes - before, MADV_HUGEPAGE);
}

void *xmalloc(size_t size_bytes)
{
    void *memory = check(malloc(size_bytes ? size_bytes : 1));

    alloc_prefer_large_pages(memory, size_bytes);
    return memory;
}

void *xcalloc(size_t count, size_t size_bytes)
{
    void *memory = check(calloc(count ? count : 1, size_bytes ? size_bytes : 1));

    alloc_prefer_large_pages(memory, count * size_bytes);
    return memory;
}

void *xrealloc(void *memory, size_t size_bytes)
{
    return check(realloc(memory, size_bytes ? size_bytes : 1));
}

char *xstrdup(const char *text)
{
    return check(strdup(text));
}

char *xstrndup(const char *text, size_t length)
{
    return check(strndup(text, length));
}

char *xasprintf(const char *format, ...)
{
    char *text = NULL;
    va_list arguments;

    va_start(arguments, format);
    if (vasprintf(&text, format, arguments) < 0) text = NULL;
    va_end(arguments);
    return check(text);
}

void *xgrow(void *array, size_t *capacity, size_t wanted, size_t element_size_bytes)
{
    size_t grown = *capacity ? *capacity : 8;

    if (wanted <= *capacity) return array;
    while (grown < wanted)
        grown = grown > SIZE_MAX / 2 ? wanted : grown * 2;
    if (grown > SIZE_MAX / element_size_bytes) check(NULL);
    array = xrealloc(array, grown * element_size_bytes);
    *capacity = grown;
    return array;
}
