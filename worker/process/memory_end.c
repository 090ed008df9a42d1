// SPDX-License-Identifier: Apache-2.0
#include "worker/process/memory_end.h"

#include "core/wire/worker_status.h"
#include "worker/sandbox/sanitizer.h"

#include <fcntl.h>
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

enum {
    // A growing list that is refused twice its size crashes with a third of the memory allocated.
    SHARE = 3,
    DATA_FIELD = 5 // of /proc/self/statm, counted from 0
};

// Global, because a signal handler has no other way to its values.
static struct {
    int statm_fd;
    int64_t limit_pages;
} watched;

static int64_t read_field(const char *text, int field)
{
    int64_t number = 0;

    for (; *text && field > 0; text++)
        if (*text == ' ') field--;
    for (; *text >= '0' && *text <= '9'; text++)
        number = number * 10 + (*text - '0');
    return number;
}

static void on_crash(int signal_number)
{
    static const char words[] = "out of memory: the worker crashed when it was refused more\n";
    char text[128];
    ssize_t length = pread(watched.statm_fd, text, sizeof text - 1, 0);

    text[length > 0 ? length : 0] = '\0';
    if (read_field(text, DATA_FIELD) >= watched.limit_pages / SHARE) {
        (void)!write(STDERR_FILENO, words, strlen(words));
        _exit(WORKER_STATUS_MEMORY);
    }
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

void memory_end_watch(int64_t limit_bytes)
{
    static const int signals[] = {SIGSEGV, SIGBUS, SIGABRT, SIGTRAP, SIGILL};

    // Sanitizers handle crashes themselves.
    if (limit_bytes <= 0 || IS_SANITIZED) return;
    watched.statm_fd = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    watched.limit_pages = limit_bytes / sysconf(_SC_PAGESIZE);
    if (watched.statm_fd < 0) return;
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        sigaction(signals[i], &(struct sigaction){.sa_handler = on_crash, .sa_flags = SA_NODEFER}, NULL);
}
