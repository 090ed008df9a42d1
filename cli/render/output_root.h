// Below which folder a job's files lie that is rendered without a daemon.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// Everything is below the root: the current folder, or the one that an absolute `out` (--out; may be NULL) names, whose folders
// are made with `may_make`. Sets the document's output.path where `out` says one. Owned by the caller; NULL on failure.
char *output_root_choose(const char *out, bool may_make, char **document, struct error *error);
