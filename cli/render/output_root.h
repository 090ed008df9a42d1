// The output root of a job that is rendered without a daemon.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// The root is the current folder, or the folder of an absolute `out` (--out; may be NULL), which is made if `may_make`.
// Sets the document's output.path if `out` is given. Returns the root, owned by the caller; NULL on failure.
char *output_root_choose(const char *out, bool may_make, char **document, struct error *error);
