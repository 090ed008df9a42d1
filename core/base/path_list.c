// SPDX-License-Identifier: Apache-2.0
#include "core/base/path_list.h"

#include "core/base/alloc.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void path_list_add(struct path_list *list, char *path)
{
    list->paths = xgrow(list->paths, &list->capacity, list->count + 1, sizeof list->paths[0]);
    list->paths[list->count++] = path;
}

void path_list_finish(struct path_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->paths[i]);
    free(list->paths);
    *list = (struct path_list){0};
}

void path_list_format(const struct path_list *list, char *text, size_t size)
{
    size_t length = 0;

    text[0] = '\0';
    for (size_t i = 0; i < list->count && length < size; i++) {
        const char *before = i == 0 ? "" : i + 1 < list->count ? ", " : " or ";

        length += (size_t)snprintf(text + length, size - length, "%s%s", before, list->paths[i]);
    }
}

const char *path_list_find_root(const struct path_list *list, const char *path)
{
    for (size_t i = 0; i < list->count; i++) {
        size_t length = strcmp(list->paths[i], "/") == 0 ? 0 : strlen(list->paths[i]);

        if (strncmp(path, list->paths[i], length) == 0 && path[length] == '/' && path[length + 1])
            return list->paths[i];
    }
    return NULL;
}
