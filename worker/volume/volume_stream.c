// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_stream.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/volume/volume_gzip.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { BUFFER_SIZE = 64 * 1024 };

struct volume_stream {
    int fd;
    char *path; // owned
    struct stat opened;
    int64_t position;         // in the file, after the buffered bytes
    struct volume_gzip *gzip; // owned; NULL: not compressed
    size_t start, end;        // of the buffered bytes that are not read yet
    unsigned char buffer[BUFFER_SIZE];
};

bool volume_stream_open(struct volume_stream **stream, const char *path, struct error *error)
{
    // Without O_NONBLOCK opening a FIFO would wait for its writer.
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    struct stat status;

    *stream = NULL;
    if (fd < 0 || fstat(fd, &status) < 0) {
        error_set_errno(error, errno, "cannot open");
    } else if (!S_ISREG(status.st_mode)) {
        error_set(error, "expected a file, got %s", S_ISDIR(status.st_mode) ? "a folder" : "a pipe or a device");
    } else {
        *stream = xcalloc(1, sizeof **stream);
        (*stream)->fd = fd;
        (*stream)->path = xstrdup(path);
        (*stream)->opened = status;
        posix_fadvise(fd, 0, 0, POSIX_FADV_SEQUENTIAL);
        return true;
    }
    if (fd >= 0) close(fd);
    return false;
}

void volume_stream_close(struct volume_stream *stream)
{
    if (!stream) return;
    volume_gzip_destroy(stream->gzip);
    close(stream->fd);
    free(stream->path);
    free(stream);
}

const char *volume_stream_path(const struct volume_stream *stream)
{
    return stream->path;
}

static int64_t bytes_left(const struct volume_stream *stream)
{
    return (int64_t)stream->opened.st_size - stream->position + (int64_t)(stream->end - stream->start);
}

int64_t volume_stream_left(const struct volume_stream *stream)
{
    return stream->gzip ? -1 : bytes_left(stream);
}

void volume_stream_unzip(struct volume_stream *stream)
{
    assert(!stream->gzip);
    stream->gzip = volume_gzip_create();
}

static bool read_file(struct volume_stream *stream, void *bytes, size_t size_bytes, size_t *count, struct error *error)
{
    ssize_t result;

    do
        result = read(stream->fd, bytes, size_bytes);
    while (result < 0 && errno == EINTR);
    if (result < 0) {
        error_set_errno(error, errno, "cannot read at byte %" PRId64, stream->position);
        return false;
    }
    stream->position += result;
    *count = (size_t)result;
    return true;
}

static bool fill_buffer(struct volume_stream *stream, struct error *error)
{
    stream->start = stream->end = 0;
    return read_file(stream, stream->buffer, BUFFER_SIZE, &stream->end, error);
}

static bool unzip_some(struct volume_stream *stream, void *bytes, size_t size_bytes, size_t *count, struct error *error)
{
    for (;;) {
        size_t used;

        if (stream->start == stream->end && !fill_buffer(stream, error)) return false;
        used = stream->end - stream->start;
        *count = size_bytes;
        if (used == 0 && !volume_gzip_is_complete(stream->gzip)) {
            error_set(error, "its gzip data end before they are complete, after %" PRId64 " bytes", stream->position);
            return false;
        }
        if (!volume_gzip_inflate(stream->gzip, stream->buffer + stream->start, &used, bytes, count, error)) {
            error_prefix(error, "before byte %" PRId64, stream->position);
            return false;
        }
        stream->start += used;
        if (*count > 0 || used == 0) return true;
    }
}

// Reads some of the next bytes; 0 at the end.
static bool read_some(struct volume_stream *stream, void *bytes, size_t size_bytes, size_t *count, struct error *error)
{
    if (stream->gzip) return unzip_some(stream, bytes, size_bytes, count, error);
    if (stream->start == stream->end && size_bytes >= BUFFER_SIZE)
        return read_file(stream, bytes, size_bytes, count, error);
    if (stream->start == stream->end && !fill_buffer(stream, error)) return false;
    *count = stream->end - stream->start;
    if (*count > size_bytes) *count = size_bytes;
    memcpy(bytes, stream->buffer + stream->start, *count);
    stream->start += *count;
    return true;
}

bool volume_stream_read(struct volume_stream *stream, void *bytes, size_t size_bytes, struct error *error)
{
    size_t done = 0;

    while (done < size_bytes) {
        size_t count;

        if (!read_some(stream, (unsigned char *)bytes + done, size_bytes - done, &count, error)) return false;
        if (count == 0) {
            error_set(error, "ends after %" PRId64 " bytes, before its last voxel", stream->position);
            return false;
        }
        done += count;
    }
    return true;
}

bool volume_stream_read_byte(struct volume_stream *stream, int *byte, struct error *error)
{
    unsigned char next = 0;
    size_t count;

    if (!read_some(stream, &next, 1, &count, error)) return false;
    *byte = count > 0 ? next : -1;
    return true;
}

static bool skip_unzipped(struct volume_stream *stream, int64_t size_bytes, struct error *error)
{
    unsigned char bytes[4096];

    while (size_bytes > 0) {
        size_t count = size_bytes < (int64_t)sizeof bytes ? (size_t)size_bytes : sizeof bytes;

        if (!volume_stream_read(stream, bytes, count, error)) return false;
        size_bytes -= (int64_t)count;
    }
    return true;
}

bool volume_stream_skip(struct volume_stream *stream, int64_t size_bytes, struct error *error)
{
    assert(size_bytes >= 0);
    if (stream->gzip) return skip_unzipped(stream, size_bytes, error);
    if (size_bytes > bytes_left(stream)) {
        error_set(error, "expected at least the %" PRId64 " bytes to skip, got %" PRId64, size_bytes,
                  bytes_left(stream));
        return false;
    }
    stream->position += size_bytes - (int64_t)(stream->end - stream->start);
    stream->start = stream->end = 0;
    if (lseek(stream->fd, stream->position, SEEK_SET) == stream->position) return true;
    error_set_errno(error, errno, "cannot go to byte %" PRId64, stream->position);
    return false;
}

static bool is_same_time(const struct timespec *a, const struct timespec *b)
{
    return a->tv_sec == b->tv_sec && a->tv_nsec == b->tv_nsec;
}

bool volume_stream_check_end(struct volume_stream *stream, struct error *error)
{
    unsigned char byte;
    struct stat now;
    size_t count;

    if (!read_some(stream, &byte, 1, &count, error)) return false;
    if (count > 0) {
        error_set(error, "goes on after its last voxel");
        return false;
    }
    if (fstat(stream->fd, &now) == 0 && now.st_size == stream->opened.st_size &&
        is_same_time(&now.st_mtim, &stream->opened.st_mtim))
        return true;
    error_set(error, "changed while it was read");
    return false;
}
