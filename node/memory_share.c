// SPDX-License-Identifier: Apache-2.0
#include "node/memory_share.h"

#include "core/base/alloc.h"
#include "core/base/file.h"

#include <stdlib.h>
#include <string.h>

#include <uv.h>

enum { TEXT_LIMIT = 64 * 1024 };

static const double SHARE = 0.9;

// INT64_MAX where the group states none, as the outermost does.
static int64_t read_limit(const char *folder)
{
    char *path = xasprintf("%s/memory.max", folder), *text = NULL, *end;
    int64_t limit = INT64_MAX;

    if (file_read_text(path, TEXT_LIMIT, &text, NULL, NULL)) {
        long long bytes = strtoll(text, &end, 10);

        if (end != text && bytes > 0) limit = bytes;
    }
    free(text);
    free(path);
    return limit;
}

int64_t memory_share_find_limit(const char *membership, const char *mount)
{
    const char *line = strncmp(membership, "0::/", 4) == 0 ? membership : strstr(membership, "\n0::/");
    int64_t least = INT64_MAX, limit;
    char *folder;

    if (!line) return INT64_MAX;
    line = strchr(line, '/');
    folder = xasprintf("%s%.*s", mount, (int)strcspn(line, "\n"), line);
    while (strlen(folder) >= strlen(mount)) {
        limit = read_limit(folder);
        if (limit < least) least = limit;
        *strrchr(folder, '/') = '\0';
    }
    free(folder);
    return least;
}

int64_t memory_share_find_all(void)
{
    // Of version 1 libuv knows the limit, and of version 2, in some of its releases, that of our own group.
    int64_t bytes = (int64_t)uv_get_total_memory(), limit = INT64_MAX;
    uint64_t constrained = uv_get_constrained_memory();
    char *membership;

    if (file_read_text("/proc/self/cgroup", TEXT_LIMIT, &membership, NULL, NULL))
        limit = memory_share_find_limit(membership, "/sys/fs/cgroup");
    free(membership);
    if (limit < bytes) bytes = limit;
    return constrained > 0 && constrained < (uint64_t)bytes ? (int64_t)constrained : bytes;
}

int64_t memory_share_find(void)
{
    return (int64_t)((double)memory_share_find_all() * SHARE);
}
