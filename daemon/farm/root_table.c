// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/root_table.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

void root_table_finish(struct root_table *table)
{
    for (size_t i = 0; i < table->count; i++) {
        free(table->roots[i]->path);
        free(table->roots[i]->trouble);
        free(table->roots[i]);
    }
    free(table->roots);
    *table = (struct root_table){0};
}

struct root *root_table_find(const struct root_table *table, const char *path)
{
    for (size_t i = 0; i < table->count; i++)
        if (strcmp(table->roots[i]->path, path) == 0) return table->roots[i];
    return NULL;
}

struct root *root_table_add(struct root_table *table, const char *path)
{
    struct root *root = root_table_find(table, path);

    if (root) return root;
    root = xcalloc(1, sizeof *root);
    root->path = xstrdup(path);
    table->roots = xgrow(table->roots, &table->capacity, table->count + 1, sizeof(struct root *));
    table->roots[table->count++] = root;
    return root;
}

void root_set_trouble(struct root *root, const char *trouble)
{
    char *copy = xstrdup(trouble);

    free(root->trouble);
    root->trouble = copy;
    root->is_there = false;
}

bool root_set_place(struct root *root, const struct root_place *place)
{
    bool is_moved =
        root->place.device != place->device || root->place.inode != place->inode || root->place.mount != place->mount;

    free(root->trouble);
    root->trouble = NULL;
    root->is_there = true;
    root->place = *place;
    if (is_moved) root->generation++;
    return is_moved;
}

char *root_format_reason(const struct root *root)
{
    return xasprintf("paused: %s; the job goes on when the root is back", root->trouble);
}
