// All mistakes of a job at once, as far as they do not hide each other.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct error;

// Returns the messages about `document`, compact JSON that is no valid job, at most 64. The first is that with which
// reading ends, the next that with which it ends once the first is mended, and so on. Where nothing right is known for
// a place, what contains it is mended as a whole, and tells no more. The caller frees them.
struct error *job_mistakes_find(const char *document, const struct error *first, size_t *count);
