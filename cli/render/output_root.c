// SPDX-License-Identifier: Apache-2.0
#include "cli/render/output_root.h"

#include "cli/job/job_document.h"
#include "cli/job/json_set.h"
#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool make_folders(const char *folder, struct error *error)
{
    char *path = xstrdup(folder);
    bool ok = true;

    for (char *slash = path + 1; ok; slash++) {
        char kept = *slash;

        if (kept && kept != '/') continue;
        *slash = 0;
        ok = mkdir(path, 0777) == 0 || errno == EEXIST;
        if (!ok) error_set_errno(error, errno, "--out: folder %s", path);
        *slash = kept;
        if (!kept) break;
    }
    free(path);
    return ok;
}

char *output_root_choose(const char *out, bool may_make, char **document, struct error *error)
{
    const char *slash = out ? strrchr(out, '/') : NULL;
    char *folder = NULL, *root = NULL;

    if (!out || *out != '/') {
        if (out && !json_set_text(document, "output.path", out, error)) return NULL;
        root = realpath(".", NULL);
        if (!root) error_set_errno(error, errno, "the current folder");
        return root;
    }
    folder = slash == out ? xstrdup("/") : xstrndup(out, (size_t)(slash - out));
    if ((!may_make || make_folders(folder, error)) && json_set_text(document, "output.path", slash + 1, error)) {
        root = realpath(folder, NULL);
        if (!root) error_set_errno(error, errno, "--out: folder %s", folder);
    }
    free(folder);
    return root;
}
