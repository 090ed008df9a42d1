// Folders of two users beside the daemon's, and processes that are fenced in for a job of one of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/sandbox/fence.h"
#include "worker/sandbox/sandbox.h"

#include <stdbool.h>

struct error;

// Makes in/ann, in/bob, out/ann, out/bob and state in a new folder, with some files; `*state` is then the folder. For
// temp_folder_destroy to remove.
int fence_places_make(void **state);
// The path of `name` below that folder, in one of a few static buffers.
const char *fence_places_at(const char *name);
void fence_places_write_file(const char *path);

// The job whose only input is that file, in that folder below in/.
struct fence fence_places_job(const char *folder, const char *name, const char *output);
void fence_places_add_job(struct fence *fence, const char *folder, const char *name, const char *output);
bool fence_places_has_landlock(void);
void fence_places_skip_without_landlock(void);
// Finishes the fence.
bool fence_places_enter(struct fence *fence, enum sandbox_fault *fault, struct error *error);
// Runs `probe` in a process that is fenced in for the job; 0 is what it should return. Finishes the fence.
void fence_places_run(struct fence fence, int (*probe)(void));

bool fence_places_can_open(const char *path, int flags);
// True when a call that returned this was refused by the sandbox, not for its arguments.
bool fence_places_is_refused(long result);
