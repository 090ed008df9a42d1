// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_walls.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static struct http_origins farm_origins(void)
{
    struct http_origins origins = {0};

    assert_true(http_origins_add(&origins, "https://farm.example.org", NULL));
    assert_true(http_origins_add(&origins, "http://localhost:8080", NULL));
    return origins;
}

static void names_of_this_machine_are_ours_at_any_port(void **state)
{
    struct http_origins none = {0};

    (void)state;
    assert_true(http_host_is_ours(&none, "localhost:8470"));
    assert_true(http_host_is_ours(&none, "127.0.0.1:9000"));
    assert_true(http_host_is_ours(&none, "[::1]:8470"));
    assert_true(http_host_is_ours(&none, "LOCALHOST"));
}

static void names_that_were_pointed_at_us_are_not_ours(void **state)
{
    struct http_origins origins = farm_origins();
    static const char *const hosts[] = {"evil.example",      "evil.example:8470",  "localhost.evil.example",
                                        "127.0.0.1.nip.io",  "127.0.0.1:84:70",    "localhost:",
                                        "localhost:123456",  "[::1]evil",          "",
                                        "farm.example.org.", "farm.example.org:1", "render",
                                        "xfarm.example.org", "0.0.0.0:8470",       "127.0.0.1@evil.example"};

    (void)state;
    for (size_t i = 0; i < sizeof hosts / sizeof hosts[0]; i++)
        if (http_host_is_ours(&origins, hosts[i])) fail_msg("%s", hosts[i]);
    http_origins_finish(&origins);
}

static void hosts_of_origins_are_ours(void **state)
{
    struct http_origins origins = farm_origins();

    (void)state;
    assert_true(http_host_is_ours(&origins, "farm.example.org"));
    assert_true(http_host_is_ours(&origins, "localhost:8080"));
    assert_true(http_host_is_secure(&origins, "farm.example.org"));
    assert_false(http_host_is_secure(&origins, "localhost:8080"));
    assert_false(http_host_is_secure(&origins, "localhost:8470"));
    http_origins_finish(&origins);
}

static void an_origin_is_ours_only_beside_its_own_host(void **state)
{
    struct http_origins origins = farm_origins();

    (void)state;
    assert_true(http_origin_is_ours(&origins, "localhost:8470", "http://localhost:8470"));
    assert_true(http_origin_is_ours(&origins, "farm.example.org", "https://farm.example.org"));
    assert_false(http_origin_is_ours(&origins, "localhost:8470", "http://localhost:3000"));
    assert_false(http_origin_is_ours(&origins, "localhost:8470", "http://127.0.0.1:8470"));
    assert_false(http_origin_is_ours(&origins, "localhost:8470", "https://farm.example.org"));
    assert_false(http_origin_is_ours(&origins, "localhost:8470", "https://localhost:8470"));
    assert_false(http_origin_is_ours(&origins, "farm.example.org", "http://farm.example.org"));
    assert_false(http_origin_is_ours(&origins, "localhost:8470", "null"));
    assert_false(http_origin_is_ours(&origins, "localhost:8470", "http://evil.example"));
    assert_false(http_origin_is_ours(&origins, "localhost:8470", ""));
    assert_false(http_origin_is_ours(&origins, "evil.example", "http://evil.example"));
    http_origins_finish(&origins);
}

static void fetches_of_other_sites_are_not_ours(void **state)
{
    (void)state;
    assert_true(http_fetch_is_ours(NULL));
    assert_true(http_fetch_is_ours("same-origin"));
    assert_true(http_fetch_is_ours("none"));
    assert_false(http_fetch_is_ours("same-site"));
    assert_false(http_fetch_is_ours("cross-site"));
    assert_false(http_fetch_is_ours(""));
}

static void an_origin_is_a_scheme_and_a_host(void **state)
{
    static const char *const wrong[] = {"farm.example.org", "ftp://farm",           "https://",
                                        "https://farm/",    "https://farm/page",    "https://a b",
                                        "https://farm:",    "https://farm:x",       "https://farm:123456",
                                        "https://u@farm",   "https://farm\r\nX: y", ""};
    struct http_origins origins = {0};
    struct error error = {0};

    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        if (http_origins_add(&origins, wrong[i], &error)) fail_msg("%s", wrong[i]);
    assert_string_equal(error.message, "--origin: expected https://HOST or https://HOST:PORT, got \"\"");
    assert_true(http_origins_add(&origins, "https://[fd00::1]:8443", NULL));
    http_origins_finish(&origins);
}

static void plain_http_is_for_this_machine_alone(void **state)
{
    static const char *const wrong[] = {"http://farm.example.org",
                                        "HTTP://farm",
                                        "http://192.0.2.7:8470",
                                        "http://[fd00::1]",
                                        "http://localhost.evil.example",
                                        "http://127.0.0.1.nip.io",
                                        "http://"};
    struct http_origins origins = {0};

    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct error error = {0};

        if (http_origins_add(&origins, wrong[i], &error)) fail_msg("%s", wrong[i]);
        assert_non_null(strstr(error.message, "http is for this machine's own names alone"));
    }
    assert_true(http_origins_add(&origins, "http://localhost:9000", NULL));
    assert_true(http_origins_add(&origins, "http://127.0.0.1", NULL));
    assert_true(http_origins_add(&origins, "http://[::1]:8470", NULL));
    assert_false(http_origins_have_secure(&origins));
    assert_true(http_origins_add(&origins, "https://farm", NULL));
    assert_true(http_origins_have_secure(&origins));
    http_origins_finish(&origins);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_this_machine_are_ours_at_any_port),
        cmocka_unit_test(names_that_were_pointed_at_us_are_not_ours),
        cmocka_unit_test(hosts_of_origins_are_ours),
        cmocka_unit_test(an_origin_is_ours_only_beside_its_own_host),
        cmocka_unit_test(fetches_of_other_sites_are_not_ours),
        cmocka_unit_test(an_origin_is_a_scheme_and_a_host),
        cmocka_unit_test(plain_http_is_for_this_machine_alone),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
