// The stub worker's reports on itself, its frames and its plans.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct json_writer;

struct stub_frame {
    int64_t job;
    int32_t frame, attempt;
    bool is_forced; // not to be skipped
};

// The caller writes members between the two.
void stub_report_begin(struct json_writer *out, const char *method, const struct stub_frame *frame);
void stub_report_end(struct json_writer *out);

void stub_report_ready(struct json_writer *out);
void stub_report_unable(struct json_writer *out);
void stub_report_skipped(struct json_writer *out, const struct stub_frame *frame, int64_t size_bytes, const char *hash);
void stub_report_failed(struct json_writer *out, const struct stub_frame *frame, const char *fault, const char *error);
// All frames ask for the same segment's plan.
void stub_report_plan_wanted(struct json_writer *out, const struct stub_frame *frame);
// `is_bad`: with a quality that no job may state.
void stub_report_plan_made(struct json_writer *out, const struct stub_frame *frame, bool is_bad);
