// SPDX-License-Identifier: Apache-2.0
#include "cli/render/plan_report.h"

#include "core/json/json_read.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_printed(const char *quality, const char *expected)
{
    FILE *console = stdout;
    struct cJSON *root = NULL;
    struct json_node node;
    char *text = NULL;
    size_t length;

    assert_true(json_parse(&root, quality, strlen(quality), NULL));
    node = json_node_root(root);
    stdout = open_memstream(&text, &length);
    plan_report_print_quality(&node);
    fclose(stdout);
    stdout = console;
    json_delete(root);
    assert_string_equal(text, expected);
    free(text);
}

static void a_quality_is_its_method_and_its_numbers(void **state)
{
    assert_printed("{\"method\":\"cached\",\"step\":0.0625,\"light_grid\":32,\"samples\":1}",
                   "cached, step 0.0625, light_grid 32, samples 1\n");
}

static void numbers_of_pixels_are_named_as_they_are_set(void **state)
{
    assert_printed("{\"method\":\"gauss\",\"samples\":1,\"pixels\":{\"stride\":16,\"threshold\":0.01},\"max_depth\":8}",
                   "gauss, samples 1, pixels.stride 16, pixels.threshold 0.01, max_depth 8\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_quality_is_its_method_and_its_numbers),
        cmocka_unit_test(numbers_of_pixels_are_named_as_they_are_set),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
