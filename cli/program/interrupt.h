// Signals that interrupt the program, as a descriptor to poll beside a socket, so that work can be ended in order.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>
#include <stdbool.h>

// The zero value catches nothing.
struct interrupt {
    int fd; // owned; readable after a signal; 0 when no signals are caught
    sigset_t previous;
    bool is_requested;
};

// Blocks SIGINT, SIGTERM and SIGHUP until interrupt_finish and collects them.
void interrupt_init(struct interrupt *interrupt);
void interrupt_finish(struct interrupt *interrupt);       // restores the signals
bool interrupt_is_requested(struct interrupt *interrupt); // accepts NULL; does not block
