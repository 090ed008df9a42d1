// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_credentials.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void expect_from_header(const char *header, const char *expected)
{
    char *token = http_credentials_from_header(header);

    if (expected)
        assert_string_equal(token, expected);
    else
        assert_null(token);
    http_credentials_free(token);
}

static void expect_from_cookie(const char *cookies, const char *expected)
{
    char *token = http_credentials_from_cookie(cookies);

    if (expected)
        assert_string_equal(token, expected);
    else
        assert_null(token);
    http_credentials_free(token);
}

static void bearer_tokens_are_read(void **state)
{
    (void)state;
    expect_from_header("Bearer abc-DEF_1.2~3", "abc-DEF_1.2~3");
    expect_from_header("bearer  abc ", "abc");
    expect_from_header("Basic YTpi", NULL);
    expect_from_header("Bearer", NULL);
    expect_from_header("Bearer ", NULL);
    expect_from_header("Bearer a b", NULL);
    expect_from_header("Bearer a\"b", NULL);
    expect_from_header("", NULL);
}

static void our_cookie_is_found_among_others(void **state)
{
    (void)state;
    expect_from_cookie("marchd_session=abc", "abc");
    expect_from_cookie("a=b; marchd_session=abc; c=d", "abc");
    expect_from_cookie("a=b;marchd_session=abc ;c=d", "abc");
    expect_from_cookie("xmarchd_session=abc", NULL);
    expect_from_cookie("a=marchd_session=abc", NULL);
    expect_from_cookie("marchd_session=abc; marchd_session=abd", NULL);
    expect_from_cookie("marchd_session=abc; a=b; marchd_session=abc", NULL);
    expect_from_cookie("marchd_session=", NULL);
    expect_from_cookie("marchd_session", NULL);
    expect_from_cookie(";;; ;", NULL);
    expect_from_cookie("", NULL);
    expect_from_cookie("marchd_session=one; marchd_session=two", NULL);
}

static void what_cannot_be_a_token_is_none(void **state)
{
    char longest[HTTP_TOKEN_LIMIT + 2];

    (void)state;
    memset(longest, 'a', sizeof longest);
    longest[HTTP_TOKEN_LIMIT + 1] = '\0';
    assert_false(http_token_is_well_formed(longest));
    longest[HTTP_TOKEN_LIMIT] = '\0';
    assert_true(http_token_is_well_formed(longest));
    assert_false(http_token_is_well_formed(""));
    assert_false(http_token_is_well_formed("a\nb"));
    assert_false(http_token_is_well_formed("a;b"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bearer_tokens_are_read),
        cmocka_unit_test(our_cookie_is_found_among_others),
        cmocka_unit_test(what_cannot_be_a_token_is_none),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
