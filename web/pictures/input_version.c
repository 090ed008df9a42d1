// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/input_version.h"

#include "core/base/alloc.h"
#include "core/base/path_list.h"
#include "core/json/json_write.h"
#include "core/scene/input_path.h"

#include <ctype.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { HEADER_LIMIT = 1024 * 1024 }; // bytes; a worker reads no longer one

static void write_status(const char *path, struct json_writer *writer)
{
    struct stat status;

    json_write_string(writer, path);
    if (stat(path, &status) != 0) return;
    json_write_integer(writer, (int64_t)status.st_dev);
    json_write_integer(writer, (int64_t)status.st_ino);
    json_write_integer(writer, status.st_size);
    json_write_integer(writer, status.st_mtim.tv_sec);
    json_write_integer(writer, status.st_mtim.tv_nsec);
    json_write_integer(writer, status.st_ctim.tv_sec);
    json_write_integer(writer, status.st_ctim.tv_nsec);
}

// The start of a file, in which a header would be; owned by the caller. NULL: it is no regular file, or may not be
// read. A pipe is not waited for.
static char *read_start(const char *path)
{
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    char *start = NULL;
    struct stat status;

    if (fd >= 0 && fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) {
        ssize_t count;

        start = xcalloc(1, HEADER_LIMIT + 1);
        count = pread(fd, start, HEADER_LIMIT, 0);
        start[count > 0 ? count : 0] = '\0';
    }
    if (fd >= 0) close(fd);
    return start;
}

// The name in a line of the header; NULL: the line has another field. Owned by the caller.
static char *take_name(const char *line, size_t length)
{
    static const char *const fields[] = {"data file:", "datafile:"};

    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        size_t skipped = strlen(fields[i]);

        if (length <= skipped || strncasecmp(line, fields[i], skipped) != 0 || line[skipped] == '=') continue;
        skipped += strspn(line + skipped, " \t");
        while (length > skipped && isspace((unsigned char)line[length - 1]))
            length--;
        return length > skipped ? xstrndup(line + skipped, length - skipped) : NULL;
    }
    return NULL;
}

// The header ends with an empty line.
static char *find_name(const char *start)
{
    for (const char *line = start; *line;) {
        size_t length = strcspn(line, "\n");
        char *name = take_name(line, length);

        if (name || strspn(line, "\r") == length) return name;
        line += length + (line[length] == '\n');
    }
    return NULL;
}

// What is below no other root than the header, as that one's disk is all that may be waited for.
static void write_named(const char *path, const char *root, struct json_writer *writer)
{
    struct path_list roots = {.paths = &(char *){(char *)root}, .count = 1};
    char *start = read_start(path), *name = start ? find_name(start) : NULL, *named;
    const char *slash = strrchr(path, '/');

    free(start);
    if (!name) return;
    named = name[0] == '/' || !slash ? xstrdup(name) : xasprintf("%.*s%s", (int)(slash + 1 - path), path, name);
    if (input_path_is_plain(named) && path_list_find_root(&roots, named)) write_status(named, writer);
    free(named);
    free(name);
}

void input_version_write(const char *path, const char *root, struct json_writer *writer)
{
    write_status(path, writer);
    if (input_path_has_ending(path, ".nhdr") || input_path_has_ending(path, ".nrrd")) write_named(path, root, writer);
}
