// SPDX-License-Identifier: Apache-2.0
#include "core/scene/file_format.h"

#include "core/base/alloc.h"
#include "core/scene/input_path.h"

#include <stdlib.h>

// Readers are in worker/volume/volume.c (raw and dense grids), worker/sparse/sparse_file.c and
// worker/scene/texture_image.c.
const struct file_format file_formats[] = {
    {.ending = ".raw", .content = FILE_GRID_RAW},
    {.ending = ".nrrd", .content = FILE_GRID_DENSE},
    {.ending = ".nhdr", .content = FILE_GRID_DENSE},
    {.ending = ".nii", .content = FILE_GRID_DENSE},
    {.ending = ".nii.gz", .content = FILE_GRID_DENSE},
    {.ending = ".nvdb", .content = FILE_GRID_SPARSE},
    {.ending = ".vdb", .content = FILE_GRID_SPARSE, .needs_converter = true},
    {.ending = ".png", .content = FILE_IMAGE},
    {.ending = ".exr", .content = FILE_IMAGE, .is_linear = true},
};
const size_t file_format_count = sizeof file_formats / sizeof file_formats[0];

const struct file_format *file_format_find(const char *path)
{
    for (size_t i = 0; i < file_format_count; i++)
        if (input_path_has_ending(path, file_formats[i].ending)) return &file_formats[i];
    return NULL;
}

bool file_format_is(const char *path, unsigned contents)
{
    const struct file_format *format = file_format_find(path);

    return format && (format->content & contents) != 0;
}

char *file_format_list_endings(unsigned contents, const char *word)
{
    char *list = NULL;
    size_t left = 0;

    for (size_t i = 0; i < file_format_count; i++)
        left += (file_formats[i].content & contents) != 0;
    for (size_t i = 0; i < file_format_count; i++) {
        char *longer;

        if ((file_formats[i].content & contents) == 0) continue;
        left--;
        if (!list)
            longer = xstrdup(file_formats[i].ending);
        else if (left > 0)
            longer = xasprintf("%s, %s", list, file_formats[i].ending);
        else
            longer = xasprintf("%s %s %s", list, word, file_formats[i].ending);
        free(list);
        list = longer;
    }
    return list;
}
