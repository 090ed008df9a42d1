// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

void error_set(struct error *error, const char *format, ...)
{
    va_list arguments;

    if (!error) return;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
}

bool error_is_shortage(int errnum)
{
    return errnum == EMFILE || errnum == ENFILE;
}

// Appends the text of `errnum`. A shortage of the program or the machine is not the fault of the file that was opened.
static void append_cause(struct error *error, int errnum)
{
    size_t length = strlen(error->message);
    char *end = error->message + length;
    size_t room = sizeof error->message - length;
    struct rlimit limit;

    if (errnum == EMFILE && getrlimit(RLIMIT_NOFILE, &limit) == 0)
        snprintf(end, room, ": this program may open no more than %" PRIu64 " files (LimitNOFILE= of its service)",
                 (uint64_t)limit.rlim_cur);
    else if (errnum == ENFILE)
        snprintf(end, room, ": all programs together have too many open files (sysctl fs.file-max)");
    else
        snprintf(end, room, ": %s", strerrordesc_np(errnum));
}

void error_set_errno(struct error *error, int errnum, const char *format, ...)
{
    va_list arguments;

    if (!error) return;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    append_cause(error, errnum);
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
