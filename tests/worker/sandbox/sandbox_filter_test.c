// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox_landlock.h"

#include <errno.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

// As a container's filter that does not know the call. No other call is filtered.
static void forbid_landlock(uint32_t answer)
{
    struct sock_filter lines[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_landlock_create_ruleset, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | answer),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const struct sock_fprog program = {sizeof lines / sizeof lines[0], lines};

    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
        _exit(2);
}

static void assert_lack(uint32_t answer, const char *wanted)
{
    pid_t child = fork();
    int status;

    assert_true(child >= 0);
    if (child == 0) {
        struct sandbox_landlock landlock;

        forbid_landlock(answer);
        if (!sandbox_landlock_open(&landlock, NULL)) _exit(3);
        _exit(landlock.abi == 0 && strcmp(landlock.lack, wanted) == 0 ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void filter_is_told_apart_from_the_kernel(void **state)
{
    assert_lack(EPERM, "landlock is forbidden by a filter");
    assert_lack(EOPNOTSUPP, "landlock is switched off in this kernel");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filter_is_told_apart_from_the_kernel),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
