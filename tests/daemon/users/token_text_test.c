// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/token_text.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static void a_token_is_a_prefix_and_256_random_bits(void **state)
{
    enum { COUNT = 2000, DIGITS = TOKEN_TEXT_SIZE - 8 };
    static char texts[COUNT][TOKEN_TEXT_SIZE];
    unsigned char seen[DIGITS][128] = {0};

    for (int i = 0; i < COUNT; i++) {
        assert_true(token_text_make(texts[i], NULL));
        assert_int_equal(strlen(texts[i]), TOKEN_TEXT_SIZE - 1);
        assert_memory_equal(texts[i], "marchd_", 7);
        for (int k = 0; k < DIGITS; k++)
            seen[k][(unsigned char)texts[i][7 + k]] = 1;
    }
    // Each digit takes all of its values, the last one has four bits. The chance that one misses a value is below
    // 1e-10.
    for (int k = 0; k < DIGITS; k++) {
        int count = 0;

        for (int c = 0; c < 128; c++)
            count += seen[k][c];
        assert_int_equal(count, k == DIGITS - 1 ? 16 : 64);
    }
}

// FIPS 180-2, appendix B.
static void a_hash_is_sha_256(void **state)
{
    char hash[TOKEN_HASH_SIZE];

    token_text_hash("abc", hash);
    assert_string_equal(hash, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    token_text_hash("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", hash);
    assert_string_equal(hash, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    token_text_hash("", hash);
    assert_string_equal(hash, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

static void hashes_differ_wherever_they_differ(void **state)
{
    char hash[TOKEN_HASH_SIZE], other[TOKEN_HASH_SIZE];

    token_text_hash("abc", hash);
    token_text_hash("abc", other);
    assert_true(token_text_is_same(hash, other));
    for (int i = 0; i < TOKEN_HASH_SIZE - 1; i++) {
        memcpy(other, hash, sizeof other);
        other[i] ^= 1;
        assert_false(token_text_is_same(hash, other));
    }
}

// The instructions that a child takes from one stop to the next, in which it compares the hashes. 0: it may not be
// traced.
static long count_instructions(const char *hash, const char *other)
{
    long count = 0;
    int status = 0;
    pid_t child = fork();

    if (child == 0) {
        if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0) _exit(77);
        raise(SIGSTOP);
        token_text_is_same(hash, other);
        raise(SIGSTOP);
        _exit(0);
    }
    waitpid(child, &status, 0);
    if (WIFEXITED(status)) return 0;
    while (ptrace(PTRACE_SINGLESTEP, child, NULL, NULL) == 0 && waitpid(child, &status, 0) == child &&
           WIFSTOPPED(status) && WSTOPSIG(status) == SIGTRAP)
        count++;
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    return count;
}

static void a_comparison_takes_the_same_course_whatever_it_compares(void **state)
{
    char hash[TOKEN_HASH_SIZE], other[TOKEN_HASH_SIZE];
    long same;

    token_text_hash("abc", hash);
    token_text_hash("abc", other);
    same = count_instructions(hash, other);
    if (same == 0) {
        printf("skip: processes may not be traced here\n");
        skip();
    }
    assert_true(same > 4 * (TOKEN_HASH_SIZE - 1));
    for (int i = 0; i < TOKEN_HASH_SIZE - 1; i += 9) {
        memcpy(other, hash, sizeof other);
        memset(other + i, 'x', sizeof other - 1 - (size_t)i);
        assert_int_equal(count_instructions(hash, other), same);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_token_is_a_prefix_and_256_random_bits),
        cmocka_unit_test(a_hash_is_sha_256),
        cmocka_unit_test(hashes_differ_wherever_they_differ),
        cmocka_unit_test(a_comparison_takes_the_same_course_whatever_it_compares),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
