// The worker's command line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/gl_context.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

struct options {
    int fd;           // the socket to the program that started the worker
    bool has_context; // false with --backend none: it explains and previews, but does not render
    enum gl_backend backend;
    const char *device;     // borrowed from argv; NULL: the first that works
    const char *shader_dir; // borrowed from argv; NULL: the shaders built in
    int encode_threads;
    bool has_sandbox;     // enters the sandbox
    bool is_fenced;       // serves the jobs of one owner whose files worker.fence names
    int64_t memory_bytes; // allowed to be allocated; 0: any amount
    bool wants_version;   // then the socket may be missing
};

bool options_parse(struct options *options, int argc, char *const argv[], struct error *error);
