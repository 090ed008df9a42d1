// SPDX-License-Identifier: Apache-2.0
#include "core/base/log.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static enum log_level lowest = LOG_INFO;
static log_sink *sink = log_to_stderr;

static const char *const level_names[] = {"debug", "info", "warning", "error"};

void log_set_level(enum log_level level)
{
    lowest = level;
}

void log_set_sink(log_sink *wanted)
{
    sink = wanted ? wanted : log_to_stderr;
}

// Control characters: C0, DEL, and C1 in UTF-8 (0xc2, then 0x80 to 0x9f).
static bool is_control(const unsigned char *text)
{
    if (text[0] == '\n' || text[0] == '\t') return false;
    return text[0] < 0x20 || text[0] == 0x7f || (text[0] == 0xc2 && text[1] >= 0x80 && text[1] < 0xa0);
}

void log_disarm(char *line)
{
    for (unsigned char *at = (unsigned char *)line; *at; at++) {
        if (!is_control(at)) continue;
        if (*at == 0xc2) *at++ = '?';
        *at = '?';
    }
    for (size_t length = strlen(line); length > 0 && line[length - 1] == '\n'; length--)
        line[length - 1] = '\0';
}

static void say(enum log_level level, const struct log_subject *subject, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

static void say(enum log_level level, const struct log_subject *subject, const char *format, va_list arguments)
{
    char line[LOG_LINE_SIZE];

    if (level < lowest) return;
    vsnprintf(line, sizeof line, format, arguments);
    log_disarm(line);
    sink(level, subject, line);
}

void log_to_stderr(enum log_level level, const struct log_subject *subject, const char *line)
{
    char stamp[32], text[2 * LOG_LINE_SIZE];
    struct timespec now;
    struct tm broken;
    size_t length = 0;

    (void)subject;
    clock_gettime(CLOCK_REALTIME, &now);
    localtime_r(&now.tv_sec, &broken);
    strftime(stamp, sizeof stamp, "%H:%M:%S", &broken);
    // Continuation lines are indented, so that no text can pass for a log line.
    for (; *line && length < sizeof text - 2; line++) {
        text[length++] = *line;
        if (*line == '\n') text[length++] = '\t';
    }
    text[length] = '\0';
    fprintf(stderr, "%s.%03ld %s: %s\n", stamp, now.tv_nsec / 1000000, level_names[level], text);
}

#define LOG_FUNCTION(name, level)                                                                                      \
    void name(const char *format, ...)                                                                                 \
    {                                                                                                                  \
        va_list arguments;                                                                                             \
        va_start(arguments, format);                                                                                   \
        say(level, &(struct log_subject){0}, format, arguments);                                                       \
        va_end(arguments);                                                                                             \
    }

LOG_FUNCTION(log_debug, LOG_DEBUG)
LOG_FUNCTION(log_info, LOG_INFO)
LOG_FUNCTION(log_warn, LOG_WARN)
LOG_FUNCTION(log_error, LOG_ERROR)

void log_about(enum log_level level, const struct log_subject *subject, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    say(level, subject, format, arguments);
    va_end(arguments);
}
