// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/folders.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

bool folders_make(const char *path, mode_t mode, struct error *error)
{
    char *cut = xstrdup(path);
    struct stat status;
    int cause;

    for (char *slash = strchr(cut + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(cut, 0755);
        *slash = '/';
    }
    free(cut);
    if (mkdir(path, mode) == 0) return true;
    cause = errno;
    if (cause == EEXIST && stat(path, &status) == 0 && S_ISDIR(status.st_mode)) return true;
    error_set_errno(error, cause == EEXIST ? ENOTDIR : cause, "folder %s", path);
    return false;
}
