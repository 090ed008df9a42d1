// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume.h"

#include "tests/support/temp_folder.h"
#include "tests/support/volume_check.h"
#include "tests/support/volume_maker.h"
#include "tests/support/volume_maker_nifti.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

// About 300 KiB, more than either buffer holds.
static const int size[3] = {60, 50, 100};

struct fixture {
    struct volume_source source;
    struct volume_maker_nifti nifti;
    unsigned char *zipped; // with 64 bytes of room
    size_t zipped_bytes;
};

static struct fixture make(void **state)
{
    struct fixture fixture = {.source = {.path = temp_folder_path(state, "a.nii.gz")}};

    volume_maker_nifti_init(&fixture.nifti, 1, false, size, VOLUME_STORED_INT16);
    fixture.zipped = volume_maker_gzip(fixture.nifti.bytes, fixture.nifti.size_bytes, &fixture.zipped_bytes);
    fixture.zipped = realloc(fixture.zipped, 2 * fixture.nifti.size_bytes + 64);
    return fixture;
}

static void finish(struct fixture *fixture)
{
    volume_maker_nifti_finish(&fixture->nifti);
    free(fixture->zipped);
}

static void refuse(const struct fixture *fixture, size_t zipped_bytes, const char *expected)
{
    volume_maker_write(fixture->source.path, fixture->zipped, zipped_bytes);
    volume_check_refused(&fixture->source, NULL, expected);
}

static void truncated_files_are_refused_wherever_they_end(void **state)
{
    struct fixture fixture = make(state);

    refuse(&fixture, 0, "ends after 0 bytes");
    refuse(&fixture, 1, "its gzip data end before they are complete, after 1 bytes");
    refuse(&fixture, 20, "its gzip data end before they are complete, after 20 bytes");
    refuse(&fixture, fixture.zipped_bytes / 2, "its gzip data end before they are complete");
    // All voxels are read by then; the checksum is not.
    refuse(&fixture, fixture.zipped_bytes - 1, "its gzip data end before they are complete");
    finish(&fixture);
}

static void damaged_files_are_refused(void **state)
{
    struct fixture fixture = make(state);

    fixture.zipped[fixture.zipped_bytes - 5] ^= 1;
    refuse(&fixture, fixture.zipped_bytes, "damaged (incorrect data check)");
    fixture.zipped[fixture.zipped_bytes - 5] ^= 1;
    fixture.zipped[0] = 'x';
    refuse(&fixture, fixture.zipped_bytes, "no gzip data, or damaged (incorrect header check)");
    finish(&fixture);
}

static void what_follows_is_refused(void **state)
{
    struct fixture fixture = make(state);
    size_t more_bytes;
    unsigned char *more = volume_maker_gzip("more", 4, &more_bytes);

    fixture.zipped[fixture.zipped_bytes] = 'x';
    refuse(&fixture, fixture.zipped_bytes + 1, "its gzip data end before they are complete");
    fixture.zipped[fixture.zipped_bytes + 1] = 'y';
    refuse(&fixture, fixture.zipped_bytes + 2,
           "expected its end or more gzip data behind the first, got something else");
    memcpy(fixture.zipped + fixture.zipped_bytes, more, more_bytes);
    refuse(&fixture, fixture.zipped_bytes + more_bytes, "goes on after its last voxel");
    free(more);
    finish(&fixture);
}

// Block-wise compressors write such members.
static void members_in_a_row_are_one_file(void **state)
{
    struct fixture fixture = make(state);
    struct volume *volume;

    fixture.zipped_bytes = 0;
    for (size_t at = 0; at < fixture.nifti.size_bytes; at += 10007) {
        size_t left = fixture.nifti.size_bytes - at;
        size_t member_bytes;
        unsigned char *member = volume_maker_gzip(fixture.nifti.bytes + at, left < 10007 ? left : 10007, &member_bytes);

        memcpy(fixture.zipped + fixture.zipped_bytes, member, member_bytes);
        fixture.zipped_bytes += member_bytes;
        free(member);
    }
    volume_maker_write(fixture.source.path, fixture.zipped, fixture.zipped_bytes);
    volume = volume_check_open(&fixture.source);
    volume_check_voxels(volume);
    volume_close(volume);
    finish(&fixture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(truncated_files_are_refused_wherever_they_end),
        cmocka_unit_test(damaged_files_are_refused),
        cmocka_unit_test(what_follows_is_refused),
        cmocka_unit_test(members_in_a_row_are_one_file),
    };

    return cmocka_run_group_tests(tests, temp_folder_create, temp_folder_destroy);
}
