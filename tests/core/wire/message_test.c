// SPDX-License-Identifier: Apache-2.0
#include "core/wire/message.h"

#include "core/base/error.h"
#include "core/json/json_write.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct message decode(const char *line)
{
    struct message message;
    enum message_code code;
    struct error error = {0};

    if (!message_decode(&message, line, strlen(line), &code, &error)) fail_msg("%s: %s", line, error.message);
    return message;
}

static void assert_refused(const char *line, enum message_code expected_code, const char *id, const char *expected)
{
    struct message message;
    enum message_code code = 0;
    struct error error = {0};

    if (message_decode(&message, line, strlen(line), &code, &error)) fail_msg("accepted: %s", line);
    assert_string_equal(error.message, expected);
    assert_int_equal(code, expected_code);
    assert_string_equal(message.id, id);
    assert_null(message.root);
    message_finish(&message);
}

static void request_has_id_method_and_params(void **state)
{
    struct message message = decode("{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"job.show\",\"params\":{\"id\":3}}");
    struct json_node id = json_node_child(&message.body, "id");
    struct error error = {0};
    int64_t number;

    assert_int_equal(message.kind, MESSAGE_REQUEST);
    assert_string_equal(message.id, "7");
    assert_string_equal(message.method, "job.show");
    assert_true(json_read_integer(&id, 0, 10, &number, NULL));
    assert_int_equal(number, 3);
    assert_false(json_read_integer(&id, 4, 10, &number, &error));
    assert_string_equal(error.message, "params.id: expected an integer from 4 to 10, got 3");
    message_finish(&message);
}

static void message_without_an_id_is_a_notification(void **state)
{
    struct message message = decode("{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\"}");

    assert_int_equal(message.kind, MESSAGE_NOTIFICATION);
    assert_string_equal(message.id, "");
    assert_true(json_node_is_absent(&message.body));
    message_finish(&message);
    message = decode("{\"jsonrpc\":\"2.0\",\"method\":\"later\",\"params\":[1],\"extra\":1}");
    assert_int_equal(json_node_count(&message.body), 1);
    message_finish(&message);
}

static void ids_are_kept_as_json(void **state)
{
    static const char *const ids[] = {"0",
                                      "-5",
                                      "9007199254740991",
                                      "\"a\\\"b\"",
                                      "\"\"",
                                      "null",
                                      "\"012345678901234567890123456789012345678901234567890123456789\""};

    for (size_t i = 0; i < sizeof ids / sizeof ids[0]; i++) {
        char line[256];
        struct message message;

        snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"id\":%s,\"method\":\"m\"}", ids[i]);
        message = decode(line);
        assert_int_equal(message.kind, MESSAGE_REQUEST);
        assert_string_equal(message.id, ids[i]);
        message_finish(&message);
    }
}

static void other_ids_are_refused(void **state)
{
    static const char *const ids[][2] = {
        {"1.5", "1.5"},
        {"true", "true"},
        {"[1]", "an array of 1"},
        {"1e30", "1e+30"},
        {"\"0123456789012345678901234567890123456789012345678901234567890\"",
         "\"0123456789012345678901234567890123456789...\""},
        {"\"\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\"",
         "\"\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\\u0001\""}};

    for (size_t i = 0; i < sizeof ids / sizeof ids[0]; i++) {
        char line[256], expected[256];

        snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"id\":%s,\"method\":\"m\"}", ids[i][0]);
        snprintf(expected, sizeof expected, "id: expected an integer, null or a string of at most 60 bytes, got %s",
                 ids[i][1]);
        assert_refused(line, MESSAGE_CODE_INVALID, "", expected);
    }
}

static void result_and_error_answer_a_request(void **state)
{
    struct message message = decode("{\"jsonrpc\":\"2.0\",\"id\":\"q\",\"result\":null}");

    assert_int_equal(message.kind, MESSAGE_RESULT);
    assert_string_equal(message.id, "\"q\"");
    assert_int_equal(json_node_type(&message.body), JSON_NULL);
    message_finish(&message);
    message = decode("{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":-32602,\"message\":\"no\",\"data\":{}}}");
    assert_int_equal(message.kind, MESSAGE_ERROR);
    assert_int_equal(message.code, MESSAGE_CODE_PARAMS);
    assert_string_equal(message.text, "no");
    message_finish(&message);
}

static void text_that_is_no_json_is_a_parse_error(void **state)
{
    assert_refused("{\"jsonrpc\"", MESSAGE_CODE_PARSE, "",
                   "line 1, column 11: expected ':' after a key, got the end of the text");
    assert_refused("", MESSAGE_CODE_PARSE, "", "line 1, column 1: expected a value, got the end of the text");
}

static void invalid_requests_keep_their_id(void **state)
{
    assert_refused("{\"id\":4,\"method\":\"m\"}", MESSAGE_CODE_INVALID, "4", "jsonrpc: expected \"2.0\", got nothing");
    assert_refused("{\"jsonrpc\":2.0,\"id\":4,\"method\":\"m\"}", MESSAGE_CODE_INVALID, "4",
                   "jsonrpc: expected \"2.0\", got 2");
    assert_refused("{\"jsonrpc\":\"2.0\",\"id\":4,\"method\":5}", MESSAGE_CODE_INVALID, "4",
                   "method: expected a string, got 5");
    assert_refused("{\"jsonrpc\":\"2.0\",\"id\":4,\"method\":\"m\",\"params\":5}", MESSAGE_CODE_INVALID, "4",
                   "params: expected an object or an array, got 5");
    assert_refused("{\"jsonrpc\":\"2.0\",\"id\":4,\"method\":\"m\",\"parms\":{}}", MESSAGE_CODE_INVALID, "4",
                   "unknown key \"parms\", did you mean \"params\"?");
    assert_refused("{\"jsonrpc\":\"2.0\",\"id\":4}", MESSAGE_CODE_INVALID, "4",
                   "expected a method, a result or an error");
    assert_refused("{\"jsonrpc\":\"2.0\",\"id\":4,\"result\":1,\"error\":{}}", MESSAGE_CODE_INVALID, "4",
                   "expected a method, a result or an error");
    assert_refused("{\"jsonrpc\":\"2.0\",\"result\":1}", MESSAGE_CODE_INVALID, "",
                   "id: expected the id of a request, got nothing");
    assert_refused("{\"jsonrpc\":\"2.0\",\"id\":4,\"error\":{\"code\":\"x\",\"message\":\"\"}}", MESSAGE_CODE_INVALID,
                   "4", "error.code: expected an integer from -2147483648 to 2147483647, got \"x\"");
    assert_refused("{\"jsonrpc\":\"2.0\",\"id\":4,\"error\":\"x\"}", MESSAGE_CODE_INVALID, "4",
                   "error: expected an object, got \"x\"");
    assert_refused("[{\"jsonrpc\":\"2.0\",\"id\":4,\"method\":\"m\"}]", MESSAGE_CODE_INVALID, "",
                   "expected an object, got an array of 1");
}

static void written_messages_decode_to_the_same(void **state)
{
    struct json_writer writer = {0};
    struct message message;

    message_begin_request(&writer, 12, "job.show");
    json_write_begin_object(&writer);
    json_write_end_object(&writer);
    message_end(&writer);
    message_begin_notification(&writer, "worker.exit");
    json_write_begin_array(&writer);
    json_write_end_array(&writer);
    message_end(&writer);
    message_begin_result(&writer, "\"q\"");
    json_write_integer(&writer, 5);
    message_end(&writer);
    message_write_error(&writer, "3", MESSAGE_CODE_CONFLICT, "another job\nowns it");
    assert_string_equal(
        writer.text, "{\"jsonrpc\":\"2.0\",\"id\":12,\"method\":\"job.show\",\"params\":{}}\n"
                     "{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\",\"params\":[]}\n"
                     "{\"jsonrpc\":\"2.0\",\"id\":\"q\",\"result\":5}\n"
                     "{\"jsonrpc\":\"2.0\",\"id\":3,\"error\":{\"code\":3,\"message\":\"another job\\nowns it\"}}\n");
    json_writer_clear(&writer);
    message_write_error(&writer, "3", MESSAGE_CODE_STORE, "full");
    message = decode(writer.text);
    assert_int_equal(message.code, MESSAGE_CODE_STORE);
    assert_string_equal(message.text, "full");
    message_finish(&message);
    json_writer_finish(&writer);
}

static void error_without_a_known_id_answers_null(void **state)
{
    struct json_writer writer = {0};

    message_write_error(&writer, "", MESSAGE_CODE_PARSE, "x");
    message_write_error(&writer, NULL, MESSAGE_CODE_PARSE, "x");
    assert_string_equal(writer.text,
                        "{\"jsonrpc\":\"2.0\",\"id\":null,\"error\":{\"code\":-32700,\"message\":\"x\"}}\n"
                        "{\"jsonrpc\":\"2.0\",\"id\":null,\"error\":{\"code\":-32700,\"message\":\"x\"}}\n");
    json_writer_finish(&writer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(request_has_id_method_and_params),
        cmocka_unit_test(message_without_an_id_is_a_notification),
        cmocka_unit_test(ids_are_kept_as_json),
        cmocka_unit_test(other_ids_are_refused),
        cmocka_unit_test(result_and_error_answer_a_request),
        cmocka_unit_test(text_that_is_no_json_is_a_parse_error),
        cmocka_unit_test(invalid_requests_keep_their_id),
        cmocka_unit_test(written_messages_decode_to_the_same),
        cmocka_unit_test(error_without_a_known_id_answers_null),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
