// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_address.h"

#include <arpa/inet.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <sys/un.h>

#include <cmocka.h>

static bool is_public(const char *text)
{
    struct sockaddr_in host4 = {.sin_family = AF_INET};
    struct sockaddr_in6 host6 = {.sin6_family = AF_INET6};

    if (inet_pton(AF_INET, text, &host4.sin_addr) == 1)
        return notify_address_is_public((const struct sockaddr *)&host4);
    if (inet_pton(AF_INET6, text, &host6.sin6_addr) != 1) fail_msg("%s is no address", text);
    return notify_address_is_public((const struct sockaddr *)&host6);
}

static void hosts_of_the_internet_are_public(void **state)
{
    static const char *const hosts[] = {"1.1.1.1",
                                        "9.255.255.255",
                                        "11.0.0.0",
                                        "100.63.255.255",
                                        "100.128.0.0",
                                        "126.255.255.255",
                                        "128.0.0.0",
                                        "169.253.255.255",
                                        "172.15.255.255",
                                        "172.32.0.0",
                                        "192.167.255.255",
                                        "192.169.0.0",
                                        "198.17.255.255",
                                        "223.255.255.255",
                                        "2606:4700:4700::1111",
                                        "2001:4860:4860::8888",
                                        "::ffff:1.1.1.1",
                                        "64:ff9b::101:101",
                                        "2002:0101:0101::1",
                                        NULL};

    for (int i = 0; hosts[i]; i++)
        if (!is_public(hosts[i])) fail_msg("%s", hosts[i]);
}

static void all_others_are_not(void **state)
{
    static const char *const hosts[] = {"0.0.0.0",
                                        "10.0.0.1",
                                        "10.255.255.255",
                                        "100.64.0.1",
                                        "100.127.255.255",
                                        "127.0.0.1",
                                        "127.255.255.254",
                                        "169.254.169.254",
                                        "172.16.0.1",
                                        "172.31.255.255",
                                        "192.0.0.8",
                                        "192.0.2.1",
                                        "192.88.99.1",
                                        "192.168.0.1",
                                        "198.18.0.1",
                                        "198.19.255.255",
                                        "198.51.100.1",
                                        "203.0.113.1",
                                        "224.0.0.1",
                                        "239.255.255.255",
                                        "240.0.0.1",
                                        "255.255.255.255",
                                        "::",
                                        "::1",
                                        "::7f00:1",
                                        "::ffff:127.0.0.1",
                                        "::ffff:10.0.0.1",
                                        "::ffff:169.254.169.254",
                                        "64:ff9b::7f00:1",
                                        "64:ff9b:1::1",
                                        "100::1",
                                        "2001::1",
                                        "2001:1ff::1",
                                        "2001:db8::1",
                                        "2002:7f00:0001::1",
                                        "2002:0a00:0001::1",
                                        "3fff:fff::1",
                                        "5f00::1",
                                        "fc00::1",
                                        "fdff::1",
                                        "fe80::1",
                                        "fec0::1",
                                        "ff02::1",
                                        NULL};

    for (int i = 0; hosts[i]; i++)
        if (is_public(hosts[i])) fail_msg("%s", hosts[i]);
}

static void other_families_are_not(void **state)
{
    struct sockaddr_un path = {.sun_family = AF_UNIX, .sun_path = "/run/marchd/marchd.sock"};

    assert_false(notify_address_is_public((const struct sockaddr *)&path));
}

static void addresses_of_this_machine_are_its_own(void **state)
{
    const struct sockaddr_in here = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const struct sockaddr_in there = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(0x01010101)};
    const struct sockaddr_un other = {.sun_family = AF_UNIX};
    struct sockaddr_in6 mapped = {.sin6_family = AF_INET6};

    (void)state;
    inet_pton(AF_INET6, "::ffff:127.0.0.1", &mapped.sin6_addr);
    assert_true(notify_address_is_own((const struct sockaddr *)&here));
    assert_true(notify_address_is_own((const struct sockaddr *)&mapped));
    assert_true(notify_address_is_own((const struct sockaddr *)&other));
    assert_false(notify_address_is_own((const struct sockaddr *)&there));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hosts_of_the_internet_are_public),
        cmocka_unit_test(addresses_of_this_machine_are_its_own),
        cmocka_unit_test(all_others_are_not),
        cmocka_unit_test(other_families_are_not),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
