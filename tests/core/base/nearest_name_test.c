// SPDX-License-Identifier: Apache-2.0
#include "core/base/nearest_name.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void nearest_name_is_near_or_none(void **state)
{
    static const char *const names[] = {"position", "target", "up", "fov", NULL};

    assert_string_equal(nearest_name_find("postion", names), "position");
    assert_string_equal(nearest_name_find("psoition", names), "position");
    assert_string_equal(nearest_name_find("taget", names), "target");
    assert_string_equal(nearest_name_find("fow", names), "fov");
    assert_string_equal(nearest_name_find("FOV", names), "fov");
    assert_string_equal(nearest_name_find("Target", names), "target");
    assert_null(nearest_name_find("fin", names));
    assert_string_equal(nearest_name_find("fov", names), "fov");
    assert_null(nearest_name_find("zebra", names));
    assert_null(nearest_name_find("", names));
    assert_null(nearest_name_find("positionpositionpositionpositionpositionpositionposition", names));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearest_name_is_near_or_none),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
