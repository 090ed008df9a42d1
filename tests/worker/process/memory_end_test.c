// SPDX-License-Identifier: Apache-2.0
#include "worker/process/memory_end.h"

#include "core/wire/worker_status.h"
#include "worker/sandbox/sandbox.h"
#include "worker/sandbox/sanitizer.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { LIMIT_BYTES = 256 << 20, BLOCK_BYTES = 1 << 20 };

// Crashes like a library that does not check malloc's result.
static void take_all(void)
{
    for (;;) {
        char *volatile block = malloc(BLOCK_BYTES);

        *(volatile char *)block = 1;
    }
}

static int end_of(void (*crash)(void))
{
    pid_t child = fork();
    int status;

    if (child == 0) {
        sandbox_limit(LIMIT_BYTES);
        memory_end_watch(LIMIT_BYTES);
        crash();
        _exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    return status;
}

static void skip_with_a_sanitizer(void)
{
    if (!IS_SANITIZED) return;
    print_message("the address sanitizer handles crashes itself\n");
    skip();
}

static void crash_for_want_of_memory_says_so(void **state)
{
    int status;

    skip_with_a_sanitizer();
    status = end_of(take_all);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), WORKER_STATUS_MEMORY);
}

static void abort_at_once(void)
{
    abort();
}

static void another_crash_stays_one(void **state)
{
    int status;

    skip_with_a_sanitizer();
    status = end_of(abort_at_once);
    assert_true(WIFSIGNALED(status));
    assert_int_equal(WTERMSIG(status), SIGABRT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crash_for_want_of_memory_says_so),
        cmocka_unit_test(another_crash_stays_one),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
