// Settings of march-web that only their users can judge: addresses and origins.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct http_origins;
struct web_options;

// Fills `origins`, which the caller finishes. The error has the first mistake.
bool web_check_options(const struct web_options *options, struct http_origins *origins, struct error *error);
