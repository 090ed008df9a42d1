// Writes families of samples: the members of a result of daemon.metrics.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

struct histogram;
struct histogram_scale;
struct json_writer;

// `type` is counter, gauge or histogram. Samples follow. Their labels are names and values in turns, and NULL at the
// end: {"pool", "local", "state", "idle", NULL}.
void metrics_write_begin(struct json_writer *writer, const char *type, const char *name, const char *help);
void metrics_write_end(struct json_writer *writer);
void metrics_write_value(struct json_writer *writer, const char *const labels[], double value);
void metrics_write_histogram(struct json_writer *writer, const char *const labels[], const struct histogram *histogram,
                             const struct histogram_scale *scale);
// A histogram whose classes are not of a scale: `counts` has one more than there are `ends`.
void metrics_write_classes(struct json_writer *writer, const char *const labels[], const double *ends,
                           const uint64_t *counts, size_t end_count, double sum);
// A family with a single sample, without labels.
void metrics_write_single(struct json_writer *writer, const char *type, const char *name, const char *help,
                          double value);
