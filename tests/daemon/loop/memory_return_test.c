// SPDX-License-Identifier: Apache-2.0
#include "daemon/loop/memory_return.h"

#include <malloc.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

enum { MIB = 1024 * 1024 };

static atomic_int trims;

int malloc_trim(size_t pad)
{
    (void)pad;
    trims++;
    return 1;
}

static void much_that_was_freed_goes_back_once(void **state)
{
    struct memory_return *memory;
    uv_loop_t loop;

    uv_loop_init(&loop);
    memory = memory_return_open(&loop);
    memory_return_note(memory, 15 * MIB);
    assert_int_equal(uv_run(&loop, UV_RUN_NOWAIT), 0); // nothing is due
    memory_return_note(memory, MIB);
    memory_return_note(memory, 3 * MIB);
    while (uv_run(&loop, UV_RUN_ONCE))
        ;
    assert_int_equal(trims, 1);
    memory_return_close(memory);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
}

static void a_thread_gives_back_at_once(void **state)
{
    int before = trims;

    memory_return_trim(16 * MIB - 1);
    assert_int_equal(trims, before);
    memory_return_trim(16 * MIB);
    assert_int_equal(trims, before + 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(much_that_was_freed_goes_back_once),
        cmocka_unit_test(a_thread_gives_back_at_once),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
