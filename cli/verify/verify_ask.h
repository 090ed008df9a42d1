// Has a worker look into the files that are verified.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

struct error;
struct options;
struct verify_list;

// Notes what it says of each. With `document` (NULL: none), a job whose outputs may lie anywhere, each file is held to that job.
enum exit_status verify_ask(struct verify_list *list, const struct options *options, const char *document,
                            struct error *error);
