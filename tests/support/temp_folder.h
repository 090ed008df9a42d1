// A temporary folder for a test, removed with its contents.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static inline int temp_folder_remove_entry(const char *path, const struct stat *status, int kind, struct FTW *place)
{
    (void)status, (void)kind, (void)place;
    return remove(path);
}

// cmocka's setup and teardown: `*state` is the folder's path.
static inline int temp_folder_create(void **state)
{
    char *path = strdup("/tmp/marchd-test-XXXXXX");

    *state = path;
    return path && mkdtemp(path) ? 0 : -1;
}

static inline int temp_folder_destroy(void **state)
{
    int result = nftw(*state, temp_folder_remove_entry, 16, FTW_DEPTH | FTW_PHYS);

    free(*state);
    return result;
}

// "FOLDER/NAME" in one of a few static buffers.
static inline const char *temp_folder_path(void *const *state, const char *name)
{
    static char paths[4][512];
    static size_t turn;
    char *path = paths[turn++ % 4];

    snprintf(path, sizeof paths[0], "%s/%s", (const char *)*state, name);
    return path;
}
