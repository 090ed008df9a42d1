// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox_seccomp.h"

#include "core/base/error.h"
#include "worker/sandbox/sanitizer.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

// The calls of libraries and drivers that render, encode and read files. All others get ENOSYS, the answer of an older
// kernel, so that libraries fall back to another call. Left out on purpose: making sockets, other processes (ptrace,
// process_vm_*, pidfd_*, kill), keys, mounts, namespaces, modules, bpf, perf, io_uring, userfaultfd, setting clocks,
// changing users and groups, and what Landlock does not govern, or did not always: links, nodes, modes, owners and
// times of files by their paths, truncate, inotify.
static const char *const memory_calls[] = {
    "brk",           "get_mempolicy", "madvise", "map_shadow_stack", "mbind",      "membarrier",
    "memfd_create",  "mincore",       "mlock",   "mlock2",           "mmap",       "mprotect",
    "mremap",        "msync",         "munlock", "munmap",           "pkey_alloc", "pkey_free",
    "pkey_mprotect", "set_mempolicy", NULL};

static const char *const descriptor_calls[] = {"close",
                                               "close_range",
                                               "copy_file_range",
                                               "dup",
                                               "dup2",
                                               "dup3",
                                               "epoll_create",
                                               "epoll_create1",
                                               "epoll_ctl",
                                               "epoll_pwait",
                                               "epoll_pwait2",
                                               "epoll_wait",
                                               "eventfd",
                                               "eventfd2",
                                               "fadvise64",
                                               "fallocate",
                                               "fcntl",
                                               "fdatasync",
                                               "flock",
                                               "fstat",
                                               "fstatfs",
                                               "fsync",
                                               "ftruncate",
                                               "getpeername",
                                               "getsockname",
                                               "getsockopt",
                                               "ioctl",
                                               "lseek",
                                               "pipe",
                                               "pipe2",
                                               "poll",
                                               "ppoll",
                                               "pread64",
                                               "preadv",
                                               "preadv2",
                                               "pselect6",
                                               "pwrite64",
                                               "pwritev",
                                               "pwritev2",
                                               "read",
                                               "readahead",
                                               "readv",
                                               "recvfrom",
                                               "select",
                                               "sendfile",
                                               "shutdown",
                                               "signalfd",
                                               "signalfd4",
                                               "socketpair",
                                               "splice",
                                               "sync_file_range",
                                               "timerfd_create",
                                               "timerfd_gettime",
                                               "timerfd_settime",
                                               "write",
                                               "writev",
                                               NULL};

static const char *const file_calls[] = {"access",     "chdir",    "faccessat",  "faccessat2", "fchdir",   "fgetxattr",
                                         "getcwd",     "getdents", "getdents64", "lstat",      "mkdir",    "mkdirat",
                                         "newfstatat", "open",     "openat",     "openat2",    "readlink", "readlinkat",
                                         "rename",     "renameat", "renameat2",  "rmdir",      "stat",     "statfs",
                                         "statx",      "umask",    "unlink",     "unlinkat",   NULL};

static const char *const thread_calls[] = {"alarm",
                                           "clock_nanosleep",
                                           "exit",
                                           "exit_group",
                                           "futex",
                                           "futex_requeue",
                                           "futex_wait",
                                           "futex_waitv",
                                           "futex_wake",
                                           "getcpu",
                                           "getitimer",
                                           "gettid",
                                           "nanosleep",
                                           "pause",
                                           "prctl",
                                           "restart_syscall",
                                           "rseq",
                                           "rt_sigaction",
                                           "rt_sigpending",
                                           "rt_sigprocmask",
                                           "rt_sigreturn",
                                           "rt_sigsuspend",
                                           "rt_sigtimedwait",
                                           "sched_get_priority_max",
                                           "sched_get_priority_min",
                                           "sched_getaffinity",
                                           "sched_getattr",
                                           "sched_getparam",
                                           "sched_getscheduler",
                                           "sched_yield",
                                           "set_robust_list",
                                           "set_tid_address",
                                           "setitimer",
                                           "sigaltstack",
                                           "timer_create",
                                           "timer_delete",
                                           "timer_getoverrun",
                                           "timer_gettime",
                                           "timer_settime",
                                           NULL};

static const char *const fact_calls[] = {
    "arch_prctl", "capget",    "clock_getres", "clock_gettime", "getegid", "geteuid",      "getgid",
    "getgroups",  "getpgid",   "getpgrp",      "getpid",        "getppid", "getpriority",  "getrandom",
    "getresgid",  "getresuid", "getrlimit",    "getrusage",     "getsid",  "gettimeofday", "getuid",
    "sysinfo",    "time",      "times",        "uname",         NULL};

// Calls that start and end a program: nanovdb_convert or, in a worker for any job, what a driver may run.
static const char *const program_calls[] = {"execve", "execveat", "fork",  "kill",   "setpgid",
                                            "setsid", "vfork",    "wait4", "waitid", NULL};

// The sanitizer searches for leaks from another process.
static const char *const sanitizer_calls[] = {"kill", "personality", "ptrace", "tkill", "wait4", NULL};

// Calls that are allowed only for the calling process or thread, whose number is 0 in them.
static const char *const own_calls[] = {"prlimit64", "sched_setaffinity", "sched_setattr", "sched_setparam",
                                        "sched_setscheduler"};

static int allow(scmp_filter_ctx filter, const char *name, const struct scmp_arg_cmp *bounds, unsigned bound_count)
{
    int number = seccomp_syscall_resolve_name(name);

    // The call is another architecture's, or newer than the library.
    if (number < 0) return 0;
    return seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, number, bound_count, bounds);
}

static int allow_all(scmp_filter_ctx filter, const char *const names[])
{
    int status = 0;

    for (size_t i = 0; names[i] && !status; i++)
        status = allow(filter, names[i], NULL, 0);
    return status;
}

static struct scmp_arg_cmp equal(unsigned argument, scmp_datum_t value)
{
    return (struct scmp_arg_cmp){.arg = argument, .op = SCMP_CMP_EQ, .datum_a = value, .datum_b = 0};
}

static int allow_own(scmp_filter_ctx filter)
{
    const struct scmp_arg_cmp first_is_0 = equal(0, 0), of_own_process[] = {equal(0, PRIO_PROCESS), equal(1, 0)};
    int status = allow(filter, "setpriority", of_own_process, 2);

    for (size_t i = 0; i < sizeof own_calls / sizeof own_calls[0] && !status; i++)
        status = allow(filter, own_calls[i], &first_is_0, 1);
    return status;
}

// Allows clone for threads and, with `has_processes`, for processes. The flags of clone3 cannot be checked; libraries
// fall back to clone.
static int allow_clone(scmp_filter_ctx filter, bool has_processes)
{
    const scmp_datum_t unwanted = CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC | CLONE_NEWUSER |
                                  CLONE_NEWPID | CLONE_NEWNET | CLONE_PARENT;
    const scmp_datum_t wanted = has_processes ? 0 : CLONE_THREAD;
    const struct scmp_arg_cmp flags = {
        .arg = 0, .op = SCMP_CMP_MASKED_EQ, .datum_a = unwanted | wanted, .datum_b = wanted};

    return allow(filter, "clone", &flags, 1);
}

// A process may signal itself and compare its own files. sendto goes to the connected end, not to an address.
static int allow_with_bounds(scmp_filter_ctx filter)
{
    const scmp_datum_t own = (scmp_datum_t)getpid();
    const struct scmp_arg_cmp is_own[] = {equal(0, own), equal(1, own)};
    const struct scmp_arg_cmp has_no_address = equal(4, 0);
    int status = allow(filter, "tgkill", is_own, 1);

    if (!status) status = allow(filter, "kcmp", is_own, 2);
    return status ? status : allow(filter, "sendto", &has_no_address, 1);
}

static int allow_renderer(scmp_filter_ctx filter)
{
    const char *const *const lists[] = {memory_calls, descriptor_calls, file_calls, thread_calls, fact_calls};
    int status = 0;

    for (size_t i = 0; i < sizeof lists / sizeof lists[0] && !status; i++)
        status = allow_all(filter, lists[i]);
    if (!status && IS_SANITIZED) status = allow_all(filter, sanitizer_calls);
    if (!status) status = allow_own(filter);
    return status ? status : allow_with_bounds(filter);
}

static bool load(scmp_filter_ctx filter, int status, const struct sandbox_calls *calls, struct error *error)
{
    if (!status && !filter) status = -ENOMEM;
    // 2: the filter is a binary tree, so a call takes a few comparisons.
    if (!status) status = seccomp_attr_set(filter, SCMP_FLTATR_CTL_OPTIMIZE, 2);
    if (!status && calls->has_all_threads) status = seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1);
    if (!status) status = seccomp_load(filter);
    seccomp_release(filter);
    if (!status) return true;
    error_set(error, "seccomp: %s", strerrordesc_np(-status));
    return false;
}

// Refuses some requests of allowed calls: typing into the terminal, having the kernel send signals to others, making
// others wait who open a file of ours, and outliving the parent. The kernel uses only the lower 32 bits of that
// argument, so only these are compared.
static int refuse_orders(scmp_filter_ctx filter)
{
    static const struct {
        const char *call;
        unsigned argument;
        uint32_t order;
    } orders[] = {
        {"ioctl", 1, TIOCSTI},   {"ioctl", 1, TIOCLINUX},   {"ioctl", 1, TIOCSETD},
        {"ioctl", 1, FIOSETOWN}, {"ioctl", 1, SIOCSPGRP},   {"fcntl", 1, F_SETOWN},
        {"fcntl", 1, F_SETSIG},  {"fcntl", 1, F_SETOWN_EX}, {"fcntl", 1, F_SETLEASE},
    };
    const struct scmp_arg_cmp outlive[] = {
        {.arg = 0, .op = SCMP_CMP_MASKED_EQ, .datum_a = UINT32_MAX, .datum_b = PR_SET_PDEATHSIG},
        {.arg = 1, .op = SCMP_CMP_NE, .datum_a = SIGKILL, .datum_b = 0}};
    int status = seccomp_rule_add_array(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(prctl), 2, outlive);

    for (size_t i = 0; i < sizeof orders / sizeof orders[0] && !status; i++) {
        const struct scmp_arg_cmp is_it = {
            .arg = orders[i].argument, .op = SCMP_CMP_MASKED_EQ, .datum_a = UINT32_MAX, .datum_b = orders[i].order};

        status = seccomp_rule_add_array(filter, SCMP_ACT_ERRNO(EPERM), seccomp_syscall_resolve_name(orders[i].call), 1,
                                        &is_it);
    }
    return status;
}

bool sandbox_seccomp_enter(const struct sandbox_calls *calls, struct error *error)
{
    scmp_filter_ctx refusals = seccomp_init(SCMP_ACT_ALLOW), filter = seccomp_init(SCMP_ACT_ERRNO(ENOSYS));
    int status = refusals ? refuse_orders(refusals) : 0;

    if (!load(refusals, status, calls, error)) {
        seccomp_release(filter);
        return false;
    }
    status = filter ? allow_renderer(filter) : 0;
    if (!status && calls->has_programs) status = allow_all(filter, program_calls);
    if (!status) status = allow_clone(filter, calls->has_programs || IS_SANITIZED);
    return load(filter, status, calls, error);
}
