// The options of a command line: one set for all verbs, of which each verb accepts some.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct error;

enum option {
    OPTION_HELP,
    OPTION_JSON,
    OPTION_SOCKET,
    OPTION_WAIT,
    OPTION_WATCH,
    OPTION_DRY_RUN,
    OPTION_PAUSED,
    OPTION_PRIORITY,
    OPTION_POOL,
    OPTION_SET,
    OPTION_STATE,
    OPTION_RANGE,
    OPTION_FRAME,
    OPTION_FRAMES,
    OPTION_OUT,
    OPTION_BACKEND,
    OPTION_DEVICE,
    OPTION_ENCODE_THREADS,
    OPTION_PROGRESS_LIMIT,
    OPTION_WORKER_PROGRAM,
    OPTION_SHADER,
    OPTION_SHADER_DIR,
    OPTION_COLUMNS,
    OPTION_TILE_WIDTH,
    OPTION_EXPOSURE,
    OPTION_FPS,
    OPTION_TOLERANCE,
    OPTION_METHODS,
    OPTION_SIZE,
    OPTION_QUICK,
    OPTION_POINT_LIMIT,
    OPTION_FILES,
    OPTION_PLAN,
    OPTION_DRAFT,
    OPTION_PLAN_OF,
    OPTION_PREVIEW,
    OPTION_FORCE,
    OPTION_RECONNECT,
    OPTION_ALL,
    OPTION_OWNER,
    OPTION_YES,
    OPTION_NODES,
    OPTION_NAME,
    OPTION_SINCE,
    OPTION_LIMIT,
    OPTION_OVER,
    OPTION_NOTIFY,
    OPTION_SCOPE,
    OPTION_EXPIRES,
    OPTION_URL,
    OPTION_PRINT,
    OPTION_AFTER,
    OPTION_CHAIN,
    OPTION_COUNT
};

#define OPTION_BIT(option) (UINT64_C(1) << (option))

// Strings are borrowed from argv; `range` is a valid frame range. Integers are -1 and numbers NAN when not given.
struct options {
    bool help, json, wait, watch, dry_run, paused, shader, quick, files, plan, draft, force, all, yes, nodes, print,
        chain;
    const char *socket, *state, *range, *out, *backend, *device, *worker_program, *shader_dir, *methods, *size,
        *plan_of, *preview, *owner, *pool, *name, *scope, *expires, *url, *after;
    int64_t priority, frame, encode_threads, progress_limit_s, columns, tile_width_px, point_limit_s, reconnect_s,
        limit, since_s, over_s; // unix times
    double exposure, fps, tolerance;
    const char **sets; // owned array; each PATH=VALUE
    size_t set_count;
    const char *notify;    // NAME:EVENT,EVENT, as job_notify_parse reads it; NULL: not given
    const char **operands; // owned array; all but options
    size_t operand_count;
};

// `arguments` follow the verb. `accepted` has the OPTION_BITs of the verb; any other option is an error that names the
// nearest one. On failure `options` is empty. Free with options_finish in both cases.
bool options_parse(struct options *options, uint64_t accepted, const char *const arguments[], size_t count,
                   struct error *error);
void options_finish(struct options *options);

// The name of an option, the name of its value (NULL for a flag) and its help.
const char *option_name(enum option option);
const char *option_value(enum option option);
const char *option_help(enum option option);

// Prints a line of help for each accepted option.
void options_print_help(FILE *out, uint64_t accepted);

// A job id: a positive integer.
bool options_parse_id(const char *text, int64_t *id, struct error *error);
