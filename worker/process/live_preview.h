// The picture of the frame that is being rendered, in a file that is replaced as the picture refines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdatomic.h>
#include <stdbool.h>

struct image;
struct picture_level;

// Of a worker; zero before the first frame. The renderer's thread shows levels. The encoder's shows whole pictures, and
// until it has, no level of the next frame is shown.
struct live_preview {
    double next_s; // on the clock; levels before that are left out
    bool has_failed;
    atomic_bool is_final_due;
};

// All of them do nothing where `path`, which is absolute, is NULL. What cannot be written is a warning, once until it
// can be written again.

// Leaves the level out where showing the one before took more than a twentieth of the time since then.
void live_preview_show_level(struct live_preview *preview, const char *path, const struct picture_level *level);
// A whole picture goes to the encoder, which shows it or ends it.
void live_preview_expect_final(struct live_preview *preview, const char *path);
void live_preview_show_final(struct live_preview *preview, const char *path, const struct image *image);
void live_preview_end_final(struct live_preview *preview);
