// SPDX-License-Identifier: Apache-2.0
#include "tests/support/volume_check.h"

#include "core/base/error.h"
#include "tests/support/assert_near.h"
#include "tests/support/volume_maker.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct volume *volume_check_open(const struct volume_source *source)
{
    struct volume *volume;
    struct error error = {0};

    if (!volume_open(&volume, source, &error)) fail_msg("%s", error.message);
    return volume;
}

static double stored_value(const struct volume *volume, const void *values, size_t index)
{
    switch (volume->type) {
    case VOLUME_UINT8:
        return ((const uint8_t *)values)[index];
    case VOLUME_UINT16:
        return ((const uint16_t *)values)[index];
    case VOLUME_INT16:
        return ((const int16_t *)values)[index];
    default:
        return (double)((const float *)values)[index];
    }
}

static bool read_all(struct volume *volume, char **values, struct error *error)
{
    size_t slice = (size_t)volume->size[0] * (size_t)volume->size[1] * volume_type_size(volume->type);
    int portion = 1;

    *values = malloc(slice * (size_t)volume->size[2]);
    for (int k = 0; k < volume->size[2]; k += portion++) {
        if (portion > volume->size[2] - k) portion = volume->size[2] - k;
        if (!volume_read(volume, portion, *values + (size_t)k * slice, error)) return false;
    }
    return true;
}

void volume_check_voxels(struct volume *volume)
{
    struct error error = {0};
    size_t index = 0;
    char *values;

    if (!read_all(volume, &values, &error)) fail_msg("%s", error.message);
    for (int k = 0; k < volume->size[2]; k++)
        for (int j = 0; j < volume->size[1]; j++)
            for (int i = 0; i < volume->size[0]; i++)
                assert_true(stored_value(volume, values, index++) == volume_maker_value(i, j, k));
    free(values);
}

void volume_check_place(const struct volume *volume, const int index[3], const double metres[3], double tolerance)
{
    for (size_t row = 0; row < 3; row++) {
        const double *m = volume->index_to_world + 4 * row;

        assert_near(m[0] * index[0] + m[1] * index[1] + m[2] * index[2] + m[3], metres[row], tolerance);
    }
}

void volume_check_refused(const struct volume_source *source, const char *path, const char *expected)
{
    struct volume *volume;
    struct error error = {0};
    char *values = NULL;
    bool ok = volume_open(&volume, source, &error) && read_all(volume, &values, &error);

    if (!path) path = source->path;
    if (ok) fail_msg("%s: expected \"%s\", got no error", path, expected);
    if (!strstr(error.message, expected) || strncmp(error.message, path, strlen(path)) != 0)
        fail_msg("expected \"%s: ...%s\", got \"%s\"", path, expected, error.message);
    free(values);
    volume_close(volume);
}
