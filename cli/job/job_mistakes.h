// All mistakes of a job at once, as far as they do not hide each other.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct error;

// Returns the messages about `document`, compact JSON that is no valid job: the first, with which reading it ends, and
// those of its other members, each of which is read in a job that is right otherwise. Of lights, media and objects each
// element tells one, of camera and output each member. The caller frees them.
struct error *job_mistakes_find(const char *document, const struct error *first, size_t *count);
