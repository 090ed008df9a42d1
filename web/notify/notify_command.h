// Runs a command of the settings for a notice, which it reads as JSON on its standard input.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "web/notify/notify_outcome.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct notify_command;

enum { NOTIFY_COMMAND_FDS = 2 };

// Starts it without a shell, in a process group and with an environment of its own, in the folder /. `line` is borrowed
// until the end. NULL on failure.
struct notify_command *notify_command_start(char *const arguments[], const char *body, int64_t deadline_ms,
                                            struct notify_line *line, struct error *error);
// What to wait for.
void notify_command_list_fds(const struct notify_command *command, int fds[static NOTIFY_COMMAND_FDS]);
int64_t notify_command_deadline_ms(const struct notify_command *command);
// Looks whether it has ended; kills it when its time is over. True: it is freed, after on_end.
bool notify_command_check(struct notify_command *command, int64_t now_ms, notify_on_end *on_end, void *user);
void notify_command_kill(struct notify_command *command); // and frees it
