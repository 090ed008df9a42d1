// A list of absolute folders, such as the roots that files of jobs may be below.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

// The zero value is empty.
struct path_list {
    char **paths; // owned
    size_t count, capacity;
};

void path_list_add(struct path_list *list, char *path); // takes it over
void path_list_finish(struct path_list *list);          // accepts the empty value

// "/a, /b or /c", as much of it as has room.
void path_list_format(const struct path_list *list, char *text, size_t size);

// The first folder of the list that `path` names something below, by their texts alone; NULL: none. Neither may hold "."
// or ".." or a slash too many.
const char *path_list_find_root(const struct path_list *list, const char *path);
