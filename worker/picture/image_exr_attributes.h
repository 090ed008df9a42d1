// The attributes marchd:... of an EXR file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/openexr.h>

struct image_exr_facts;

// Sets the fields that attributes have, not size and channels. Absent ones leave zero, or NaN where image_exr.h says
// so.
void image_exr_attributes_read(exr_context_t context, struct image_exr_facts *facts);
