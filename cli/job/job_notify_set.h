// Adds a rule of the command line to a job's `notify`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// Appends the rule of `text`, as job_notify_parse reads it, to those that `*document` has, and replaces the document.
bool job_notify_set(char **document, const char *text, struct error *error);
