// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics/metrics_write.h"

#include "core/json/json_write.h"
#include "daemon/metrics/histogram.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static void a_family_has_samples_with_their_labels(void **state)
{
    struct json_writer writer = {0};

    metrics_write_begin(&writer, "gauge", "workers", "Workers.");
    metrics_write_value(&writer, (const char *[]){"pool", "a \"b\"", "state", "idle", NULL}, 2);
    metrics_write_value(&writer, NULL, 0.5);
    metrics_write_end(&writer);
    assert_string_equal(writer.text, "{\"name\":\"workers\",\"type\":\"gauge\",\"help\":\"Workers.\",\"samples\":["
                                     "{\"labels\":{\"pool\":\"a \\\"b\\\"\",\"state\":\"idle\"},\"value\":2},"
                                     "{\"labels\":{},\"value\":0.5}]}");
    json_writer_finish(&writer);
}

static void buckets_count_all_up_to_their_end(void **state)
{
    const struct histogram_scale scale = {{0.1, 1, 5}, 3};
    struct histogram histogram = {.counts = {2, 0, 3, 4}, .sum = 50.5};
    struct json_writer writer = {0};

    metrics_write_histogram(&writer, (const char *[]){"pool", "local", NULL}, &histogram, &scale);
    assert_string_equal(writer.text, "{\"labels\":{\"pool\":\"local\"},\"buckets\":[[0.1,2],[1,2],[5,5]],"
                                     "\"sum\":50.5,\"count\":9}");
    json_writer_finish(&writer);
}

static void classes_of_others_are_a_histogram(void **state)
{
    static const double ends[] = {0.001, 0.002};
    static const uint64_t counts[] = {7, 1, 1};
    struct json_writer writer = {0};

    metrics_write_classes(&writer, NULL, ends, counts, 2, 3);
    assert_string_equal(writer.text, "{\"labels\":{},\"buckets\":[[0.001,7],[0.002,8]],\"sum\":3,\"count\":9}");
    json_writer_finish(&writer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_family_has_samples_with_their_labels),
        cmocka_unit_test(buckets_count_all_up_to_their_end),
        cmocka_unit_test(classes_of_others_are_a_histogram),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
