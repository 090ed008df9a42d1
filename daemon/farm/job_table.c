// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/job_table.h"

#include "core/base/alloc.h"
#include "core/job/frame_twins.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static void record_destroy(struct job_record *record)
{
    free(record->name);
    free(record->owner);
    job_notes_finish(&record->notes);
    job_notify_finish(&record->notify);
    job_after_finish(&record->after);
    free(record->waiters);
    free(record->root);
    free(record->reason);
    free(record->intents);
    free(record->code);
    free(record->pool);
    output_path_finish(&record->path);
    job_paths_finish(&record->inputs);
    free(record);
}

void job_table_finish(struct job_table *table)
{
    for (size_t i = 0; i < table->count; i++)
        record_destroy(table->records[i]);
    free(table->records);
    free(table->folder_hashes);
    *table = (struct job_table){0};
}

static uint64_t add_to_hash(uint64_t hash, const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        hash = (hash ^ (unsigned char)text[i]) * UINT64_C(0x100000001b3);
    return hash;
}

// Hash of "ROOT/FOLDER", which does not depend on where the root ends. FNV-1a: Fowler, Noll and Vo, 1991.
static uint64_t hash_folder(const char *root, const char *folder)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    size_t length = strlen(root);

    while (length > 0 && root[length - 1] == '/')
        length--;
    hash = add_to_hash(hash, root, length);
    if (*folder) hash = add_to_hash(hash, "/", 1);
    return add_to_hash(hash, folder, strlen(folder));
}

struct job_record *job_table_add(struct job_table *table, int64_t id, char *root, struct output_path *path)
{
    struct job_record *record = xcalloc(1, sizeof *record);

    assert(table->count == 0 || table->records[table->count - 1]->id < id);
    record->id = id;
    record->root = root;
    record->path = *path;
    *path = (struct output_path){0};
    table->records = xgrow(table->records, &table->capacity, table->count + 1, sizeof(struct job_record *));
    table->folder_hashes =
        xgrow(table->folder_hashes, &table->hash_capacity, table->count + 1, sizeof table->folder_hashes[0]);
    table->folder_hashes[table->count] = hash_folder(record->root, record->path.folder);
    table->records[table->count++] = record;
    return record;
}

void job_table_remove(struct job_table *table, struct job_record *record)
{
    size_t i = 0;

    while (table->records[i] != record)
        i++;
    memmove(&table->records[i], &table->records[i + 1], (table->count - i - 1) * sizeof(struct job_record *));
    memmove(&table->folder_hashes[i], &table->folder_hashes[i + 1],
            (table->count - i - 1) * sizeof table->folder_hashes[0]);
    table->count--;
    record->is_removed = true;
    if (record->holds == 0) record_destroy(record);
}

void job_record_hold(struct job_record *record)
{
    record->holds++;
}

void job_record_release(struct job_record *record)
{
    if (--record->holds == 0 && record->is_removed) record_destroy(record);
}

size_t job_table_first_from(const struct job_table *table, int64_t id)
{
    size_t low = 0, high = table->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;

        if (table->records[middle]->id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

struct job_record *job_table_find(const struct job_table *table, int64_t id)
{
    size_t i = job_table_first_from(table, id);

    return i < table->count && table->records[i]->id == id ? table->records[i] : NULL;
}

struct job_facts job_facts_of(const struct job *job)
{
    struct job_facts facts = {.is_draft = job->quality.is_draft,
                              .method = job->quality.method,
                              .frame_pixels = (int64_t)job->width_px * job->height_px,
                              .tolerance = job->quality.tolerance,
                              .frame_limit_ms = (int64_t)(job->frame_limit * 1000)};

    memcpy(facts.hash, job->hash, sizeof facts.hash);
    return facts;
}

struct log_subject job_record_subject(const struct job_record *record)
{
    return (struct log_subject){.job = record->id, .owner = record->owner};
}

void job_record_set_reason(struct job_record *record, const char *reason)
{
    char *copy = reason ? xstrdup(reason) : NULL;

    free(record->reason);
    record->reason = copy;
}

void job_record_note_accuracy(struct job_record *record, const struct frame_accuracy *accuracy)
{
    if (!accuracy->method[0]) return;
    record->latest.error = accuracy->error;
    record->latest.error95 = accuracy->error95;
    memcpy(record->latest.method, accuracy->method, sizeof record->latest.method);
}

void job_record_keep_intent(struct job_record *record, const struct store_frame *row)
{
    record->intents = xgrow(record->intents, &record->intent_capacity, record->intent_count + 1, sizeof *row);
    record->intents[record->intent_count] = *row;
    record->intents[record->intent_count++].error = NULL;
}

struct store_op job_record_format_op(const struct job_record *record)
{
    const struct queue_job *queued = record->queued;
    // Below 0: its end is known, and it is to be swept once its root is there.
    int64_t finished_ms = record->needs_sweep ? -record->finished_ms : record->finished_ms;

    return (struct store_op){
        .kind = STORE_SET_JOB,
        .job = {.id = record->id,
                .priority = queued->priority,
                .is_paused = queued->is_paused,
                .is_canceled = queued->is_canceled,
                .is_failed = queued->is_failed,
                .waits = record->waits,
                .submitted_ms = record->submitted_ms,
                .started_ms = record->started_ms,
                .finished_ms = record->is_swept ? finished_ms : 0,
                .reason = record->reason ? xstrdup(record->reason) : NULL,
                .name = xstrdup(record->name),
                .owner = xstrdup(record->owner),
                .owner_uid = record->owner_uid,
                .root = xstrdup(record->root)},
    };
}

struct job_files job_record_files(const struct job_record *record)
{
    return (struct job_files){record->root, &record->path, &record->queued->frames, NULL};
}

static bool ranges_collide(const struct job_files *files, const struct job_files *others, int32_t *frame)
{
    struct frame_twins twins[FRAME_TWINS_LIMIT];
    size_t count = frame_twins_list(files->path, others->path, twins);
    struct frame_set marks = {0}, *kept = files->marks ? files->marks : &marks;
    bool found = frame_twins_find(twins, count, files->frames, kept, others->frames, frame);

    frame_set_finish(&marks);
    return found;
}

static char *folder_below(const char *root, const char *folder)
{
    return *folder ? xasprintf("%s/%s", root, folder) : xstrdup(root);
}

// Full folders are compared when the roots differ: jobs of an earlier start may have had another root.
static bool may_collide(const struct job_files *files, const struct job_files *others)
{
    struct output_path path = *files->path, other = *others->path;
    bool collides;

    if (strcmp(files->root, others->root) == 0) return output_path_may_collide(&path, &other);
    path.folder = folder_below(files->root, path.folder);
    other.folder = folder_below(others->root, other.folder);
    collides = output_path_may_collide(&path, &other);
    free(path.folder);
    free(other.folder);
    return collides;
}

bool job_files_collide(const struct job_files *files, const struct job_files *others, int32_t *frame)
{
    return may_collide(files, others) && ranges_collide(files, others, frame);
}

// The next record at or after `*index` that writes into the same folder; NULL at the end.
static struct job_record *next_neighbour(const struct job_table *table, uint64_t hash, size_t *index)
{
    while (*index < table->count)
        if (table->folder_hashes[(*index)++] == hash) return table->records[*index - 1];
    return NULL;
}

struct job_record *job_table_next_neighbour(const struct job_table *table, const struct job_files *files, size_t *index)
{
    return next_neighbour(table, hash_folder(files->root, files->path->folder), index);
}

static bool will_change_files(const struct job_record *record)
{
    return queue_job_is_live(record->queued) || record->is_retry_waiting || record->is_deleting;
}

static bool is_ending(const struct job_record *record)
{
    return !will_change_files(record) && record->frames_in_flight > 0;
}

static struct job_record *find_other(const struct job_table *table, const struct job_files *files,
                                     bool is_wanted(const struct job_record *record), int32_t *frame)
{
    uint64_t hash = hash_folder(files->root, files->path->folder);
    struct job_record *record;

    for (size_t i = 0; (record = next_neighbour(table, hash, &i));) {
        const struct job_files others = job_record_files(record);

        if (others.frames != files->frames && is_wanted(record) && job_files_collide(files, &others, frame))
            return record;
    }
    return NULL;
}

struct job_record *job_table_find_collision(const struct job_table *table, const struct job_files *files,
                                            int32_t *frame)
{
    return find_other(table, files, will_change_files, frame);
}

struct job_record *job_table_find_ending(const struct job_table *table, const struct job_files *files, int32_t *frame)
{
    return find_other(table, files, is_ending, frame);
}

struct job_record *job_table_find_owned_files(const struct job_table *table, const struct job_files *files,
                                              int64_t owner_uid, int32_t *frame)
{
    uint64_t hash = hash_folder(files->root, files->path->folder);
    struct job_record *record;

    for (size_t i = 0; (record = next_neighbour(table, hash, &i));) {
        const struct job_files others = job_record_files(record);

        if (record->owner_uid == owner_uid || record->queued->states.counts[FRAME_SUCCEEDED] == 0) continue;
        if (job_files_collide(files, &others, frame)) return record;
    }
    return NULL;
}
