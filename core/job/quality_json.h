// Reads a job's quality: the method that integrates light along rays, and its numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stdbool.h>

struct error;
struct job_quality;

// `document` is the job, whose key "quality" is read. Keys that the method does not have are refused. job_check checks
// whether the scene suits the method.
bool quality_from_json(struct job_quality *quality, const struct json_node *document, struct error *error);
