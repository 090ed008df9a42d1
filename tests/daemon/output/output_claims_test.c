// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/output_claims.h"

#include "daemon/farm/farm.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The files of one job. Owned; see files_finish.
struct files {
    struct output_path path;
    struct frame_range frames;
    struct job_files files;
};

static void files_init(struct files *files, const char *root, const char *pattern, const char *range)
{
    assert_true(output_path_parse(&files->path, pattern, NULL));
    assert_true(frame_range_parse(&files->frames, range, NULL));
    files->files = (struct job_files){root, &files->path, &files->frames, NULL};
}

static void files_finish(struct files *files)
{
    output_path_finish(&files->path);
    frame_range_finish(&files->frames);
}

static void a_submission_keeps_its_files_until_its_claim_is_removed(void **state)
{
    struct farm farm = {0};
    struct files files, same, others;
    struct output_claim claim;
    int32_t frame = -1;

    files_init(&files, "/out", "a/a.#.exr", "1-9");
    files_init(&same, "/out", "a/a.#.exr", "9-12");
    files_init(&others, "/out", "a/b.#.exr", "1-9");
    claim = (struct output_claim){.files = files.files, .name = "ash"};
    assert_null(output_claims_find_collision(&farm, &same.files, &frame));
    output_claims_add(&farm, &claim);
    assert_string_equal(output_claims_find_collision(&farm, &same.files, &frame), "ash");
    assert_int_equal(frame, 9);
    assert_null(output_claims_find_collision(&farm, &others.files, &frame));
    assert_true(output_claims_use_folder(&farm, &others.files));
    assert_null(output_claims_find_removal(&farm, &same.files));
    output_claims_remove(&farm, &claim);
    assert_null(output_claims_find_collision(&farm, &same.files, &frame));
    assert_false(output_claims_use_folder(&farm, &others.files));
    files_finish(&files);
    files_finish(&same);
    files_finish(&others);
}

static void a_removal_keeps_its_folder(void **state)
{
    struct farm farm = {0};
    struct job_record record = {.id = 7};
    struct files files, others, elsewhere;
    struct output_claim claim, later;
    int32_t frame = -1;

    files_init(&files, "/out", "a/a.#.exr", "1-9");
    files_init(&others, "/out", "a/b.#.exr", "1");
    files_init(&elsewhere, "/other", "a/a.#.exr", "1-9");
    claim = (struct output_claim){.files = files.files, .removed = &record};
    later = (struct output_claim){.files = elsewhere.files, .removed = &record};
    output_claims_add(&farm, &claim);
    assert_ptr_equal(output_claims_find_removal(&farm, &others.files), &record);
    assert_null(output_claims_find_removal(&farm, &elsewhere.files));
    assert_false(output_claims_use_folder(&farm, &others.files));
    assert_null(output_claims_find_collision(&farm, &files.files, &frame));
    output_claims_add(&farm, &later);
    output_claims_remove(&farm, &claim);
    assert_null(output_claims_find_removal(&farm, &others.files));
    assert_ptr_equal(output_claims_find_removal(&farm, &elsewhere.files), &record);
    files_finish(&files);
    files_finish(&others);
    files_finish(&elsewhere);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_submission_keeps_its_files_until_its_claim_is_removed),
        cmocka_unit_test(a_removal_keeps_its_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
