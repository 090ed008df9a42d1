// The header of an EXR file as JSON, for people and programs that look at a frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/openexr.h>

struct image_exr_facts;
struct json_writer;

// One object: `width_px`, `height_px`, `compression`, `channels` (array of `{name, pixel}`) and `attributes` (by name).
// Attributes of types that are no text, number or list of numbers are left out, and whatever is over a limit of 256
// attributes of 64 KiB.
void image_exr_json_write(exr_context_t context, const struct image_exr_facts *facts, struct json_writer *writer);
