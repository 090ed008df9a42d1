// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/sweeper.h"

#include "daemon/farm/job_table.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const char farm[] = "0123456789abcdef0123456789abcdef";

static void only_part_files_of_the_job_are_swept(void **state)
{
    struct job_record record = {.id = 12};

    assert_true(output_path_parse(&record.path, "c.##.exr", NULL));
    assert_true(sweeper_is_part_of(&record, farm, "c.07.exr.01234567.12.3.1.part"));
    assert_false(sweeper_is_part_of(&record, farm, "c.07.exr.01234567.13.3.1.part"));
    assert_false(sweeper_is_part_of(&record, farm, "c.07.exr.01234567.12.3.part"));
    assert_false(sweeper_is_part_of(&record, farm, "d.07.exr.01234567.12.3.1.part"));
    assert_false(sweeper_is_part_of(&record, farm, "c.07.exr"));
    assert_false(sweeper_is_part_of(&record, farm, "c.07.exr.01234567.12.3.1x.part"));
    assert_false(sweeper_is_part_of(&record, farm, ".part"));
    output_path_finish(&record.path);
}

static void part_files_of_other_farms_stay(void **state)
{
    struct job_record record = {.id = 12};

    assert_true(output_path_parse(&record.path, "c.##.exr", NULL));
    assert_false(sweeper_is_part_of(&record, farm, "c.07.exr.01234568.12.3.1.part"));
    assert_false(sweeper_is_part_of(&record, farm, "c.07.exr.0123456.12.3.1.part"));
    assert_true(sweeper_is_part_of(&record, farm, "c.07.exr.12.3.1.part")); // of an older version
    output_path_finish(&record.path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_part_files_of_the_job_are_swept),
        cmocka_unit_test(part_files_of_other_farms_stay),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
