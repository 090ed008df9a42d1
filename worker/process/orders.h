// What the worker is told to do: each message changes what its threads find to do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct worker;

// Obeys one line. False when it is not to be understood: whoever sends it is broken.
bool orders_take_line(struct worker *worker, const char *line, size_t length, struct error *error);
