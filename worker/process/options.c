// SPDX-License-Identifier: Apache-2.0
#include "worker/process/options.h"

#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ENCODE_THREAD_LIMIT = 64 };

static bool parse_number(const char *name, const char *text, int min, int max, int *number, struct error *error)
{
    char *end;
    long value;

    errno = 0;
    value = strtol(text, &end, 10);
    if (errno || end == text || *end || value < min || value > max) {
        error_set(error, "--%s: expected a number from %d to %d, got \"%s\"", name, min, max, text);
        return false;
    }
    *number = (int)value;
    return true;
}

static bool parse_bytes(const char *text, int64_t *bytes, struct error *error)
{
    char *end;

    errno = 0;
    *bytes = strtoll(text, &end, 10);
    if (!errno && end != text && !*end && *bytes > 0) return true;
    error_set(error, "--memory: expected a number of bytes, got \"%s\"", text);
    return false;
}

static bool parse_yes(const char *name, const char *text, bool *is_yes, struct error *error)
{
    *is_yes = strcmp(text, "yes") == 0;
    if (*is_yes || strcmp(text, "no") == 0) return true;
    error_set(error, "--%s: expected yes or no, got \"%s\"", name, text);
    return false;
}

static bool parse_backend(struct options *options, const char *text, struct error *error)
{
    static const struct {
        const char *name;
        enum gl_backend backend;
    } backends[] = {{"auto", GL_BACKEND_AUTO},
                    {"egl", GL_BACKEND_EGL},
                    {"osmesa", GL_BACKEND_OSMESA},
                    {"software", GL_BACKEND_SOFTWARE}};

    options->has_context = strcmp(text, "none") != 0;
    if (!options->has_context) return true;
    for (size_t i = 0; i < sizeof backends / sizeof backends[0]; i++)
        if (!strcmp(text, backends[i].name)) {
            options->backend = backends[i].backend;
            return true;
        }
    error_set(error, "--backend: expected auto, egl, osmesa, software or none, got \"%s\"", text);
    return false;
}

// A missing folder would silently mean the built-in shaders.
static bool check_folder(const char *name, const char *path, struct error *error)
{
    int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);

    if (fd >= 0) {
        close(fd);
        return true;
    }
    error_set_errno(error, errno, "--%s: %s", name, path);
    return false;
}

static bool parse_option(struct options *options, int option, const char *text, struct error *error)
{
    switch (option) {
    case 'f':
        return parse_number("fd", text, 0, INT_MAX, &options->fd, error);
    case 'b':
        return parse_backend(options, text, error);
    case 'd':
        options->device = text;
        return true;
    case 's':
        options->shader_dir = text;
        return check_folder("shader-dir", text, error);
    case 'e':
        return parse_number("encode-threads", text, 1, ENCODE_THREAD_LIMIT, &options->encode_threads, error);
    case 'S':
        return parse_yes("sandbox", text, &options->has_sandbox, error);
    case 'F':
        options->is_fenced = true;
        return true;
    case 'V':
        options->wants_version = true;
        return true;
    case 'm':
        return parse_bytes(text, &options->memory_bytes, error);
    default:
        error_set(
            error,
            "usage: march-worker --fd N [--backend auto|egl|osmesa|software|none] [--device UUID-or-index-or-turn:N] "
            "[--shader-dir DIR] [--encode-threads N] [--memory BYTES] [--sandbox yes|no] [--fenced], or --node "
            "[--worker PROGRAM], or --version");
        return false;
    }
}

bool options_parse(struct options *options, int argc, char *const argv[], struct error *error)
{
    static const struct option known[] = {{"fd", required_argument, NULL, 'f'},
                                          {"backend", required_argument, NULL, 'b'},
                                          {"device", required_argument, NULL, 'd'},
                                          {"shader-dir", required_argument, NULL, 's'},
                                          {"encode-threads", required_argument, NULL, 'e'},
                                          {"memory", required_argument, NULL, 'm'},
                                          {"sandbox", required_argument, NULL, 'S'},
                                          {"fenced", no_argument, NULL, 'F'},
                                          {"version", no_argument, NULL, 'V'},
                                          {NULL, 0, NULL, 0}};
    int option;

    *options = (struct options){
        .fd = -1, .has_context = true, .backend = GL_BACKEND_AUTO, .encode_threads = 1, .has_sandbox = true};
    optind = 0; // restarts getopt: tests parse more than once
    opterr = 0;
    while ((option = getopt_long(argc, argv, "", known, NULL)) != -1)
        if (!parse_option(options, option, optarg, error)) return false;
    if (optind < argc) {
        error_set(error, "expected options only, got \"%s\"", argv[optind]);
        return false;
    }
    if (options->fd >= 0 || options->wants_version) return true;
    error_set(error, "--fd: expected the number of a connected socket: march-worker is started by marchd and march");
    return false;
}
