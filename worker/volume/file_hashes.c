// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/file_hashes.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Enough for a few sequences; the oldest entry is replaced.
enum { ENTRY_COUNT = 256 };

// File systems count time in ticks of some milliseconds, two seconds at worst. A file that was written just now may be
// written again with the same time.
static const double settled_s = 2.1;

struct entry {
    char *path; // owned; NULL: none
    struct file_version version;
    char hash[HASH_TEXT_SIZE];
};

struct file_hashes {
    struct entry entries[ENTRY_COUNT];
    size_t next; // the entry to replace
};

static struct file_version version_of(const struct stat *status)
{
    return (struct file_version){status->st_dev, status->st_ino, status->st_size, status->st_mtim, status->st_ctim};
}

bool file_version_find(const char *path, struct file_version *version, struct error *error)
{
    struct stat status;

    if (stat(path, &status) < 0) {
        error_set_errno(error, errno, "%s", path);
        return false;
    }
    *version = version_of(&status);
    return true;
}

static bool is_same_time(struct timespec a, struct timespec b)
{
    return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

bool file_version_is_same(const struct file_version *a, const struct file_version *b)
{
    return a->device == b->device && a->inode == b->inode && a->size_bytes == b->size_bytes &&
           is_same_time(a->modified, b->modified) && is_same_time(a->changed, b->changed);
}

bool file_version_is_settled(const struct file_version *version)
{
    struct timespec now;

    clock_gettime(CLOCK_REALTIME, &now);
    return (double)(now.tv_sec - version->changed.tv_sec) + 1e-9 * (double)(now.tv_nsec - version->changed.tv_nsec) >
           settled_s;
}

struct file_hashes *file_hashes_create(void)
{
    return xcalloc(1, sizeof(struct file_hashes));
}

void file_hashes_destroy(struct file_hashes *hashes)
{
    if (!hashes) return;
    for (size_t i = 0; i < ENTRY_COUNT; ++i)
        free(hashes->entries[i].path);
    free(hashes);
}

static bool hash_open_file(int fd, const char *path, struct file_version *version, char hash[static HASH_TEXT_SIZE],
                           struct error *error)
{
    struct stat before, after;
    struct file_version seen;
    bool ok = fstat(fd, &before) == 0 && S_ISREG(before.st_mode);

    if (!ok) {
        error_set(error, "%s: expected a regular file", path);
        return false;
    }
    if (!hash_file(fd, hash, NULL, error)) {
        error_prefix(error, "%s", path);
        return false;
    }
    *version = version_of(&before);
    if (fstat(fd, &after) == 0 && (seen = version_of(&after), file_version_is_same(version, &seen))) return true;
    error_set(error, "%s: it changed while it was read", path);
    return false;
}

static void keep(struct file_hashes *hashes, const char *path, const struct file_version *version,
                 const char hash[static HASH_TEXT_SIZE])
{
    struct entry *entry = &hashes->entries[hashes->next];

    hashes->next = (hashes->next + 1) % ENTRY_COUNT;
    free(entry->path);
    *entry = (struct entry){.path = xstrdup(path), .version = *version};
    memcpy(entry->hash, hash, sizeof entry->hash);
}

bool file_hashes_find(struct file_hashes *hashes, const char *path, struct file_version *version,
                      char hash[static HASH_TEXT_SIZE], struct error *error)
{
    bool ok;
    int fd;

    if (!file_version_find(path, version, error)) return false;
    for (size_t i = 0; i < ENTRY_COUNT; ++i) {
        const struct entry *entry = &hashes->entries[i];

        if (!entry->path || strcmp(entry->path, path) != 0 || !file_version_is_same(&entry->version, version)) continue;
        memcpy(hash, entry->hash, sizeof entry->hash);
        return true;
    }
    fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        error_set_errno(error, errno, "%s", path);
        return false;
    }
    ok = hash_open_file(fd, path, version, hash, error);
    close(fd);
    if (ok && file_version_is_settled(version)) keep(hashes, path, version, hash);
    return ok;
}
