// Any text is either refused with its position or read into names that can be written as directives.
// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/glsl_names.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void require(bool condition)
{
    if (!condition) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static const char *const taken[] = {"Spectrum", NULL};
    char *text = xstrndup((const char *)bytes, size);
    struct glsl_names names;
    struct error error = {{0}};

    if (glsl_names_read(&names, "fuzz.glsl", text, taken, &error)) {
        char *written = NULL;
        size_t length;
        FILE *out = open_memstream(&written, &length);

        glsl_names_write_private(&names, "medium_0_own", out);
        glsl_names_write_hide(&names, out);
        fclose(out);
        require(strlen(written) == length);
        for (size_t i = 0; i < names.count; i++) {
            require(names.names[i].text[0] && names.names[i].line >= 1);
            require(strcmp(names.names[i].text, "Spectrum") != 0);
        }
        free(written);
    } else {
        require(strncmp(error.message, "fuzz.glsl:", 10) == 0 && names.count == 0);
    }
    glsl_names_finish(&names);
    free(text);
    return 0;
}
