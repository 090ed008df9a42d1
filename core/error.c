#include "core/error.h"

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
    char message[sizeof error->message];
    va_list arguments;
    int length;

    if (!error) return;
    va_start(arguments, format);
    length = vsnprintf(prefix, sizeof prefix, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= sizeof prefix) return;
    memcpy(message, error->message, sizeof message);
    snprintf(error->message, sizeof error->message, "%s: %.*s", prefix,
             (int)(sizeof message - (size_t)length - 3 < sizeof message ? sizeof message - (size_t)length - 3 : 0), message);
}
