// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/output_older.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/farm/job_table.h"
#include "daemon/output/picture_version.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    STEP_NAMES = 2048, // of files, compared with those of one job: 0.4 us each
    NAMED_LIMIT = 64,  // so many frames are looked for by name, more in the folder's list
    LOOK_LIMIT = 64
};

#define REMEDY                                                                                                         \
    "\"existing\": \"overwrite\" in output replaces them (--set output.existing=overwrite); or write elsewhere"

// Drafts are there to be replaced.
static bool has_pictures(const struct job_record *record)
{
    const int64_t *counts = record->queued->states.counts;

    return !record->facts.is_draft && counts[FRAME_SUCCEEDED] + counts[FRAME_SKIPPED] > 0;
}

bool output_older_is_likely(const struct job_table *table, const struct job_files *files, const char *hash)
{
    const struct job_record *record;
    int32_t frame;

    for (size_t i = 0; (record = job_table_next_neighbour(table, files, &i));) {
        const struct job_files others = job_record_files(record);

        if (has_pictures(record) && strcmp(record->facts.hash, hash) != 0 && job_files_collide(files, &others, &frame))
            return true;
    }
    return false;
}

void output_older_begin(struct output_older *older, const struct job_table *table, const struct job_files *files,
                        const char *hash)
{
    *older =
        (struct output_older){.files = files, .hash = hash, .is_unknown = !output_older_is_likely(table, files, hash)};
}

static void list_by_name(struct output_older *older, int folder)
{
    const struct job_files *files = older->files;
    int64_t total = frame_range_count(files->frames);
    char name[OUTPUT_NAME_SIZE];

    older->frames = xcalloc((size_t)total, sizeof older->frames[0]);
    for (int64_t i = 0; i < total; i++) {
        int32_t frame = frame_range_at(files->frames, i);

        output_path_format_name(files->path, frame, name);
        if (faccessat(folder, name, F_OK, AT_SYMLINK_NOFOLLOW) == 0) older->frames[older->count++] = frame;
    }
}

static void list_folder(struct output_older *older, int folder)
{
    int own = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC); // which begins at the first entry
    DIR *directory = own >= 0 ? fdopendir(own) : NULL;
    const struct dirent *entry;
    size_t capacity = 0;

    while (directory && (entry = readdir(directory))) {
        int32_t frame = output_path_frame_of(older->files->path, entry->d_name);

        if (frame < 0 || frame_range_index(older->files->frames, frame) < 0) continue;
        older->frames = xgrow(older->frames, &capacity, older->count + 1, sizeof older->frames[0]);
        older->frames[older->count++] = frame;
    }
    if (directory)
        closedir(directory);
    else if (own >= 0)
        close(own);
}

static void look(struct output_older *older, int folder)
{
    size_t looks = older->count < LOOK_LIMIT ? older->count : LOOK_LIMIT;
    struct picture_version version;
    char name[OUTPUT_NAME_SIZE];

    for (size_t i = 0; i < looks; i++) {
        int32_t frame = older->frames[i * older->count / looks];

        output_path_format_name(older->files->path, frame, name);
        if (!picture_version_read(&version, folder, name) || version.is_draft || strcmp(version.hash, older->hash) == 0)
            continue;
        if (older->seen++ == 0 || frame < older->first_seen) older->first_seen = frame;
    }
}

void output_older_list(struct output_older *older, int folder)
{
    if (frame_range_count(older->files->frames) <= NAMED_LIMIT)
        list_by_name(older, folder);
    else
        list_folder(older, folder);
    look(older, folder);
}

static bool has_published(const struct job_record *record, const struct job_files *files, int32_t frame)
{
    char name[OUTPUT_NAME_SIZE];
    int64_t index;
    int state;

    output_path_format_name(files->path, frame, name);
    frame = output_path_frame_of(&record->path, name);
    index = frame >= 0 ? frame_range_index(&record->queued->frames, frame) : -1;
    if (index < 0) return false;
    state = frame_states_get(&record->queued->states, index);
    return state == FRAME_SUCCEEDED || state == FRAME_SKIPPED;
}

// Jobs that may have published files, the latest first. Owned by the caller.
static const struct job_record **list_publishers(const struct job_table *table, const struct job_files *files,
                                                 size_t *count)
{
    const struct job_record **list = NULL, *record;
    size_t capacity = 0;

    *count = 0;
    for (size_t i = 0; (record = job_table_next_neighbour(table, files, &i));) {
        size_t at;

        if (!has_pictures(record)) continue;
        list = xgrow(list, &capacity, *count + 1, sizeof(struct job_record *));
        for (at = (*count)++; at > 0 && list[at - 1]->finished_ms <= record->finished_ms; at--)
            list[at] = list[at - 1];
        list[at] = record;
    }
    return list;
}

static void note_replaced(struct output_older *older, int32_t frame, const struct job_record *publisher)
{
    if (older->replaced++ > 0 && frame > older->first) return;
    older->first = frame;
    if (older->job == publisher->id) return;
    older->job = publisher->id;
    free(older->name);
    older->name = xstrdup(publisher->name);
}

bool output_older_step(struct output_older *older, const struct job_table *table)
{
    size_t publisher_count, names = 0;
    const struct job_record **publishers;

    if (older->is_unknown) return false;
    publishers = list_publishers(table, older->files, &publisher_count);
    for (; older->next < older->count && names < STEP_NAMES; older->next++) {
        int32_t frame = older->frames[older->next];
        size_t k = 0;

        while (k < publisher_count && !has_published(publishers[k], older->files, frame))
            k++;
        names += k + 1;
        if (k < publisher_count && strcmp(publishers[k]->facts.hash, older->hash) != 0)
            note_replaced(older, frame, publishers[k]);
    }
    free(publishers);
    return older->next < older->count;
}

static bool check_seen(const struct output_older *older, struct error *error)
{
    char name[OUTPUT_NAME_SIZE];

    if (older->seen == 0) return true;
    output_path_format_name(older->files->path, older->first_seen, name);
    error_set(error,
              "output.path: %s%s would be replaced, which march render or a job that was deleted made and which differ "
              "from what this job renders: " REMEDY,
              name, older->seen > 1 ? " and others" : "");
    return false;
}

bool output_older_check(const struct output_older *older, struct error *error)
{
    char name[OUTPUT_NAME_SIZE], others[48] = "";

    if (older->replaced == 0) return check_seen(older, error);
    output_path_format_name(older->files->path, older->first, name);
    if (older->replaced > 1) snprintf(others, sizeof others, " and %zu more", older->replaced - 1);
    error_set(
        error,
        "output.path: %s%s would be replaced, which job %lld (\"%s\") published and which differ from what this job "
        "renders: " REMEDY,
        name, others, (long long)older->job, older->name);
    return false;
}

void output_older_finish(struct output_older *older)
{
    free(older->frames);
    free(older->name);
    *older = (struct output_older){0};
}
