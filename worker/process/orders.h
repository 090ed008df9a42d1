// Obeys the messages that the worker receives: each changes the work that its threads find.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct worker;

// Obeys one line. False when it cannot be understood: the sender is broken.
bool orders_take_line(struct worker *worker, const char *line, size_t length, struct error *error);
