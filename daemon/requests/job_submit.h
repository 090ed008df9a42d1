// Takes a job in: checks it, its folder and whose files it would write, commits it, queues it, answers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stdbool.h>
#include <stdint.h>

struct farm;
struct job_files;
struct request;

// False with request's code and error when the document is refused at once; else the answer comes later.
bool job_submit_start(struct request *request, const struct json_node *document, bool paused);
// Whether a job on its way in writes into that folder.
bool job_submit_uses_folder(const struct farm *farm, const char *root, const char *folder);
// The name of a job on its way in that writes a file of `files`, `*frame` there; NULL: none does.
const char *job_submit_find_collision(const struct farm *farm, const struct job_files *files, int32_t *frame);
