// Reads how the light along a ray is summed: a job's quality.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stdbool.h>

struct error;
struct job_quality;

// `document` is the job, whose key "quality" is read. What a method lacks is refused; whether the scene suits the method is
// for job_check to say.
bool quality_from_json(struct job_quality *quality, const struct json_node *document, struct error *error);
