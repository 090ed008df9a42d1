// Linked GL programs, kept by the hash of their text as long as there is room.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/lru.h"

#include <stdbool.h>

struct error;
struct gl_functions;
struct gl_program_params;

enum { GL_PROGRAMS_LIMIT = 32 };

struct kept_program {
    unsigned name; // GL's
    int rows;      // rows or layers of its work that one call does; set by whoever runs it, 0 at first
    int squares;   // the same of a list of pixels
};

struct gl_programs {
    const struct gl_functions *gl; // borrowed; outlives us
    // NULL, or called before (`begins`) and after a program is linked, which may take seconds.
    void (*on_link)(void *user, bool begins);
    void *user;
    struct lru lru;
    struct kept_program kept[GL_PROGRAMS_LIMIT];
};

void gl_programs_init(struct gl_programs *programs, const struct gl_functions *gl);
void gl_programs_finish(struct gl_programs *programs); // accepts the zero value
// Returns the program with that hash, linked from `params` unless it is kept; NULL with the reason where linking fails.
// The pointer is valid until GL_PROGRAMS_LIMIT - 1 other programs have been asked for.
struct kept_program *gl_programs_find(struct gl_programs *programs, const char *hash,
                                      const struct gl_program_params *params, struct error *error);
