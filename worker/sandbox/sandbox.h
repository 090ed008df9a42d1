// The worker's sandbox. A process that a stranger's job has taken over reaches that job's files and nothing else.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct fence;

enum { SANDBOX_TEXT_SIZE = 64 };

// Limits any worker: it writes no core files, it may allocate `memory_bytes` (0: any amount), and when memory is short
// the kernel ends it before the daemon.
void sandbox_limit(int64_t memory_bytes);

// Closes descriptors that the parent left open by mistake; standard ones and `channel_fd` stay.
void sandbox_close_files(int channel_fd);

enum sandbox_fault {
    SANDBOX_FAULT_WORKER, // the kernel lacks what is needed
    SANDBOX_FAULT_JOB,    // an input cannot be opened, or leads out of its root
    SANDBOX_FAULT_OUTPUT, // the output folder cannot be opened, or leads out of its root
    SANDBOX_FAULT_ROOT    // the output root is not there, or another folder is in its place
};

struct sandbox_job {
    const struct fence *fence; // borrowed for the call
    const char *shader_folder; // borrowed for the call; NULL: none is read
};

// Confines a worker for one owner's jobs, before it has threads. Afterwards it can open their inputs, their output
// folders and what drivers need, makes no sockets and reaches no other process. `holds` receives the names of what the
// kernel enforces. Errors are of the fence's first job alone: what the others lack stays closed.
bool sandbox_enter_job(const struct sandbox_job *job, char holds[static SANDBOX_TEXT_SIZE], enum sandbox_fault *fault,
                       struct error *error);

// Confines a worker for any job, or for its own user, to a list of system calls; all files stay accessible. Holds for
// all threads, whichever calls it. GL is loaded before, because a driver may run a program that makes its devices.
bool sandbox_enter(char holds[static SANDBOX_TEXT_SIZE], struct error *error);
