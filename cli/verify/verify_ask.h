// Lets a worker read the files that are verified.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

struct error;
struct options;
struct verify_list;

// Records its findings in `list`. With `document` (a job with any output path; NULL: none), compares each file with
// that job.
enum exit_status verify_ask(struct verify_list *list, const struct options *options, const char *document,
                            struct error *error);
