// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_memory.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// The files where cgroup versions 2 and 1 keep a group's limit. `line_part` is the text between a line's first colon
// and its path.
static const struct {
    const char *line_part, *folder, *file;
} versions[] = {
    {"::", "", "memory.max"},
    {":memory:", "/memory", "memory.limit_in_bytes"},
};

enum { VERSION_COUNT = sizeof versions / sizeof versions[0] };

// The file of a group without a limit contains "max"; a group that does not exist has no file.
static int64_t read_limit(const char *folder, const char *file)
{
    char *path = xasprintf("%s/%s", folder, file);
    int64_t limit = INT64_MAX;
    char *text;
    char *end;

    if (file_read_text(path, 4096, &text, NULL, NULL)) {
        long long number = strtoll(text, &end, 10);

        if (end > text && number > 0) limit = number;
        free(text);
    }
    free(path);
    return limit;
}

// Finds the least limit of `folder` and its parents up to `root`.
static int64_t least_limit(char *folder, size_t root_length, const char *file)
{
    int64_t least = INT64_MAX;

    for (;;) {
        int64_t limit = read_limit(folder, file);
        char *slash = strrchr(folder, '/');

        if (limit < least) least = limit;
        if (!slash || (size_t)(slash - folder) < root_length) return least;
        *slash = '\0';
    }
}

int64_t volume_memory_group_limit(const char *groups, const char *root)
{
    char *text = xstrdup(groups);
    int64_t least = INT64_MAX;
    char *rest = text;
    char *line;

    while ((line = strsep(&rest, "\n"))) {
        char *part = strchr(line, ':');

        for (size_t i = 0; part && i < VERSION_COUNT; i++) {
            size_t part_length = strlen(versions[i].line_part);
            char *folder;
            int64_t limit;

            if (strncmp(part, versions[i].line_part, part_length) != 0) continue;
            folder = xasprintf("%s%s%s", root, versions[i].folder, part + part_length);
            limit = least_limit(folder, strlen(root) + strlen(versions[i].folder), versions[i].file);
            if (limit < least) least = limit;
            free(folder);
        }
    }
    free(text);
    return least;
}

int64_t volume_memory_limit(void)
{
    int64_t machine = (int64_t)sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE);
    int64_t limit = INT64_MAX;
    char *groups;

    if (file_read_text("/proc/self/cgroup", 65536, &groups, NULL, NULL)) {
        limit = volume_memory_group_limit(groups, "/sys/fs/cgroup");
        free(groups);
    }
    return limit < machine ? limit : machine;
}

bool volume_memory_check(int64_t size_bytes, int64_t limit_bytes, struct error *error)
{
    const double gib = 1024.0 * 1024.0 * 1024.0;

    if (size_bytes <= limit_bytes) return true;
    error_set(error, "needs %.3g GiB of memory, %.3g GiB are available", (double)size_bytes / gib,
              (double)limit_bytes / gib);
    return false;
}
