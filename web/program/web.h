// march-web as a service: its loop, its server, what answers where, and its end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct web_options;

// Serves until SIGTERM or SIGINT. False: it could not begin. `options` is borrowed.
bool web_run(const struct web_options *options, struct error *error);
