// Reads when a job's frames are rendered, and for how long: `priority`, `order`, `frame_limit`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_node;

// The keys may be absent. They change no picture.
bool schedule_from_json(struct job *job, const struct json_node *document, struct error *error);
