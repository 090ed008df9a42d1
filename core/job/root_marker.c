// SPDX-License-Identifier: Apache-2.0
#include "core/job/root_marker.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { TEXT_LIMIT = 64 * 1024, HOST_SIZE = HOST_NAME_MAX + 1 };

static const char header[] =
    "# marchd knows its output root by this file: leave it here (\"Output roots\" in marchd(8)).\n";

bool root_marker_is_id(const char *text)
{
    return strlen(text) == ROOT_MARKER_ID_SIZE - 1 && strspn(text, "0123456789abcdef") == ROOT_MARKER_ID_SIZE - 1;
}

void root_marker_make_id(char id[static ROOT_MARKER_ID_SIZE])
{
    uint64_t words[2] = {0};

    if (getrandom(words, sizeof words, 0) != (ssize_t)sizeof words) {
        words[0] = (uint64_t)time(NULL);
        words[1] = (uint64_t)getpid();
    }
    snprintf(id, ROOT_MARKER_ID_SIZE, "%016" PRIx64 "%016" PRIx64, words[0], words[1]);
}

// Reads the start of the file; what was torn in a crash may hold any bytes. The text is owned by the caller, and NULL,
// with errno set, where there is none.
static char *read_marker(int root_fd)
{
    int fd = openat(root_fd, ROOT_MARKER_NAME, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    char *text = NULL;
    size_t length = 0;
    ssize_t count = -1;
    struct stat status;
    int cause;

    if (fd >= 0 && fstat(fd, &status) == 0) {
        errno = EINVAL;
        if (!S_ISREG(status.st_mode)) goto out;
        text = xmalloc(TEXT_LIMIT + 1);
        do {
            count = read(fd, text + length, TEXT_LIMIT - length);
            if (count > 0) length += (size_t)count;
        } while (count > 0 || (count < 0 && errno == EINTR));
    }
out:
    cause = errno;
    if (fd >= 0) close(fd);
    if (count < 0) {
        free(text);
        errno = cause;
        return NULL;
    }
    for (size_t i = 0; i < length; i++)
        if (!text[i]) text[i] = '?';
    text[length] = '\0';
    return text;
}

// The first whole line at or after `text` that begins with `word`, cut out of the text; `*rest` is what follows it.
static char *cut_line(char *text, const char *word, char **rest)
{
    size_t length = strlen(word);

    for (char *line = text, *end; (end = strchr(line, '\n')); line = end + 1) {
        if (strncmp(line, word, length) != 0) continue;
        *end = '\0';
        *rest = end + 1;
        return line + length;
    }
    return NULL;
}

enum root_marker_state root_marker_read(int root_fd, char id[static ROOT_MARKER_ID_SIZE], struct error *error)
{
    char *text = read_marker(root_fd), *rest = text, *line;

    id[0] = '\0';
    if (!text && errno == ENOENT) return ROOT_MARKER_NONE;
    if (!text && (errno == ELOOP || errno == EINVAL)) {
        error_set(error, "has a " ROOT_MARKER_NAME " that is a link or no file: put the file back");
        return ROOT_MARKER_UNKNOWN;
    }
    if (!text) {
        error_set_errno(error, errno, "cannot read %s", ROOT_MARKER_NAME);
        return ROOT_MARKER_UNKNOWN;
    }
    while (!id[0] && (line = cut_line(rest, "root ", &rest)))
        if (root_marker_is_id(line)) memcpy(id, line, ROOT_MARKER_ID_SIZE);
    free(text);
    return id[0] ? ROOT_MARKER_VALID : ROOT_MARKER_EMPTY;
}

static bool sync_folder(int root_fd)
{
    int fd = openat(root_fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool ok = fd >= 0 && fsync(fd) == 0;

    if (fd >= 0) close(fd);
    return ok;
}

static int open_to_append(int root_fd)
{
    return openat(root_fd, ROOT_MARKER_NAME, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644);
}

// An empty marker asks to be filled, also where it is another user's, such as root's. False, with errno set, where it
// is not empty or the folder is another's, too.
static bool remove_empty(int root_fd)
{
    struct stat status;

    if (fstatat(root_fd, ROOT_MARKER_NAME, &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(status.st_mode) &&
        status.st_size == 0 && unlinkat(root_fd, ROOT_MARKER_NAME, 0) == 0)
        return true;
    errno = EACCES;
    return false;
}

// One write, so that lines of two farms do not mix. A line that was torn before is ended first.
static bool append(int root_fd, const char *line, struct error *error)
{
    int fd = open_to_append(root_fd);
    struct stat status;
    char *text = NULL;
    bool ok = false;

    if (fd < 0 && errno == EACCES && remove_empty(root_fd)) fd = open_to_append(root_fd);
    if (fd < 0 || fstat(fd, &status) < 0) goto out;
    text = xasprintf("%s%s\n", status.st_size > 0 ? "\n" : header, line);
    if (!file_write_all(fd, text, strlen(text), NULL) || fsync(fd) < 0) goto out;
    ok = sync_folder(root_fd);
out:
    if (!ok) error_set_errno(error, errno, "cannot write %s", ROOT_MARKER_NAME);
    if (fd >= 0) close(fd);
    free(text);
    return ok;
}

bool root_marker_add_root(int root_fd, const char *id, struct error *error)
{
    char *line = xasprintf("root %s", id);
    bool ok = append(root_fd, line, error);

    free(line);
    return ok;
}

// The end of a farm's line: host and state folder. Owned by the caller.
static char *format_home(const char *state_folder)
{
    char host[HOST_SIZE] = "";

    if (gethostname(host, sizeof host - 1) != 0 || !host[0]) strcpy(host, "localhost");
    return xasprintf("%s %s", host, state_folder);
}

// The id of the last farm of that home; empty: none.
static void find_farm(int root_fd, const char *home, char farm[static ROOT_MARKER_ID_SIZE])
{
    char *text = read_marker(root_fd), *rest = text, *line;

    farm[0] = '\0';
    while (text && (line = cut_line(rest, "farm ", &rest))) {
        if (strlen(line) < ROOT_MARKER_ID_SIZE || strcmp(line + ROOT_MARKER_ID_SIZE, home) != 0) continue;
        line[ROOT_MARKER_ID_SIZE - 1] = '\0';
        if (root_marker_is_id(line)) memcpy(farm, line, ROOT_MARKER_ID_SIZE);
    }
    free(text);
}

bool root_marker_add_farm(int root_fd, const char *farm, const char *state_folder, struct error *error)
{
    char *home = format_home(state_folder), *line = xasprintf("farm %s %s", farm, home);
    char latest[ROOT_MARKER_ID_SIZE];
    bool ok;

    find_farm(root_fd, home, latest);
    ok = strcmp(latest, farm) == 0 || append(root_fd, line, error);
    free(home);
    free(line);
    return ok;
}

bool root_marker_find_farm(const char *root, const char *state_folder, char farm[static ROOT_MARKER_ID_SIZE])
{
    int root_fd = open(root, O_PATH | O_DIRECTORY | O_CLOEXEC);
    char *home = format_home(state_folder);

    farm[0] = '\0';
    if (root_fd >= 0) {
        find_farm(root_fd, home, farm);
        close(root_fd);
    }
    free(home);
    return farm[0] != '\0';
}
