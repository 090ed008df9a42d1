// Ctrl-C and its like as something to wait for beside a socket, so that what was begun can be taken back.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>
#include <stdbool.h>

// The zero value catches nothing.
struct interrupt {
    int fd; // owned; readable once a signal came; 0 when nothing is caught
    sigset_t previous;
    bool is_requested;
};

// Blocks SIGINT, SIGTERM and SIGHUP until interrupt_finish and collects them.
void interrupt_init(struct interrupt *interrupt);
void interrupt_finish(struct interrupt *interrupt);       // lets signals through again
bool interrupt_is_requested(struct interrupt *interrupt); // accepts NULL; does not block
