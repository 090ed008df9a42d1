// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/brick_store.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/sparse/brick_atlas.h"
#include "worker/sparse/sparse_file.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/sparse/transfer_function.h"

#include <errno.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Room for every medium of a frame, and for those of the next frame.
enum { ENTRY_LIMIT = 16, WAITING_LIMIT = 8 };

// Limits the grids that no frame uses.
static const size_t idle_bytes_limit = (size_t)1 << 30;

struct entry {
    struct brick_volume volume; // first: a volume's address is its entry's
    char *key;                  // owned
    struct brick_atlas *atlas;  // owned; NULL: it could not be read
    struct error error;         // why
    bool is_settled;            // a write after the reading would change the version
    bool is_read;
    int taken;
    uint64_t used; // the moment of the last use; larger is later
};

struct waiting {
    char *path, *density_name, *glow_name; // owned
    struct scene_transfer_point *points;   // owned
    size_t point_count;
};

struct brick_store {
    pthread_mutex_t lock; // guards all that follows, except the contents of an entry that is being read
    pthread_cond_t changed;
    struct entry *entries[ENTRY_LIMIT]; // owned
    uint64_t use_count;
    struct waiting waiting[WAITING_LIMIT];
    size_t waiting_count;
    bool is_ending, has_thread;
    pthread_t thread;
};

static bool is_empty(double min, double max, const void *user)
{
    const struct brick_source *source = user;

    return transfer_function_is_empty(source->points, source->point_count, min, max);
}

static struct brick_atlas *decode(const struct sparse_file *file, const struct brick_source *source,
                                  struct error *error)
{
    struct sparse_grid *density = sparse_file_decode(file, source->density_name, error), *glow = NULL;
    struct brick_atlas *atlas = NULL;

    if (!density) return NULL;
    if (source->glow_name) glow = sparse_file_decode(file, source->glow_name, error);
    if (glow || !source->glow_name)
        atlas = brick_atlas_create(
            &(struct brick_atlas_params){.density = density, .glow = glow, .is_empty = is_empty, .user = source},
            error);
    sparse_grid_destroy(density);
    sparse_grid_destroy(glow);
    return atlas;
}

// Refuses a file that changes meanwhile: its bytes and their hash would belong to no version.
static bool read_entry(struct entry *entry, const struct brick_source *source, struct error *error)
{
    struct file_version after;
    struct sparse_file file;
    bool ok = false;

    if (!file_version_find(source->path, &entry->volume.version, NULL)) {
        error_set_errno(error, errno, "cannot open");
        return false;
    }
    if (!sparse_file_load(&file, source->path, entry->volume.hash, error)) return false;
    entry->atlas = decode(&file, source, error);
    if (entry->atlas && file_version_find(source->path, &after, error)) {
        ok = file_version_is_same(&entry->volume.version, &after);
        if (!ok) error_set(error, "it changed while it was read");
    }
    entry->is_settled = ok && file_version_is_settled(&after);
    entry->volume.atlas = entry->atlas;
    sparse_file_finish(&file);
    if (ok) return true;
    brick_atlas_destroy(entry->atlas);
    entry->atlas = NULL;
    return false;
}

static void load_entry(struct entry *entry, const struct brick_source *source)
{
    double start = clock_now_s();

    if (!read_entry(entry, source, &entry->error)) return;
    log_debug("bricks: %s read in %.1f ms, %zu bytes", source->path, 1e3 * (clock_now_s() - start),
              entry->atlas->size_bytes);
}

static void destroy_entry(struct entry *entry)
{
    brick_atlas_destroy(entry->atlas);
    free(entry->key);
    free(entry);
}

const struct brick_volume *brick_volume_load(const struct brick_source *source, struct error *error)
{
    struct entry *entry = xcalloc(1, sizeof *entry);

    load_entry(entry, source);
    if (entry->atlas) return &entry->volume;
    error_set(error, "%s: %s", source->path, entry->error.message);
    destroy_entry(entry);
    return NULL;
}

static char *key_of(const struct brick_source *source)
{
    char points[HASH_TEXT_SIZE];

    hash_bytes(source->points, source->point_count * sizeof *source->points, points);
    return xasprintf("%s\n%s\n%s\n%s", source->path, source->density_name ? source->density_name : "",
                     source->glow_name ? source->glow_name : "", points);
}

static struct entry **find(struct brick_store *store, const char *key)
{
    for (size_t i = 0; i < ENTRY_LIMIT; ++i)
        if (store->entries[i] && strcmp(store->entries[i]->key, key) == 0) return &store->entries[i];
    return NULL;
}

// Returns a free slot, after dropping grids that no frame uses until the rest is below the limit; NULL: none is free.
static struct entry **make_room(struct brick_store *store)
{
    for (;;) {
        struct entry **oldest = NULL, **empty = NULL;
        size_t idle_bytes = 0;

        for (size_t i = 0; i < ENTRY_LIMIT; ++i) {
            struct entry *entry = store->entries[i];

            if (!entry) {
                empty = &store->entries[i];
                continue;
            }
            if (entry->taken > 0 || !entry->is_read) continue;
            idle_bytes += entry->atlas ? entry->atlas->size_bytes : 0;
            if (!oldest || entry->used < (*oldest)->used) oldest = &store->entries[i];
        }
        if (!oldest || (empty && idle_bytes <= idle_bytes_limit)) return empty;
        destroy_entry(*oldest);
        *oldest = NULL;
    }
}

// Puts an entry that is being read into the slot. Takes ownership of the key.
static struct entry *begin_entry(struct brick_store *store, struct entry **slot, char *key)
{
    *slot = xcalloc(1, sizeof **slot);
    (*slot)->key = key;
    (*slot)->used = ++store->use_count;
    return *slot;
}

static void finish_entry(struct brick_store *store, struct entry *entry)
{
    pthread_mutex_lock(&store->lock);
    entry->is_read = true;
    pthread_cond_broadcast(&store->changed);
    pthread_mutex_unlock(&store->lock);
}

static bool is_current(const struct entry *entry, const char *path)
{
    struct file_version now;

    return entry->atlas && entry->is_settled && file_version_find(path, &now, NULL) &&
           file_version_is_same(&now, &entry->volume.version);
}

// Returns the entry of the file's current version, after waiting while it is being read; NULL when there is none. The
// caller holds the lock.
static struct entry *find_current(struct brick_store *store, const char *key, const char *path)
{
    struct entry **slot;

    while ((slot = find(store, key)) && !(*slot)->is_read)
        pthread_cond_wait(&store->changed, &store->lock);
    if (!slot) return NULL;
    // A frame that uses it keeps it; scene_input_check notices when the file has changed.
    if ((*slot)->taken > 0 || is_current(*slot, path)) return *slot;
    destroy_entry(*slot);
    *slot = NULL;
    return NULL;
}

const struct brick_volume *brick_store_take(struct brick_store *store, const struct brick_source *source,
                                            struct error *error)
{
    char *key = key_of(source);
    struct entry *entry, **slot;

    pthread_mutex_lock(&store->lock);
    entry = find_current(store, key, source->path);
    if (entry) {
        ++entry->taken;
        entry->used = ++store->use_count;
        pthread_mutex_unlock(&store->lock);
        free(key);
        return &entry->volume;
    }
    slot = make_room(store);
    if (!slot) {
        pthread_mutex_unlock(&store->lock);
        free(key);
        error_set(error, "%s: more than %d sparse grids at once", source->path, (int)ENTRY_LIMIT);
        return NULL;
    }
    entry = begin_entry(store, slot, key);
    entry->taken = 1;
    pthread_mutex_unlock(&store->lock);
    load_entry(entry, source);
    finish_entry(store, entry);
    if (entry->atlas) return &entry->volume;
    error_set(error, "%s: %s", source->path, entry->error.message);
    brick_store_release(store, &entry->volume);
    return NULL;
}

void brick_store_release(struct brick_store *store, const struct brick_volume *volume)
{
    struct entry *entry = (struct entry *)volume;

    if (!entry) return;
    if (!store) {
        destroy_entry(entry);
        return;
    }
    pthread_mutex_lock(&store->lock);
    --entry->taken;
    pthread_mutex_unlock(&store->lock);
}

static void finish_waiting(struct waiting *waiting)
{
    free(waiting->path);
    free(waiting->density_name);
    free(waiting->glow_name);
    free(waiting->points);
    *waiting = (struct waiting){0};
}

static struct waiting take_waiting(struct brick_store *store)
{
    struct waiting first = store->waiting[0];

    --store->waiting_count;
    memmove(store->waiting, store->waiting + 1, store->waiting_count * sizeof *store->waiting);
    return first;
}

static void *read_ahead(void *user)
{
    struct brick_store *store = user;

    pthread_mutex_lock(&store->lock);
    for (;;) {
        struct waiting waiting;
        struct brick_source source;
        struct entry *entry, **slot;

        while (!store->is_ending && store->waiting_count == 0)
            pthread_cond_wait(&store->changed, &store->lock);
        if (store->is_ending) break;
        waiting = take_waiting(store);
        source = (struct brick_source){waiting.path, waiting.density_name, waiting.glow_name, waiting.points,
                                       waiting.point_count};
        {
            char *key = key_of(&source);

            slot = find(store, key) ? NULL : make_room(store);
            entry = slot ? begin_entry(store, slot, key) : NULL;
            if (!entry) free(key);
        }
        pthread_mutex_unlock(&store->lock);
        if (entry) {
            load_entry(entry, &source);
            finish_entry(store, entry);
        }
        finish_waiting(&waiting);
        pthread_mutex_lock(&store->lock);
    }
    pthread_mutex_unlock(&store->lock);
    return NULL;
}

static struct scene_transfer_point *copy_points(const struct brick_source *source)
{
    size_t size_bytes = source->point_count * sizeof *source->points;

    return size_bytes > 0 ? memcpy(xmalloc(size_bytes), source->points, size_bytes) : NULL;
}

void brick_store_expect(struct brick_store *store, const struct brick_source *source)
{
    pthread_mutex_lock(&store->lock);
    if (!store->has_thread) store->has_thread = pthread_create(&store->thread, NULL, read_ahead, store) == 0;
    if (store->has_thread && store->waiting_count < WAITING_LIMIT) {
        store->waiting[store->waiting_count++] =
            (struct waiting){.path = xstrdup(source->path),
                             .density_name = source->density_name ? xstrdup(source->density_name) : NULL,
                             .glow_name = source->glow_name ? xstrdup(source->glow_name) : NULL,
                             .points = copy_points(source),
                             .point_count = source->point_count};
        pthread_cond_broadcast(&store->changed);
    }
    pthread_mutex_unlock(&store->lock);
}

struct brick_store *brick_store_create(void)
{
    struct brick_store *store = xcalloc(1, sizeof *store);

    pthread_mutex_init(&store->lock, NULL);
    pthread_cond_init(&store->changed, NULL);
    return store;
}

void brick_store_destroy(struct brick_store *store)
{
    if (!store) return;
    pthread_mutex_lock(&store->lock);
    store->is_ending = true;
    pthread_cond_broadcast(&store->changed);
    pthread_mutex_unlock(&store->lock);
    if (store->has_thread) pthread_join(store->thread, NULL);
    for (size_t i = 0; i < store->waiting_count; ++i)
        finish_waiting(&store->waiting[i]);
    for (size_t i = 0; i < ENTRY_LIMIT; ++i)
        if (store->entries[i]) destroy_entry(store->entries[i]);
    pthread_mutex_destroy(&store->lock);
    pthread_cond_destroy(&store->changed);
    free(store);
}
