// SPDX-License-Identifier: Apache-2.0
#include "cli/program/interrupt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/signalfd.h>
#include <unistd.h>

// Signals that were ignored at the start (nohup, background jobs of a shell) stay ignored.
static void catch_signal(sigset_t *caught, int number)
{
    struct sigaction action;

    if (sigaction(number, NULL, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(caught, number);
}

void interrupt_init(struct interrupt *interrupt)
{
    sigset_t caught;

    memset(interrupt, 0, sizeof *interrupt);
    sigemptyset(&caught);
    catch_signal(&caught, SIGINT);
    catch_signal(&caught, SIGTERM);
    catch_signal(&caught, SIGHUP);
    sigprocmask(SIG_BLOCK, &caught, &interrupt->previous);
    interrupt->fd = signalfd(-1, &caught, SFD_CLOEXEC | SFD_NONBLOCK);
    if (interrupt->fd < 0) {
        perror("signalfd");
        abort();
    }
}

void interrupt_finish(struct interrupt *interrupt)
{
    if (interrupt->fd <= 0) return;
    interrupt_is_requested(interrupt);
    close(interrupt->fd);
    sigprocmask(SIG_SETMASK, &interrupt->previous, NULL);
    interrupt->fd = 0;
}

bool interrupt_is_requested(struct interrupt *interrupt)
{
    struct signalfd_siginfo received;

    if (!interrupt || interrupt->fd <= 0) return false;
    while (read(interrupt->fd, &received, sizeof received) == (ssize_t)sizeof received)
        interrupt->is_requested = true;
    return interrupt->is_requested;
}
