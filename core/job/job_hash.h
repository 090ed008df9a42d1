// The hash of all that a job's pictures depend on: equal hashes, equal pixels in the frame of the same number.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

struct job;

// Depends neither on how the document was laid out nor on name, frames, priority, output path, compression,
// existing and max_cut, of which a file itself says how much it needs.
void job_hash_picture(const struct job *job, char text[static HASH_TEXT_SIZE]);
