// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_peer.h"

#include <arpa/inet.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static struct http_peer peer_of(const char *text)
{
    struct sockaddr_in v4 = {.sin_family = AF_INET};
    struct sockaddr_in6 v6 = {.sin6_family = AF_INET6};

    if (inet_pton(AF_INET, text, &v4.sin_addr) == 1) return http_peer_name((const struct sockaddr *)&v4);
    assert_int_equal(inet_pton(AF_INET6, text, &v6.sin6_addr), 1);
    return http_peer_name((const struct sockaddr *)&v6);
}

static void an_address_is_told_as_it_is(void **state)
{
    (void)state;
    assert_string_equal(peer_of("192.0.2.7").address, "192.0.2.7");
    assert_string_equal(peer_of("127.1.2.3").address, "127.1.2.3");
    assert_string_equal(peer_of("2001:db8:1:2:3:4:5:6").address, "2001:db8:1:2:3:4:5:6");
    assert_string_equal(peer_of("ffff:ffff:ffff:ffff:ffff:ffff:ffff:ffff").address,
                        "ffff:ffff:ffff:ffff:ffff:ffff:ffff:ffff");
}

static void a_place_of_ipv6_is_its_first_64_bits(void **state)
{
    (void)state;
    assert_string_equal(peer_of("2001:db8:1:2:3:4:5:6").place, "2001:db8:1:2::/64");
    assert_string_equal(peer_of("2001:db8:1:2:ffff::1").place, "2001:db8:1:2::/64");
    assert_string_equal(peer_of("2001:db8:1:3:3:4:5:6").place, "2001:db8:1:3::/64");
    assert_string_equal(peer_of("ffff:ffff:ffff:ffff:ffff:ffff:ffff:ffff").place, "ffff:ffff:ffff:ffff::/64");
    assert_string_equal(peer_of("::1").place, "::/64");
}

static void a_place_of_ipv4_is_the_address(void **state)
{
    (void)state;
    assert_string_equal(peer_of("192.0.2.7").place, "192.0.2.7");
    assert_string_equal(peer_of("192.0.2.8").place, "192.0.2.8");
    assert_string_equal(peer_of("::ffff:192.0.2.7").place, "192.0.2.7");
}

static void this_machine_is_one_place(void **state)
{
    (void)state;
    assert_string_equal(peer_of("127.0.0.1").place, "127.0.0.0/8");
    assert_string_equal(peer_of("127.255.3.4").place, "127.0.0.0/8");
    assert_string_equal(peer_of("::ffff:127.0.0.9").place, "127.0.0.0/8");
    assert_string_equal(peer_of("128.0.0.1").place, "128.0.0.1");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_address_is_told_as_it_is),
        cmocka_unit_test(a_place_of_ipv6_is_its_first_64_bits),
        cmocka_unit_test(a_place_of_ipv4_is_the_address),
        cmocka_unit_test(this_machine_is_one_place),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
