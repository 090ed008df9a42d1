// The worker's sandbox: what a stranger's job could make of this process reaches its own files and nothing else.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct fence;

enum { SANDBOX_TEXT_SIZE = 64 };

// Of every worker: no core files, the kernel takes it rather than the daemon when memory is short, and it may allocate
// `memory_bytes` (0: any amount).
void sandbox_limit(int64_t memory_bytes);

// What whoever started us left open, by mistake, beside `channel_fd`.
void sandbox_close_files(int channel_fd);

enum sandbox_fault {
    SANDBOX_FAULT_WORKER, // the kernel does not do it
    SANDBOX_FAULT_JOB,    // its input cannot be opened, or leads out of its root
    SANDBOX_FAULT_OUTPUT  // likewise its output folder
};

struct sandbox_job {
    const struct fence *fence; // borrowed for the call, as all of this
    const char *shader_folder; // NULL: none is read
};

// Of a worker that serves one job; before there are threads. From here on it opens the job's inputs, its output folder and
// what drivers need, makes no sockets and reaches no process. `holds` receives what of that the kernel sees to.
bool sandbox_enter_job(const struct sandbox_job *job, char holds[static SANDBOX_TEXT_SIZE], enum sandbox_fault *fault,
                       struct error *error);

// Of a worker that serves anybody, or its own user: all files stay open to it. On any thread, for all of them; after GL is
// there, for a driver may run a program that makes its devices.
bool sandbox_enter(char holds[static SANDBOX_TEXT_SIZE], struct error *error);
