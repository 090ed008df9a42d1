// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox_seccomp.h"

#include "tests/support/fence_places.h"
#include "tests/support/temp_folder.h"
#include "worker/sandbox/sanitizer.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/io_uring.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static int reach_for_sockets(void)
{
    int pair[2];

    if (!fence_places_is_refused(socket(AF_UNIX, SOCK_STREAM, 0))) return 1;
    if (!fence_places_is_refused(socket(AF_INET, SOCK_STREAM, 0))) return 2;
    if (!fence_places_is_refused(socket(AF_INET6, SOCK_DGRAM, 0))) return 3;
    if (!fence_places_is_refused(socket(AF_NETLINK, SOCK_RAW, 0))) return 4;
    // Sockets that libraries use to wake themselves; such a socket cannot be connected elsewhere.
    if (socketpair(AF_UNIX, SOCK_DGRAM, 0, pair) != 0) return 5;
    if (!fence_places_is_refused(connect(pair[0], (struct sockaddr *)&(struct sockaddr_un){.sun_family = AF_UNIX},
                                         sizeof(struct sockaddr_un))))
        return 6;
    if (!fence_places_is_refused(bind(pair[0], (struct sockaddr *)&(struct sockaddr_un){.sun_family = AF_UNIX}, 2)))
        return 7;
    if (!fence_places_is_refused(sendmsg(pair[0], &(struct msghdr){0}, 0))) return 8;
    if (!fence_places_is_refused(
            sendto(pair[0], "x", 1, 0, (struct sockaddr *)&(struct sockaddr_un){.sun_family = AF_UNIX}, 2)))
        return 9;
    if (send(pair[0], "x", 1, 0) != 1) return 10;
    return 0;
}

static void there_are_no_sockets(void **state)
{
    fence_places_run(fence_places_job("ann", "a.raw", "ann"), reach_for_sockets);
}

static int reach_for_processes(void)
{
    const pid_t parent = getppid();
    struct rlimit limit = {0, 0};
    cpu_set_t cores;
    char byte;
    struct iovec here = {&byte, 1}, there = {&byte, 1};

    CPU_ZERO(&cores);
    CPU_SET(0, &cores);
    if (!IS_SANITIZED && !fence_places_is_refused(kill(parent, 0))) return 1;
    if (!fence_places_is_refused(syscall(SYS_tgkill, parent, parent, SIGTERM))) return 2;
    if (!IS_SANITIZED && !fence_places_is_refused(ptrace(PTRACE_ATTACH, parent, NULL, NULL))) return 3;
    if (!fence_places_is_refused(process_vm_readv(parent, &here, 1, &there, 1, 0))) return 4;
    if (!fence_places_is_refused(syscall(SYS_pidfd_open, parent, 0))) return 5;
    if (!fence_places_is_refused(prlimit(parent, RLIMIT_CORE, &limit, NULL))) return 6;
    if (!fence_places_is_refused(setpriority(PRIO_PROCESS, (id_t)parent, 19))) return 7;
    if (!fence_places_is_refused(sched_setaffinity(parent, sizeof cores, &cores))) return 8;
    if (!fence_places_is_refused(prctl(PR_SET_PDEATHSIG, 0, 0, 0, 0))) return 9;
    if (!IS_SANITIZED && !fence_places_is_refused(syscall(SYS_fork))) return 10;
    if (!fence_places_is_refused(execl("/bin/true", "true", NULL))) return 11;
    if (!fence_places_is_refused(syscall(SYS_clone3, NULL, 0))) return 12;
    // The kernel ignores the upper half of a request.
    if (!fence_places_is_refused(syscall(SYS_prctl, (UINT64_C(1) << 32) + PR_SET_PDEATHSIG, 0, 0, 0, 0))) return 13;
    if (!fence_places_is_refused(setpriority(PRIO_USER, 0, 19))) return 14;
    if (!fence_places_is_refused(fcntl(STDIN_FILENO, F_SETOWN, parent))) return 15;
    if (!fence_places_is_refused(fcntl(STDIN_FILENO, F_SETLEASE, F_UNLCK)))
        return 18; // others who open a leased file wait
    if (!fence_places_is_refused(ioctl(STDIN_FILENO, TIOCSTI, "x"))) return 16;
    if (!fence_places_is_refused(syscall(SYS_ioctl, STDIN_FILENO, (UINT64_C(1) << 32) + TIOCSTI, "x"))) return 17;
    return 0;
}

static void no_process_is_reached_or_started(void **state)
{
    fence_places_run(fence_places_job("ann", "a.raw", "ann"), reach_for_processes);
}

static int reach_for_the_kernel(void)
{
    struct io_uring_params ring = {0};

    if (!fence_places_is_refused(unshare(CLONE_NEWUSER))) return 1;
    if (!fence_places_is_refused(syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, NULL, NULL, NULL, NULL))) return 2;
    if (!fence_places_is_refused(mount("none", "/mnt", "tmpfs", 0, NULL))) return 3;
    if (!fence_places_is_refused(syscall(SYS_io_uring_setup, 1, &ring))) return 4;
    if (!fence_places_is_refused(syscall(SYS_bpf, 0, NULL, 0))) return 5;
    if (!fence_places_is_refused(syscall(SYS_keyctl, 0, 0, 0, 0, 0))) return 6;
    if (!fence_places_is_refused(syscall(SYS_userfaultfd, 0))) return 7;
    if (!fence_places_is_refused(syscall(SYS_perf_event_open, NULL, 0, 0, 0, 0))) return 8;
    if (!fence_places_is_refused(setuid(0))) return 9;
    if (!fence_places_is_refused(chroot("/"))) return 10;
    if (!fence_places_is_refused(chown(fence_places_at("out/ann"), 1, 1))) return 11;
    if (!fence_places_is_refused(syscall(SYS_open_by_handle_at, AT_FDCWD, NULL, 0))) return 12;
    if (prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) != 1) return 13;
    if (!fence_places_is_refused(chmod(fence_places_at("state/store"), 0666))) return 14;
    if (!fence_places_is_refused(utimensat(AT_FDCWD, fence_places_at("state/store"), NULL, 0))) return 15;
    if (!fence_places_is_refused(syscall(SYS_inotify_init1, 0))) return 16;
    return 0;
}

static void the_kernels_wide_doors_are_shut(void **state)
{
    fence_places_run(fence_places_job("ann", "a.raw", "ann"), reach_for_the_kernel);
}

static void *wait_and_reach(void *user)
{
    int *pipe_ends = user;
    char byte;

    if (read(pipe_ends[0], &byte, 1) != 1) return (void *)1;
    return fence_places_is_refused(socket(AF_UNIX, SOCK_STREAM, 0)) ? NULL : (void *)2;
}

static void a_worker_of_everybodys_holds_all_its_threads_to_it(void **state)
{
    pid_t child = fork();
    int status;

    if (child == 0) {
        char holds[SANDBOX_TEXT_SIZE];
        pthread_t thread;
        int ends[2];
        void *result = NULL;

        if (pipe(ends) != 0 || pthread_create(&thread, NULL, wait_and_reach, ends) != 0) _exit(3);
        if (!sandbox_enter(holds, NULL)) _exit(4);
        if (write(ends[1], "x", 1) != 1 || pthread_join(thread, &result) != 0) _exit(5);
        if (!fence_places_can_open("/etc/passwd", O_RDONLY)) _exit(6);
        _exit((int)(intptr_t)result);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

int main(void)
{
#define IN_PLACES(test) cmocka_unit_test_setup_teardown(test, fence_places_make, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        IN_PLACES(there_are_no_sockets),
        IN_PLACES(no_process_is_reached_or_started),
        IN_PLACES(the_kernels_wide_doors_are_shut),
        cmocka_unit_test(a_worker_of_everybodys_holds_all_its_threads_to_it),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
