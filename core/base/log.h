// Lines for the operator, with what each is about; one level and one way out for the whole program.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

enum log_level { LOG_DEBUG, LOG_INFO, LOG_WARN, LOG_ERROR };

// What a line is about. Zero: not known; a frame counts only where its job and attempt are known.
struct log_subject {
    int64_t job;
    int32_t frame;
    int attempt;
    int worker;
    const char *owner; // borrowed; NULL: not known
};

enum { LOG_LINE_SIZE = 2048 };

// Takes a line that is to be said. Without control bytes but line feeds; what is longer than LOG_LINE_SIZE is cut.
typedef void log_sink(enum log_level level, const struct log_subject *subject, const char *line);

void log_set_level(enum log_level level); // LOG_INFO before the first call
void log_set_sink(log_sink *sink);        // NULL, as before the first call: standard error
void log_to_stderr(enum log_level level, const struct log_subject *subject, const char *line); // that sink

// Strangers' words for a terminal: control bytes but line feeds and tabs become "?", and line feeds at the end go.
void log_disarm(char *text);

void log_debug(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
// As those, and says what it is about.
void log_about(enum log_level level, const struct log_subject *subject, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
