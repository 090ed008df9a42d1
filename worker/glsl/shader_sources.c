// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/shader_sources.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MODULE_SIZE_LIMIT = 1 << 20 };

char *shader_sources_load(const char *shader_dir, const char *name, struct error *error)
{
    char *path = shader_dir ? xasprintf("%s/%s", shader_dir, name) : NULL;
    char *text = NULL;
    size_t length;

    if (path && access(path, F_OK) == 0) {
        file_read_text(path, MODULE_SIZE_LIMIT, &text, &length, error);
        goto out;
    }
    for (const struct shader_source *source = shader_sources_embedded; source->name; ++source)
        if (strcmp(source->name, name) == 0) text = xstrdup(source->text);
    if (!text) error_set(error, "shader: no module \"%s\"", name);
out:
    free(path);
    return text;
}
