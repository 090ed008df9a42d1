// Connects to the first daemon that answers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

#include <stddef.h>

struct connection;
struct error;

// Tries the sockets at `paths` in their order. NULL when none answers or none may be reached: the message names each path, why
// it did not do and what to do; `status` is the exit code to end with, EXIT_STATUS_NOT_ALLOWED when one is not for the user.
struct connection *daemon_socket_connect(char *const paths[], size_t count, enum exit_status *status,
                                         struct error *error);
