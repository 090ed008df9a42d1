// SPDX-License-Identifier: Apache-2.0
#include "cli/render/preview_path.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char *make_absolute(const char *path, const char *name, struct error *error)
{
    char *named = name == path ? xstrdup(".") : xstrndup(path, (size_t)(name - path));
    char *folder = realpath(named, NULL), *absolute = NULL;

    if (folder)
        absolute = xasprintf("%s/%s", strcmp(folder, "/") == 0 ? "" : folder, name);
    else
        error_set_errno(error, errno, "--preview: folder %s", named);
    free(folder);
    free(named);
    return absolute;
}

// Tries it: what a file system allows shows in no other way.
static bool is_writable(const char *path, struct error *error)
{
    char *beside = xasprintf("%s.%d.tmp", path, (int)getpid());
    int fd = open(beside, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);

    if (fd < 0) {
        error_set_errno(error, errno, "--preview: cannot write beside %s", path);
    } else {
        close(fd);
        unlink(beside);
    }
    free(beside);
    return fd >= 0;
}

char *preview_path_check(const char *path, struct error *error)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    size_t length = strlen(name);
    struct stat status;
    char *absolute;

    if (length <= 4 || strcmp(name + length - 4, ".png") != 0) {
        error_set(error, "--preview: expected NAME.png, got \"%s\"", path);
        return NULL;
    }
    if (lstat(path, &status) == 0 && !S_ISREG(status.st_mode)) {
        error_set(error, "--preview: %s: expected a file, or nothing yet", path);
        return NULL;
    }
    absolute = make_absolute(path, name, error);
    if (absolute && is_writable(absolute, error)) return absolute;
    free(absolute);
    return NULL;
}
