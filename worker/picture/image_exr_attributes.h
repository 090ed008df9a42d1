// What an EXR file's own attributes (marchd:...) say of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/openexr.h>

struct image_exr_facts;

// Sets what they say of the frame, not what the file's shape says; absent ones leave the zero value, or NaN as there.
void image_exr_attributes_read(exr_context_t context, struct image_exr_facts *facts);
