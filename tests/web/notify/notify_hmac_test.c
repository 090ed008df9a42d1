// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_hmac.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static void assert_hmac(const void *key, size_t key_size, const void *bytes, size_t size, const char *expected)
{
    const struct notify_bytes secret = {key, key_size};
    const struct notify_bytes whole = {bytes, size},
                              parts[] = {{bytes, size / 3}, {(const char *)bytes + size / 3, size - size / 3}};
    char text[NOTIFY_HMAC_SIZE];

    notify_hmac(&secret, &whole, 1, text);
    assert_string_equal(text, expected);
    notify_hmac(&secret, parts, 2, text);
    assert_string_equal(text, expected);
}

// The test cases of RFC 4231, but the one of a truncated output.
static void vectors_of_rfc_4231_hold(void **state)
{
    char key[131], bytes[50];
    const char *larger = "This is a test using a larger than block-size key and a larger than block-size data. The key "
                         "needs to be hashed before being used by the HMAC algorithm.";

    memset(key, 0x0b, 20);
    assert_hmac(key, 20, "Hi There", 8, "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7");
    assert_hmac("Jefe", 4, "what do ya want for nothing?", 28,
                "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
    memset(key, 0xaa, 20);
    memset(bytes, 0xdd, 50);
    assert_hmac(key, 20, bytes, 50, "773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe");
    for (int i = 0; i < 25; i++)
        key[i] = (char)(i + 1);
    memset(bytes, 0xcd, 50);
    assert_hmac(key, 25, bytes, 50, "82558a389a443c0ea4cc819899f2083a85f0faa3e578f8077a2e3ff46729665b");
    memset(key, 0xaa, 131);
    assert_hmac(key, 131, "Test Using Larger Than Block-Size Key - Hash Key First", 54,
                "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
    assert_hmac(key, 131, larger, strlen(larger), "9b09ffa71b942fcb27635fbcd5b0e944bfdc63644f0713938a7f51535c3a35e2");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(vectors_of_rfc_4231_hold)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
