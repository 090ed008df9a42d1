// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics/metrics_write.h"

#include "core/json/json_write.h"
#include "daemon/metrics/histogram.h"

void metrics_write_begin(struct json_writer *writer, const char *type, const char *name, const char *help)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "name", name);
    json_write_string_member(writer, "type", type);
    json_write_string_member(writer, "help", help);
    json_write_key(writer, "samples");
    json_write_begin_array(writer);
}

void metrics_write_end(struct json_writer *writer)
{
    json_write_end_array(writer);
    json_write_end_object(writer);
}

static void begin_sample(struct json_writer *writer, const char *const labels[])
{
    json_write_begin_object(writer);
    json_write_key(writer, "labels");
    json_write_begin_object(writer);
    for (; labels && labels[0]; labels += 2)
        json_write_string_member(writer, labels[0], labels[1]);
    json_write_end_object(writer);
}

void metrics_write_value(struct json_writer *writer, const char *const labels[], double value)
{
    begin_sample(writer, labels);
    json_write_number_member(writer, "value", value);
    json_write_end_object(writer);
}

void metrics_write_classes(struct json_writer *writer, const char *const labels[], const double *ends,
                           const uint64_t *counts, size_t end_count, double sum)
{
    uint64_t count = 0;

    begin_sample(writer, labels);
    json_write_key(writer, "buckets");
    json_write_begin_array(writer);
    for (size_t i = 0; i < end_count; i++) {
        count += counts[i];
        json_write_begin_array(writer);
        json_write_number(writer, ends[i]);
        json_write_integer(writer, (int64_t)count);
        json_write_end_array(writer);
    }
    json_write_end_array(writer);
    json_write_number_member(writer, "sum", sum);
    json_write_integer_member(writer, "count", (int64_t)(count + counts[end_count]));
    json_write_end_object(writer);
}

void metrics_write_histogram(struct json_writer *writer, const char *const labels[], const struct histogram *histogram,
                             const struct histogram_scale *scale)
{
    metrics_write_classes(writer, labels, scale->ends, histogram->counts, scale->count, histogram->sum);
}

void metrics_write_single(struct json_writer *writer, const char *type, const char *name, const char *help,
                          double value)
{
    metrics_write_begin(writer, type, name, help);
    metrics_write_value(writer, NULL, value);
    metrics_write_end(writer);
}
