// SPDX-License-Identifier: Apache-2.0
#include "core/scene/input_path.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <string.h>
#include <strings.h>

static const size_t DIGIT_LIMIT = 9;

static const char *find_name(const char *path)
{
    const char *slash = strrchr(path, '/');

    return slash ? slash + 1 : path;
}

static bool fail(struct error *error, const char *why)
{
    error_set(error, "%s", why);
    return false;
}

bool input_path_check(const char *path, struct error *error)
{
    const char *name = find_name(path), *run = strchr(name, '#');

    if (!*name) return fail(error, "expected a file's path");
    if (strlen(path) > INPUT_PATH_LIMIT) {
        error_set(error, "expected a path of at most %d bytes, got %zu", INPUT_PATH_LIMIT, strlen(path));
        return false;
    }
    for (const unsigned char *byte = (const unsigned char *)path; *byte; byte++)
        if (*byte < 0x20 || *byte == 0x7f) return fail(error, "expected a path without control bytes");
    if (!run) return true;
    if (strspn(run, "#") > DIGIT_LIMIT) return fail(error, "expected at most 9 # for the frame's number");
    if (strchr(run + strspn(run, "#"), '#'))
        return fail(error, "expected one run of # for the frame's number, got two");
    return true;
}

bool input_path_is_sequence(const char *path)
{
    return strchr(find_name(path), '#') != NULL;
}

char *input_path_format(const char *path, int32_t frame)
{
    const char *run = strchr(find_name(path), '#');

    if (!run) return xstrdup(path);
    return xasprintf("%.*s%0*d%s", (int)(run - path), path, (int)strspn(run, "#"), frame, run + strspn(run, "#"));
}

bool input_path_has_ending(const char *path, const char *ending)
{
    const char *name = find_name(path);
    size_t length = strlen(name), ending_length = strlen(ending);

    return length > ending_length && strcasecmp(name + length - ending_length, ending) == 0;
}

bool input_path_is_plain(const char *path)
{
    if (*path != '/') return false;
    while (*path == '/') {
        size_t length = strcspn(++path, "/");

        if (length == 0 || (length == 1 && path[0] == '.') || (length == 2 && path[0] == '.' && path[1] == '.'))
            return false;
        path += length;
    }
    return true;
}
