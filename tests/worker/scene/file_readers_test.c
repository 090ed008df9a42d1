// Every format of grids that a job may name has a reader: the table of names is in core/, the readers are in worker/.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/scene/file_format.h"
#include "worker/sparse/sparse_file.h"
#include "worker/volume/volume.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// A reader finds that the file is not there; without one its name is refused.
static void find_reader(const struct file_format *format, struct error *error)
{
    char path[64];

    snprintf(path, sizeof path, "/nowhere/a_4x4x4xuint8%s", format->ending);
    switch (format->content) {
    case FILE_GRID_RAW:
    case FILE_GRID_DENSE: {
        struct volume *volume;

        assert_false(volume_open(&volume, &(struct volume_source){.path = path}, error));
        break;
    }
    case FILE_GRID_SPARSE: {
        struct sparse_file file;

        assert_false(sparse_file_load(&file, path, NULL, error));
        break;
    }
    case FILE_IMAGE:
        fail_msg("images are known by their first bytes");
    }
}

static void every_format_has_a_reader(void **state)
{
    for (size_t i = 0; i < file_format_count; ++i) {
        struct error error = {{0}};

        if (file_formats[i].content == FILE_IMAGE) continue;
        find_reader(&file_formats[i], &error);
        if (strstr(error.message, "ending") || strstr(error.message, "ends in"))
            fail_msg("%s has no reader: %s", file_formats[i].ending, error.message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_format_has_a_reader)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
