// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/token_table.h"

#include "core/base/alloc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static struct token *add(struct token_table *table, int64_t id, int64_t uid, const char *text)
{
    struct token token = {.id = id, .uid = uid, .name = xstrdup(text), .user = xstrdup("ada")};

    token_text_hash(text, token.hash);
    return token_table_add(table, &token);
}

static struct token *match(const struct token_table *table, const char *text)
{
    char hash[TOKEN_HASH_SIZE];

    token_text_hash(text, hash);
    return token_table_match(table, hash);
}

static void a_token_is_found_by_its_text_and_by_its_id(void **state)
{
    struct token_table table = {0};
    struct token *tokens[50];

    assert_null(match(&table, "text 0"));
    for (int i = 0; i < 50; i++) {
        char text[16];

        snprintf(text, sizeof text, "text %d", i);
        tokens[i] = add(&table, 0, i % 2, text);
    }
    for (int i = 0; i < 50; i++) {
        char text[16];

        snprintf(text, sizeof text, "text %d", i);
        assert_ptr_equal(match(&table, text), tokens[i]);
        assert_ptr_equal(token_table_find(&table, i + 1), tokens[i]);
    }
    assert_null(match(&table, "text 50"));
    assert_null(token_table_find(&table, 51));
    assert_null(token_table_find(&table, 0));
    token_table_finish(&table);
}

static void ids_are_never_given_again(void **state)
{
    struct token_table table = {0};

    assert_int_equal(add(&table, 0, 1, "a")->id, 1);
    assert_int_equal(add(&table, 7, 1, "b")->id, 7); // as a store has it
    assert_int_equal(add(&table, 3, 1, "c")->id, 3);
    token_table_remove(&table, token_table_find(&table, 7));
    assert_null(match(&table, "b"));
    assert_int_equal(add(&table, 0, 1, "d")->id, 8);
    assert_int_equal(table.count, 3);
    for (size_t i = 0; i + 1 < table.count; i++)
        assert_true(table.tokens[i]->id < table.tokens[i + 1]->id);
    token_table_finish(&table);
    assert_int_equal(table.count, 0);
}

static void tokens_of_a_user_are_counted(void **state)
{
    struct token_table table = {0};

    add(&table, 0, 1000, "a");
    add(&table, 0, 1001, "b");
    add(&table, 0, 1000, "c");
    assert_int_equal(token_table_count_user(&table, 1000), 2);
    assert_int_equal(token_table_count_user(&table, 1001), 1);
    assert_int_equal(token_table_count_user(&table, 0), 0);
    token_table_finish(&table);
}

static void a_token_ends_at_its_time(void **state)
{
    const struct token endless = {0}, token = {.expires_ms = 1000};

    assert_false(token_has_expired(&endless, INT64_MAX));
    assert_false(token_has_expired(&token, 999));
    assert_true(token_has_expired(&token, 1000));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_token_is_found_by_its_text_and_by_its_id),
        cmocka_unit_test(ids_are_never_given_again),
        cmocka_unit_test(tokens_of_a_user_are_counted),
        cmocka_unit_test(a_token_ends_at_its_time),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
