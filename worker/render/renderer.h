// Turns a job's frames into images on one GL context. Call everything from the thread that made it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "worker/render/renderer_fault.h"
#include "worker/render/renderer_frame.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct gl_context;
struct image;
struct pixel;
struct renderer;

// `shader_dir` (NULL: the embedded text) overrides shader modules while developing.
struct renderer *renderer_create(struct gl_context *context, const char *shader_dir);
void renderer_destroy(struct renderer *renderer);
// `on_link` is called before (`begins`) and after GL links a program, which may take seconds.
void renderer_watch_links(struct renderer *renderer, void (*on_link)(void *user, bool begins), void *user);
// True where the CPU renders; its time is then the cost of a frame.
bool renderer_is_software(const struct renderer *renderer);

// Hashes all that the frame's picture depends on: the job, and what its files hold now. Does not use GL.
bool renderer_hash_picture(struct renderer *renderer, const struct job *job, int32_t frame,
                           char hash[static HASH_TEXT_SIZE], enum renderer_fault *fault, struct error *error);

// Begins to read the frame's files in the background, where their format allows it. Keeps no pointer into the job.
void renderer_expect(struct renderer *renderer, const struct job *job, int32_t frame);

// Makes the next frame be rendered, not copied, and its caches be filled again. Programs, grids and images stay.
void renderer_forget(struct renderer *renderer);

// Renders the frame into its image. Programs and targets are kept from call to call; a frame whose inputs equal the one
// before is copied, not rendered. Lists of pixels are always rendered, and share the frame's program.
bool renderer_render(struct renderer *renderer, const struct renderer_frame *frame, struct renderer_result *result,
                     struct error *error);
// Renders one of the layers of a frame (core/job/job_layers.h), whose job is in `frame`; of other jobs the same as
// above.
bool renderer_render_layer(struct renderer *renderer, const struct renderer_frame *frame,
                           struct renderer_result *result, struct error *error);
