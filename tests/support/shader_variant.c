// SPDX-License-Identifier: Apache-2.0
#include "tests/support/shader_variant.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/folders.h"
#include "tests/support/shader_dir.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

enum { TEXT_LIMIT = 1 << 16 };

void shader_variant_write(void **state, const char *name, const char *from, const char *to)
{
    const char *folder = test_shader_dir() ? test_shader_dir() : PROJECT_ROOT "/shaders";
    char path[512], room[32], changed[TEXT_LIMIT], *text, *place;
    struct error error = {{0}};
    int length;

    assert_true(strcspn(name, "/") < sizeof room);
    snprintf(room, sizeof room, "%.*s", (int)strcspn(name, "/"), name);
    (void)mkdir(temp_folder_path(state, room), 0700);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (!file_read_text(path, TEXT_LIMIT, &text, NULL, &error)) fail_msg("%s", error.message);
    place = strstr(text, from);
    assert_non_null(place);
    length = snprintf(changed, sizeof changed, "%.*s%s%s", (int)(place - text), text, to, place + strlen(from));
    assert_true(length < TEXT_LIMIT);
    assert_true(file_write_atomic(temp_folder_path(state, name), changed, (size_t)length, NULL));
    free(text);
}
