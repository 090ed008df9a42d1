// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/sweeper.h"

#include "daemon/farm/job_table.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void only_part_files_of_the_job_are_swept(void **state)
{
    struct job_record record = {.id = 12};

    assert_true(output_path_parse(&record.path, "c.##.exr", NULL));
    assert_true(sweeper_is_part_of(&record, "c.07.exr.12.3.1.part"));
    assert_false(sweeper_is_part_of(&record, "c.07.exr.13.3.1.part"));
    assert_false(sweeper_is_part_of(&record, "c.07.exr.12.3.part"));
    assert_false(sweeper_is_part_of(&record, "d.07.exr.12.3.1.part"));
    assert_false(sweeper_is_part_of(&record, "c.07.exr"));
    assert_false(sweeper_is_part_of(&record, "c.07.exr.12.3.1x.part"));
    assert_false(sweeper_is_part_of(&record, ".part"));
    output_path_finish(&record.path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_part_files_of_the_job_are_swept),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
