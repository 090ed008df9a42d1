// Linked GL programs, kept by the hash of their text as long as there is room.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <stdint.h>

struct error;
struct gl_functions;
struct gl_program_params;

enum { GL_PROGRAMS_LIMIT = 32 };

struct kept_program {
    char hash[HASH_TEXT_SIZE]; // empty: none
    unsigned name;             // GL's
    int rows;                  // of its work that are done at once; whoever runs it says, and begins with 0
    uint64_t used;             // the greater, the more recently
};

// The zero value, with `gl` set, is empty.
struct gl_programs {
    const struct gl_functions *gl; // borrowed; outlives us
    struct kept_program kept[GL_PROGRAMS_LIMIT];
    uint64_t use_count;
};

void gl_programs_finish(struct gl_programs *programs); // accepts an empty one
// The program of that hash, linked from `params` unless it is here; NULL with the reason where that fails. Valid until
// GL_PROGRAMS_LIMIT - 1 others have been asked for.
struct kept_program *gl_programs_find(struct gl_programs *programs, const char *hash,
                                      const struct gl_program_params *params, struct error *error);
