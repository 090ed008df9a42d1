// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void error_set(struct error *error, const char *format, ...)
{
    va_list arguments;

    if (!error) return;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
}

void error_set_errno(struct error *error, int errnum, const char *format, ...)
{
    va_list arguments;
    size_t length;

    if (!error) return;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    length = strlen(error->message);
    snprintf(error->message + length, sizeof error->message - length, ": %s", strerrordesc_np(errnum));
}

void error_prefix(struct error *error, const char *format, ...)
{
    char prefix[sizeof error->message];
    va_list arguments;
    size_t length, kept;
    int written;

    if (!error) return;
    va_start(arguments, format);
    written = vsnprintf(prefix, sizeof prefix, format, arguments);
    va_end(arguments);
    length = (size_t)written;
    if (written < 0 || length + sizeof ": " > sizeof prefix) return;
    kept = strnlen(error->message, sizeof prefix - length - sizeof ": ");
    memmove(error->message + length + 2, error->message, kept);
    memcpy(error->message, prefix, length);
    memcpy(error->message + length, ": ", 2);
    error->message[length + 2 + kept] = '\0';
}
