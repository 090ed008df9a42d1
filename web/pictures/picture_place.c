// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_place.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/path_list.h"
#include "core/json/json_write.h"
#include "web/pictures/picture_query.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { KEY_VERSION = 1 }; // another one after a change of how pictures are shown

// A pipe is not waited for, and a link is not followed: pictures are published as files.
static int open_below(const char *root, const char *relative)
{
    struct open_how how = {.flags = O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC,
                           .resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_MAGICLINKS};
    int root_fd = open(root, O_PATH | O_DIRECTORY | O_CLOEXEC), fd = -1, cause = errno;

    if (root_fd >= 0) {
        fd = (int)syscall(SYS_openat2, root_fd, relative, &how, sizeof how);
        cause = errno;
        close(root_fd);
    }
    errno = cause;
    return fd;
}

static enum picture_status explain(const char *path, int cause, struct error *error)
{
    switch (cause) {
    case ENOENT:
    case ENOTDIR:
        error_set(error, "%s: the file is not there", path);
        return PICTURE_ABSENT;
    case EACCES:
    case EPERM:
        error_set(error, "%s: march-web may not read it: whoever runs this farm decides that", path);
        return PICTURE_FORBIDDEN;
    case ELOOP:
    case EXDEV:
    case ENXIO:
        error_set(error, "%s: expected a regular file, by no link", path);
        return PICTURE_UNREADABLE;
    default:
        error_set_errno(error, cause, "%s", path);
        return PICTURE_FAULT;
    }
}

static int64_t nanoseconds(const struct timespec *time)
{
    return (int64_t)time->tv_sec * 1000000000 + time->tv_nsec;
}

enum picture_status picture_place_find(struct picture_place *place, const struct path_list *roots, const char *path,
                                       struct error *error)
{
    const char *root = path_list_find_root(roots, path), *slash = strrchr(path, '/');
    struct stat status;
    int fd;

    *place = (struct picture_place){0};
    if (!root || !slash || slash[1] == '\0') {
        error_set(error, "%s: expected a file below an output root", path);
        return PICTURE_ABSENT;
    }
    fd = open_below(root, path + strlen(root) + strspn(path + strlen(root), "/"));
    if (fd < 0) return explain(path, errno, error);
    if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(fd);
        return explain(path, ENXIO, error);
    }
    close(fd);
    place->folder = slash == path ? xstrdup("/") : xstrndup(path, (size_t)(slash - path));
    place->name = xstrdup(slash + 1);
    place->device = status.st_dev;
    place->inode = status.st_ino;
    place->size_bytes = (uint64_t)status.st_size;
    place->changed_ns[0] = nanoseconds(&status.st_mtim);
    place->changed_ns[1] = nanoseconds(&status.st_ctim);
    return PICTURE_READY;
}

void picture_place_finish(struct picture_place *place)
{
    free(place->folder);
    free(place->name);
    *place = (struct picture_place){0};
}

void picture_place_make_key(const struct picture_place *place, const struct picture_query *query,
                            char key[static HASH_TEXT_SIZE])
{
    struct json_writer writer = {0};
    char *text;

    json_write_begin_object(&writer);
    picture_query_write(query, &writer);
    json_write_end_object(&writer);
    text = xasprintf("%d %d %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRId64 " %" PRId64 " %s", KEY_VERSION, query->form,
                     place->device, place->inode, place->size_bytes, place->changed_ns[0], place->changed_ns[1],
                     writer.text);
    hash_bytes(text, strlen(text), key);
    free(text);
    json_writer_finish(&writer);
}
