// A list of absolute folders, such as the roots below which the files of jobs may lie.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

// The zero value is empty.
struct path_list {
    char **paths; // owned
    size_t count, capacity;
};

void path_list_add(struct path_list *list, char *path); // takes `path` over
void path_list_finish(struct path_list *list);          // accepts the empty value

// Writes "/a, /b or /c", cut to `size`.
void path_list_format(const struct path_list *list, char *text, size_t size);

// The first folder of the list that contains `path`, compared as text; NULL: none. Neither path may have ".", ".." or
// doubled slashes.
const char *path_list_find_root(const struct path_list *list, const char *path);
