// Linked GL programs, kept by the hash of their text as long as there is room.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/lru.h"

struct error;
struct gl_functions;
struct gl_program_params;

enum { GL_PROGRAMS_LIMIT = 32 };

struct kept_program {
    unsigned name; // GL's
    int rows;      // of its work that are done at once; whoever runs it sets it, and begins with 0
};

struct gl_programs {
    const struct gl_functions *gl; // borrowed; outlives us
    struct lru lru;
    struct kept_program kept[GL_PROGRAMS_LIMIT];
};

void gl_programs_init(struct gl_programs *programs, const struct gl_functions *gl);
void gl_programs_finish(struct gl_programs *programs); // accepts the zero value
// The program of that hash, linked from `params` unless it is here; NULL with the reason where that fails. Valid until
// GL_PROGRAMS_LIMIT - 1 others have been asked for.
struct kept_program *gl_programs_find(struct gl_programs *programs, const char *hash,
                                      const struct gl_program_params *params, struct error *error);
