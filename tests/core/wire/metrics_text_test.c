// SPDX-License-Identifier: Apache-2.0
#include "core/wire/metrics_text.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static char *format(const char *json, struct error *error)
{
    struct cJSON *root = NULL;
    struct json_node node;
    char *text;

    assert_true(json_parse(&root, json, strlen(json), error));
    node = json_node_root(root);
    text = metrics_text_format(&node, error);
    json_delete(root);
    return text;
}

static void assert_text(const char *json, const char *expected)
{
    struct error error = {0};
    char *text = format(json, &error);

    assert_string_equal(error.message, "");
    assert_non_null(text);
    assert_string_equal(text, expected);
    free(text);
}

// `family` is one in the middle of an answer.
static void assert_refused(const char *family, const char *expected)
{
    char *json =
        xasprintf("{\"families\":[{\"name\":\"a\",\"type\":\"gauge\",\"help\":\"\",\"samples\":[]},%s]}", family);
    struct error error = {0};

    assert_null(format(json, &error));
    if (!strstr(error.message, expected)) fail_msg("expected \"%s\", got \"%s\"", expected, error.message);
    free(json);
}

static void counters_and_gauges_are_lines(void **state)
{
    assert_text("{\"families\":["
                "{\"name\":\"up_total\",\"type\":\"counter\",\"help\":\"How often.\",\"samples\":["
                "{\"labels\":{},\"value\":3}]},"
                "{\"name\":\"depth\",\"type\":\"gauge\",\"help\":\"How deep.\",\"samples\":["
                "{\"labels\":{\"pool\":\"local\",\"state\":\"idle\"},\"value\":0.1},"
                "{\"labels\":{\"pool\":\"b\"},\"value\":-2.5e-7},"
                "{\"labels\":{\"pool\":\"c\"},\"value\":9007199254740993}]}]}",
                "# HELP up_total How often.\n"
                "# TYPE up_total counter\n"
                "up_total 3\n"
                "# HELP depth How deep.\n"
                "# TYPE depth gauge\n"
                "depth{pool=\"local\",state=\"idle\"} 0.1\n"
                "depth{pool=\"b\"} -2.5e-07\n"
                "depth{pool=\"c\"} 9007199254740992\n");
}

static void a_histogram_ends_with_all(void **state)
{
    assert_text("{\"families\":[{\"name\":\"s\",\"type\":\"histogram\",\"help\":\"h\",\"samples\":["
                "{\"labels\":{\"pool\":\"local\"},\"buckets\":[[0.1,2],[1,2],[60,7]],\"sum\":31.5,\"count\":9},"
                "{\"labels\":{},\"buckets\":[],\"sum\":0,\"count\":0}]}]}",
                "# HELP s h\n"
                "# TYPE s histogram\n"
                "s_bucket{pool=\"local\",le=\"0.1\"} 2\n"
                "s_bucket{pool=\"local\",le=\"1\"} 2\n"
                "s_bucket{pool=\"local\",le=\"60\"} 7\n"
                "s_bucket{pool=\"local\",le=\"+Inf\"} 9\n"
                "s_sum{pool=\"local\"} 31.5\n"
                "s_count{pool=\"local\"} 9\n"
                "s_bucket{le=\"+Inf\"} 0\n"
                "s_sum 0\n"
                "s_count 0\n");
}

static void marks_are_escaped(void **state)
{
    assert_text("{\"families\":[{\"name\":\"a\",\"type\":\"gauge\",\"help\":\"a \\\\ b \\\" c \\n d\",\"samples\":["
                "{\"labels\":{\"x\":\"a \\\\ b \\\" c \\n d\"},\"value\":1}]}]}",
                "# HELP a a \\\\ b \" c \\n d\n"
                "# TYPE a gauge\n"
                "a{x=\"a \\\\ b \\\" c \\n d\"} 1\n");
}

static void what_no_number_says_is_nan(void **state)
{
    assert_text("{\"families\":[{\"name\":\"a\",\"type\":\"gauge\",\"help\":\"\",\"samples\":["
                "{\"labels\":{},\"value\":null}]}]}",
                "# HELP a \n# TYPE a gauge\na NaN\n");
}

static void no_family_is_no_text(void **state)
{
    assert_text("{\"families\":[]}", "");
}

static void what_prometheus_would_misread_is_refused(void **state)
{
#define FAMILY(name, type, samples)                                                                                    \
    "{\"name\":\"" name "\",\"type\":\"" type "\",\"help\":\"\",\"samples\":[" samples "]}"
    assert_refused(FAMILY("a", "gauge", ""), "families[1].name: expected a name that no family before has");
    assert_refused(FAMILY("1a", "gauge", ""), "families[1].name: expected letters, digits and _");
    assert_refused(FAMILY("", "gauge", ""), "families[1].name");
    assert_refused(FAMILY("b c", "gauge", ""), "families[1].name");
    assert_refused(FAMILY("b\\nc", "gauge", ""), "families[1].name");
    assert_refused(FAMILY("b", "summary", ""), "families[1].type: expected one of");
    assert_refused("7", "families[1]: expected an object");
    assert_refused("{\"name\":\"b\",\"type\":\"gauge\",\"samples\":[]}", "families[1].help: expected");
    assert_refused(FAMILY("b", "gauge", "3"), "families[1].samples[0]: expected an object");
    assert_refused(FAMILY("b", "gauge", "{\"value\":1}"), "families[1].samples[0].labels");
    assert_refused(FAMILY("b", "gauge", "{\"labels\":{}}"), "families[1].samples[0].value");
    assert_refused(FAMILY("b", "gauge", "{\"labels\":{\"le\":\"1\"},\"value\":1}"),
                   "labels.le: expected a label's name");
    assert_refused(FAMILY("b", "gauge", "{\"labels\":{\"__name__\":\"1\"},\"value\":1}"), "a label's name");
    assert_refused(FAMILY("b", "gauge", "{\"labels\":{\"x\\\"\":\"1\"},\"value\":1}"), "a label's name");
    assert_refused(FAMILY("b", "gauge", "{\"labels\":{\"x\":1},\"value\":1}"), "labels.x: expected");
    assert_refused(FAMILY("b", "histogram", "{\"labels\":{},\"buckets\":[[1,2],[1,3]],\"sum\":1,\"count\":3}"),
                   "buckets[1][0]: expected more than the end before");
    assert_refused(FAMILY("b", "histogram", "{\"labels\":{},\"buckets\":[[1,2],[2,1]],\"sum\":1,\"count\":3}"),
                   "buckets[1][1]");
    assert_refused(FAMILY("b", "histogram", "{\"labels\":{},\"buckets\":[[1,2]],\"sum\":1,\"count\":1}"), "].count");
    assert_refused(FAMILY("b", "histogram", "{\"labels\":{},\"buckets\":[[1]],\"sum\":1,\"count\":1}"), "buckets[0]");
    assert_refused(FAMILY("b", "histogram", "{\"labels\":{},\"buckets\":[],\"count\":1}"), "].sum");
#undef FAMILY
}

static void an_answer_without_families_is_refused(void **state)
{
    struct error error = {0};

    assert_null(format("{}", &error));
    assert_non_null(strstr(error.message, "families: expected an array"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counters_and_gauges_are_lines),
        cmocka_unit_test(a_histogram_ends_with_all),
        cmocka_unit_test(marks_are_escaped),
        cmocka_unit_test(what_no_number_says_is_nan),
        cmocka_unit_test(no_family_is_no_text),
        cmocka_unit_test(what_prometheus_would_misread_is_refused),
        cmocka_unit_test(an_answer_without_families_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
