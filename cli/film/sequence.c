// SPDX-License-Identifier: Apache-2.0
#include "cli/film/sequence.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/frame_range.h"
#include "core/job/output_path.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static struct sequence_file *add_file(struct sequence *sequence)
{
    sequence->files = xgrow(sequence->files, &sequence->capacity, sequence->count + 1, sizeof *sequence->files);
    return &sequence->files[sequence->count++];
}

static bool add_single(struct sequence *sequence, const char *operand, struct error *error)
{
    const char *slash = strrchr(operand, '/');
    char *path = realpath(operand, NULL);

    if (!path) {
        error_set_errno(error, errno, "%s", operand);
        return false;
    }
    *add_file(sequence) =
        (struct sequence_file){.path = path, .label = xstrdup(slash ? slash + 1 : operand), .frame = -1};
    return true;
}

static int compare_files(const void *left, const void *right)
{
    const struct sequence_file *a = left, *b = right;

    return (a->frame > b->frame) - (a->frame < b->frame);
}

static bool add_folder(struct sequence *sequence, const char *folder, const struct output_path *pattern,
                       const struct frame_range *range, struct error *error)
{
    char *absolute = realpath(folder, NULL);
    DIR *directory = absolute ? opendir(absolute) : NULL;
    size_t first = sequence->count;
    const struct dirent *entry;

    if (!directory) {
        error_set_errno(error, errno, "%s", folder);
        free(absolute);
        return false;
    }
    while ((entry = readdir(directory))) {
        int32_t frame = output_path_frame_of(pattern, entry->d_name);

        if (frame < 0 || (range && frame_range_index(range, frame) < 0)) continue;
        *add_file(sequence) = (struct sequence_file){
            .path = xasprintf("%s/%s", absolute, entry->d_name), .label = xasprintf("%" PRId32, frame), .frame = frame};
    }
    closedir(directory);
    free(absolute);
    if (sequence->count > first)
        qsort(sequence->files + first, sequence->count - first, sizeof *sequence->files, compare_files);
    return true;
}

// The pattern of a frame's file: the last number of the name is the frame's. False: the name has none.
static bool find_pattern(struct output_path *pattern, const char *name)
{
    size_t length = strlen(name), end = length, start;

    if (length < 4 || strcmp(name + length - 4, ".exr") != 0) return false;
    while (end > 0 && !strchr("0123456789", name[end - 1]))
        end--;
    for (start = end; start > 0 && strchr("0123456789", name[start - 1]);)
        start--;
    if (start == end) return false;
    *pattern =
        (struct output_path){.prefix = xstrndup(name, start), .suffix = xstrdup(name + end), .pad = (int)(end - start)};
    return true;
}

static bool is_same_pattern(const struct output_path *a, const struct output_path *b)
{
    return strcmp(a->prefix, b->prefix) == 0 && strcmp(a->suffix, b->suffix) == 0;
}

// The one pattern that files of the folder have, with the shortest number. Another one is an error.
static bool find_only_pattern(struct output_path *only, const char *operand, DIR *directory, struct error *error)
{
    const struct dirent *entry;
    struct output_path pattern;

    while ((entry = readdir(directory))) {
        bool is_same;

        if (!find_pattern(&pattern, entry->d_name)) continue;
        if (!only->prefix) {
            *only = pattern;
            continue;
        }
        is_same = is_same_pattern(only, &pattern);
        if (is_same && pattern.pad < only->pad) only->pad = pattern.pad;
        if (!is_same)
            error_set(error,
                      "%s: there are several sequences, %s#%s and %s#%s among them: name one, as in \"%s/%s#%s\"",
                      operand, only->prefix, only->suffix, pattern.prefix, pattern.suffix, operand, only->prefix,
                      only->suffix);
        output_path_finish(&pattern);
        if (!is_same) return false;
    }
    if (!only->prefix) error_set(error, "%s: there is no sequence of EXR files", operand);
    return only->prefix;
}

static bool parse_range(struct frame_range *range, const char *text, struct error *error)
{
    if (!text || frame_range_parse(range, text, error)) return true;
    error_prefix(error, "--frames");
    return false;
}

// Takes over `directory`.
static bool add_only_sequence(struct sequence *sequence, const char *operand, DIR *directory, const char *range_text,
                              struct error *error)
{
    struct output_path pattern = {0};
    struct frame_range range = {0};
    size_t before = sequence->count;
    bool ok = parse_range(&range, range_text, error) && find_only_pattern(&pattern, operand, directory, error) &&
              add_folder(sequence, operand, &pattern, range_text ? &range : NULL, error);

    if (ok && sequence->count == before) {
        error_set(error, "%s: none of its files is one of the frames %s", operand, range_text);
        ok = false;
    }
    closedir(directory);
    output_path_finish(&pattern);
    frame_range_finish(&range);
    return ok;
}

static bool add_pattern(struct sequence *sequence, const char *operand, const char *range_text, struct error *error)
{
    const char *slash = strrchr(operand, '/');
    char *folder = slash == operand ? xstrdup("/")
                   : slash          ? xstrndup(operand, (size_t)(slash - operand))
                                    : xstrdup(".");
    struct output_path pattern = {0};
    struct frame_range range = {0};
    size_t before = sequence->count;
    bool ok = false;

    if (!output_path_parse(&pattern, slash ? slash + 1 : operand, error)) {
        error_prefix(error, "%s", operand);
        goto out;
    }
    if (!parse_range(&range, range_text, error)) goto out;
    if (!add_folder(sequence, folder, &pattern, range_text ? &range : NULL, error)) goto out;
    ok = sequence->count > before;
    if (!ok) error_set(error, "%s: no such files", operand);
out:
    output_path_finish(&pattern);
    frame_range_finish(&range);
    free(folder);
    return ok;
}

bool sequence_add(struct sequence *sequence, const char *operand, const char *range, struct error *error)
{
    const char *slash = strrchr(operand, '/');
    const char *name = slash ? slash + 1 : operand;
    DIR *directory;

    if (strchr(name, '#') || strchr(name, '%')) return add_pattern(sequence, operand, range, error);
    directory = opendir(operand);
    return directory ? add_only_sequence(sequence, operand, directory, range, error)
                     : add_single(sequence, operand, error);
}

void sequence_finish(struct sequence *sequence)
{
    for (size_t i = 0; i < sequence->count; i++) {
        free(sequence->files[i].path);
        free(sequence->files[i].label);
    }
    free(sequence->files);
    memset(sequence, 0, sizeof *sequence);
}
