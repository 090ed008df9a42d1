// Reads when a job's frames are rendered, for how long and by whom: `priority`, `order`, `frame_limit`, `pool`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_node;

// The keys may be absent. They change no picture.
bool schedule_from_json(struct job *job, const struct json_node *document, struct error *error);
// Whether a pool may have the text as its name or tag: 1 to 64 letters, digits and -._@:, a letter or digit first.
bool schedule_is_pool_name(const char *text);
