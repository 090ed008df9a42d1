// SPDX-License-Identifier: Apache-2.0
#include "tests/support/shader_text.h"

#include "core/base/file.h"
#include "tests/support/temp_folder.h"
#include "worker/shader/scene_program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include <cmocka.h>

void shader_text_assert_has(const struct scene_program *program, const char *text)
{
    if (!strstr(program->fragment, text)) fail_msg("expected \"%s\" in the shader", text);
}

void shader_text_assert_lacks(const struct scene_program *program, const char *text)
{
    if (strstr(program->fragment, text)) fail_msg("expected no \"%s\" in the shader", text);
}

void shader_text_keep(void **state, const struct scene_program *program, size_t index)
{
    char name[32];

    snprintf(name, sizeof name, "%zu.frag", index);
    assert_true(file_write_atomic(temp_folder_path(state, name), program->fragment, strlen(program->fragment), NULL));
    assert_true(
        file_write_atomic(temp_folder_path(state, "fullscreen.vert"), program->vertex, strlen(program->vertex), NULL));
}

void shader_text_assert_valid(void **state)
{
    char command[1200];
    int status;

    snprintf(command, sizeof command, "cd %s && glslangValidator *.frag *.vert > log 2>&1", (char *)*state);
    status = system(command);
    if (WEXITSTATUS(status) == 127) {
        print_message("skipped: glslangValidator is not installed\n");
        skip();
    }
    if (status != 0) {
        char *log = NULL;
        size_t length;

        (void)file_read_text(temp_folder_path(state, "log"), 1 << 20, &log, &length, NULL);
        fail_msg("glslangValidator: %s", log ? log : "");
    }
}
