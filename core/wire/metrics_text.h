// The answer to daemon.metrics as text that Prometheus reads, of its exposition format 0.0.4.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;
struct json_node;

#define METRICS_TEXT_TYPE "text/plain; version=0.0.4; charset=utf-8" // as a header of HTTP

// `result` has the member `families` (docs/protocol.md). What Prometheus would refuse or misread is an error that names
// the place: names of other letters, a family twice, classes that do not ascend. The text is owned by the caller; NULL
// on failure.
char *metrics_text_format(const struct json_node *result, struct error *error);
