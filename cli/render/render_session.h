// Renders a job's frames with a worker, which is replaced when it dies, until each frame is there or given up.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"
#include "core/wire/frame_accuracy.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct interrupt;
struct job;
struct options;

enum render_outcome {
    RENDER_SUCCEEDED,
    RENDER_SKIPPED, // the file existed and is this job's
    RENDER_FAILED
};

// How one frame ended.
struct render_result {
    int32_t frame;
    enum render_outcome outcome;
    const char *name;               // the file's, below the output root; borrowed for the call
    double render_s, encode_s;      // if succeeded
    struct frame_accuracy accuracy; // unless failed; as far as known
    int64_t size_bytes;             // unless failed
    const char *hash;               // borrowed for the call; NULL when failed
    const char *error;              // if failed; borrowed for the call
};

struct render_session_params {
    const struct options *options; // borrowed
    const struct job *job;         // borrowed
    const char *document;          // borrowed; the same job as JSON
    const char *root;              // borrowed; absolute output root
    const char *plan_of;           // borrowed; absolute: the file whose settings are used; NULL: none
    const char *preview;           // borrowed; absolute: the file that shows frames as they refine; NULL: none
    struct interrupt *interrupt;   // borrowed
    void (*on_result)(void *user, const struct render_result *result);
    void (*on_tick)(void *user); // now and then
    // What the worker does: "link", "plan", "render" or "audit". How much of it is done: 0 to 1; negative: unknown.
    void (*on_phase)(void *user, const char *phase, double progress);
    // A plan is made that serves so many frames, whose rendering is to take so many seconds each; 0: not known.
    void (*on_planned)(void *user, int64_t frame_count, double render_s);
    void (*on_worker)(void *user, const char *backend, const char *renderer); // a worker is ready
    void (*on_worker_lost)(void *user, const char *why);                      // and replaced
    void *user;
};

// Returns EXIT_STATUS_DONE when every frame succeeded or was there, EXIT_STATUS_FAILED when one failed or is there but
// missed its tolerance. `error` is set
// when the remaining frames were not tried: no GL context, a fault of the job itself, an unwritable output folder.
enum exit_status render_session_run(const struct render_session_params *params, struct error *error);
