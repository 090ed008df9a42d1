// The hash of everything that a job's pictures depend on: equal hashes mean equal pixels in frames of the same number.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

struct job;

// The hash does not depend on the layout of the document, nor on name, frames, priority, output path, compression,
// existing, max_cut and on_miss. (A file itself states its share of cut light, and whether it missed its tolerance.)
void job_hash_picture(const struct job *job, char text[static HASH_TEXT_SIZE]);
