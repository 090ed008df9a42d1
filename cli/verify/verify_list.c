// SPDX-License-Identifier: Apache-2.0
#include "cli/verify/verify_list.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/frame_range.h"
#include "core/job/output_path.h"

#include <dirent.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool ends_in(const char *text, const char *end)
{
    size_t length = strlen(text), end_length = strlen(end);

    return length > end_length && strcmp(text + length - end_length, end) == 0;
}

static void add_file(struct verify_list *list, const char *name)
{
    list->files = xgrow(list->files, &list->capacity, list->count + 1, sizeof *list->files);
    list->files[list->count++] = (struct verify_file){.name = xstrdup(name), .frame = -1};
}

bool verify_list_read(struct verify_list *list, const char *folder, struct error *error)
{
    const struct dirent *entry;
    DIR *directory;

    *list = (struct verify_list){.folder = realpath(folder, NULL)};
    directory = list->folder ? opendir(list->folder) : NULL;
    if (!directory) {
        error_set_errno(error, errno, "%s", folder);
        verify_list_finish(list);
        return false;
    }
    while ((entry = readdir(directory))) {
        if (ends_in(entry->d_name, ".part"))
            list->part_count++;
        else if (ends_in(entry->d_name, ".exr"))
            add_file(list, entry->d_name);
    }
    closedir(directory);
    return true;
}

static void finish_file(struct verify_file *file)
{
    free(file->name);
    free(file->wrong);
}

void verify_list_keep(struct verify_list *list, const struct output_path *path, const struct frame_range *range)
{
    size_t kept = 0;

    for (size_t i = 0; i < list->count; i++) {
        struct verify_file *file = &list->files[i];

        file->frame = output_path_frame_of(path, file->name);
        if (file->frame >= 0 && frame_range_index(range, file->frame) >= 0)
            list->files[kept++] = *file;
        else
            finish_file(file);
    }
    list->count = kept;
}

void verify_list_finish(struct verify_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        finish_file(&list->files[i]);
    free(list->files);
    free(list->folder);
    *list = (struct verify_list){0};
}

void verify_file_blame(struct verify_file *file, const char *format, ...)
{
    char *before = file->wrong, *added = NULL;
    va_list arguments;

    va_start(arguments, format);
    if (vasprintf(&added, format, arguments) < 0) abort();
    va_end(arguments);
    file->wrong = before ? xasprintf("%s; %s", before, added) : xstrdup(added);
    free(added);
    free(before);
}
