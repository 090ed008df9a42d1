// Reads and writes a job's quality: the method that integrates light along rays, and its numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stdbool.h>

struct error;
struct job;
struct job_quality;
struct json_writer;

// `document` is the job, whose key "quality" is read. Keys that the method does not have are refused. job_check checks
// whether the scene suits the method.
bool quality_from_json(struct job_quality *quality, const struct json_node *document, struct error *error);

// Writes one object, as a job would state it. The method is one that a plan or a draft chooses for `job`.
void quality_to_json(struct json_writer *writer, const struct job *job, const struct job_quality *quality);
