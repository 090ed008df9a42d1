// A picture is the file KEY: its bytes, then a trailer of fixed size, which says how many they are, and their hash.
// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_cache.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { TRAILER_BYTES = 512, KEY_LENGTH = HASH_TEXT_SIZE - 1 };

struct cached_picture {
    char key[HASH_TEXT_SIZE];
    uint64_t file_bytes;
    bool is_trusted;                      // it was made, or its hash was compared, since the cache was opened
    struct cached_picture *next;          // in its bucket
    struct cached_picture *older, *newer; // in the cache's list
};

void picture_file_close(struct picture_file *file)
{
    if (file->fd >= 0) close(file->fd);
    file->fd = -1;
}

static bool is_key(const char *name)
{
    return strlen(name) == KEY_LENGTH && strspn(name, "0123456789abcdef") == KEY_LENGTH;
}

static struct cached_picture **find_bucket(struct picture_cache *cache, const char *key)
{
    unsigned number = 0;

    sscanf(key, "%4x", &number);
    return &cache->buckets[number % PICTURE_CACHE_BUCKETS];
}

static struct cached_picture *find(struct picture_cache *cache, const char *key)
{
    struct cached_picture *picture = *find_bucket(cache, key);

    while (picture && strcmp(picture->key, key) != 0)
        picture = picture->next;
    return picture;
}

static void unlink_from_age(struct picture_cache *cache, struct cached_picture *picture)
{
    if (picture->older) picture->older->newer = picture->newer;
    if (picture->newer) picture->newer->older = picture->older;
    if (cache->oldest == picture) cache->oldest = picture->newer;
    if (cache->newest == picture) cache->newest = picture->older;
    picture->older = picture->newer = NULL;
}

static void link_as_newest(struct picture_cache *cache, struct cached_picture *picture)
{
    picture->older = cache->newest;
    if (cache->newest) cache->newest->newer = picture;
    cache->newest = picture;
    if (!cache->oldest) cache->oldest = picture;
}

static void forget(struct picture_cache *cache, struct cached_picture *picture)
{
    struct cached_picture **link = find_bucket(cache, picture->key);

    while (*link != picture)
        link = &(*link)->next;
    *link = picture->next;
    unlink_from_age(cache, picture);
    cache->bytes -= picture->file_bytes;
    free(picture);
}

static void remove_picture(struct picture_cache *cache, struct cached_picture *picture)
{
    (void)unlinkat(cache->folder_fd, picture->key, 0);
    forget(cache, picture);
}

static void make_room(struct picture_cache *cache)
{
    while (cache->bytes > cache->limit_bytes && cache->oldest)
        remove_picture(cache, cache->oldest);
}

static void add(struct picture_cache *cache, const char *key, uint64_t file_bytes, bool is_trusted)
{
    struct cached_picture *picture = find(cache, key), **bucket = find_bucket(cache, key);

    if (picture) forget(cache, picture); // its file was replaced
    picture = xcalloc(1, sizeof *picture);
    snprintf(picture->key, sizeof picture->key, "%s", key);
    picture->file_bytes = file_bytes;
    picture->is_trusted = is_trusted;
    picture->next = *bucket;
    *bucket = picture;
    link_as_newest(cache, picture);
    cache->bytes += file_bytes;
}

struct found_file {
    char key[HASH_TEXT_SIZE];
    uint64_t file_bytes;
    struct timespec used;
};

static int compare_use(const void *a, const void *b)
{
    const struct timespec *first = &((const struct found_file *)a)->used,
                          *second = &((const struct found_file *)b)->used;

    if (first->tv_sec != second->tv_sec) return first->tv_sec < second->tv_sec ? -1 : 1;
    return (first->tv_nsec > second->tv_nsec) - (first->tv_nsec < second->tv_nsec);
}

// Folders are left alone: those of workers are among them.
static void take_up(struct picture_cache *cache, DIR *entries)
{
    struct found_file *files = NULL;
    size_t count = 0, capacity = 0;
    struct dirent *entry;

    while ((entry = readdir(entries))) {
        struct stat status;

        if (fstatat(cache->folder_fd, entry->d_name, &status, AT_SYMLINK_NOFOLLOW) != 0 || S_ISDIR(status.st_mode))
            continue;
        if (!S_ISREG(status.st_mode) || !is_key(entry->d_name) || status.st_size < TRAILER_BYTES) {
            (void)unlinkat(cache->folder_fd, entry->d_name, 0);
            continue;
        }
        files = xgrow(files, &capacity, count + 1, sizeof *files);
        files[count] = (struct found_file){.file_bytes = (uint64_t)status.st_size, .used = status.st_mtim};
        memcpy(files[count++].key, entry->d_name, HASH_TEXT_SIZE);
    }
    if (count > 0) qsort(files, count, sizeof *files, compare_use);
    for (size_t i = 0; i < count; i++)
        add(cache, files[i].key, files[i].file_bytes, false);
    free(files);
    make_room(cache);
}

bool picture_cache_open(struct picture_cache *cache, const char *folder, uint64_t limit_bytes, struct error *error)
{
    DIR *entries;
    int fd;

    *cache = (struct picture_cache){.limit_bytes = limit_bytes};
    cache->folder_fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    fd = cache->folder_fd >= 0 ? openat(cache->folder_fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    entries = fd >= 0 ? fdopendir(fd) : NULL;
    if (!entries) {
        error_set_errno(error, errno, "%s", folder);
        if (fd >= 0) close(fd);
        if (cache->folder_fd >= 0) close(cache->folder_fd);
        return false;
    }
    pthread_mutex_init(&cache->lock, NULL);
    take_up(cache, entries);
    closedir(entries);
    return true;
}

void picture_cache_close(struct picture_cache *cache)
{
    while (cache->oldest)
        forget(cache, cache->oldest);
    pthread_mutex_destroy(&cache->lock);
    close(cache->folder_fd);
}

// Hashes so many bytes of the file from its start.
static bool hash_body(int fd, uint64_t body_bytes, char hash[static HASH_TEXT_SIZE])
{
    void *bytes;

    if (body_bytes == 0) return false;
    bytes = mmap(NULL, (size_t)body_bytes, PROT_READ, MAP_PRIVATE, fd, 0);
    if (bytes == MAP_FAILED) return false;
    hash_bytes(bytes, (size_t)body_bytes, hash);
    munmap(bytes, (size_t)body_bytes);
    return true;
}

static bool read_trailer(struct picture_file *file, uint64_t file_bytes, bool is_trusted)
{
    char trailer[TRAILER_BYTES + 1], hash[HASH_TEXT_SIZE], found[HASH_TEXT_SIZE];
    int facts_at = 0;

    if (file_bytes <= TRAILER_BYTES) return false;
    if (pread(file->fd, trailer, TRAILER_BYTES, (off_t)(file_bytes - TRAILER_BYTES)) != TRAILER_BYTES) return false;
    trailer[TRAILER_BYTES] = '\0';
    if (sscanf(trailer, "picture 1 %" SCNu64 " %32s %n", &file->body_bytes, hash, &facts_at) != 2 || facts_at == 0)
        return false;
    if (file->body_bytes != file_bytes - TRAILER_BYTES || strlen(trailer + facts_at) > PICTURE_FACTS_LIMIT)
        return false;
    memcpy(file->facts, trailer + facts_at, strlen(trailer + facts_at) + 1);
    return is_trusted || (hash_body(file->fd, file->body_bytes, found) && !strcmp(found, hash));
}

// The time of its last use outlives the program. The kernel's own "now" is some milliseconds coarse.
static void note_use(int fd)
{
    struct timespec times[2];

    clock_gettime(CLOCK_REALTIME, &times[0]);
    times[1] = times[0];
    (void)futimens(fd, times);
}

bool picture_cache_find(struct picture_cache *cache, const char *key, struct picture_file *file)
{
    struct cached_picture *picture;
    bool ok = false;

    *file = (struct picture_file){.fd = -1};
    pthread_mutex_lock(&cache->lock);
    picture = find(cache, key);
    if (picture) {
        file->fd = openat(cache->folder_fd, key, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        ok = file->fd >= 0 && read_trailer(file, picture->file_bytes, picture->is_trusted);
    }
    if (ok) {
        picture->is_trusted = true;
        note_use(file->fd);
        unlink_from_age(cache, picture);
        link_as_newest(cache, picture);
    } else if (picture) {
        remove_picture(cache, picture);
        picture_file_close(file);
    }
    pthread_mutex_unlock(&cache->lock);
    return ok;
}

// Writes the trailer behind the body, whose size it finds.
static bool seal(struct picture_file *file, const char *facts, struct error *error)
{
    char trailer[TRAILER_BYTES + 1] = "", hash[HASH_TEXT_SIZE];
    struct stat status;

    if (strlen(facts) > PICTURE_FACTS_LIMIT) {
        error_set(error, "expected facts of at most %d bytes", PICTURE_FACTS_LIMIT);
        return false;
    }
    if (fstat(file->fd, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0 ||
        status.st_size > PICTURE_BODY_LIMIT) {
        error_set(error, "expected a file of 1 to %d bytes", PICTURE_BODY_LIMIT);
        return false;
    }
    file->body_bytes = (uint64_t)status.st_size;
    if (!hash_body(file->fd, file->body_bytes, hash)) {
        error_set_errno(error, errno, "cannot be read");
        return false;
    }
    snprintf(trailer, sizeof trailer, "picture 1 %" PRIu64 " %s %s", file->body_bytes, hash, facts);
    snprintf(file->facts, sizeof file->facts, "%s", facts);
    if (lseek(file->fd, 0, SEEK_END) < 0) {
        error_set_errno(error, errno, "cannot be written");
        return false;
    }
    return file_write_all(file->fd, trailer, TRAILER_BYTES, error);
}

bool picture_cache_take(struct picture_cache *cache, const char *key, const char *facts, int from_fd, const char *name,
                        struct picture_file *file, struct error *error)
{
    bool ok;

    *file = (struct picture_file){.fd = openat(from_fd, name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    if (file->fd < 0) {
        error_set_errno(error, errno, "the picture that was made");
        return false;
    }
    ok = seal(file, facts, error);
    pthread_mutex_lock(&cache->lock);
    if (ok && file->body_bytes + TRAILER_BYTES > cache->limit_bytes) {
        (void)unlinkat(from_fd, name, 0);
    } else if (ok) {
        ok = renameat(from_fd, name, cache->folder_fd, key) == 0;
        if (!ok) error_set_errno(error, errno, "the cache");
        if (ok) add(cache, key, file->body_bytes + TRAILER_BYTES, true);
        if (ok) note_use(file->fd);
        make_room(cache);
    }
    pthread_mutex_unlock(&cache->lock);
    if (!ok) picture_file_close(file);
    return ok;
}
