// Connects to the first daemon that answers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

#include <stddef.h>

struct connection;
struct error;

// Tries the sockets at `paths` in order. NULL when none answers: the message names each path, the reason and what to
// do. `status` is then the exit status to end with, EXIT_STATUS_NOT_ALLOWED when the user may not connect to one of
// them.
struct connection *daemon_socket_connect(char *const paths[], size_t count, enum exit_status *status,
                                         struct error *error);
