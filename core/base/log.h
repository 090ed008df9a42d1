// Log lines and the job, frame and worker that each is about. The program has one level and one sink.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

enum log_level { LOG_DEBUG, LOG_INFO, LOG_WARN, LOG_ERROR };

// The subject of a line. Zero: unknown. A frame is known only where its job and attempt are.
struct log_subject {
    int64_t job;
    int32_t frame;
    int attempt;
    int worker;
    const char *owner; // borrowed; NULL: unknown
};

enum { LOG_LINE_SIZE = 2048 };

// Writes a line somewhere. The line has no control bytes but line feeds and tabs, and is cut at LOG_LINE_SIZE bytes.
typedef void log_sink(enum log_level level, const struct log_subject *subject, const char *line);

void log_set_level(enum log_level level); // LOG_INFO before the first call
void log_set_sink(log_sink *sink);        // NULL, as before the first call: standard error
void log_to_stderr(enum log_level level, const struct log_subject *subject, const char *line); // the default sink

// Makes foreign text safe for a terminal: control bytes but line feeds and tabs become "?", trailing line feeds go.
void log_disarm(char *text);

void log_debug(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
// Likewise, with a subject.
void log_about(enum log_level level, const struct log_subject *subject, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
