// Opens an address that holds a secret in the user's browser.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// Starts xdg-open and does not wait for it. Every user of the machine can read a program's arguments, so what it is
// given is a file of the user's own that leads to `address`, which holds no character that HTML knows.
bool browser_open(const char *address, struct error *error);
