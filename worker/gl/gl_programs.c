// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_programs.h"

#include "core/base/clock.h"
#include "core/base/log.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"

void gl_programs_init(struct gl_programs *programs, const struct gl_functions *gl)
{
    *programs = (struct gl_programs){.gl = gl, .lru.capacity = GL_PROGRAMS_LIMIT};
}

static void drop(void *user, int index)
{
    struct gl_programs *programs = user;

    programs->gl->DeleteProgram(programs->kept[index].name);
}

void gl_programs_finish(struct gl_programs *programs)
{
    lru_clear(&programs->lru, drop, programs);
}

struct kept_program *gl_programs_find(struct gl_programs *programs, const char *hash,
                                      const struct gl_program_params *params, struct error *error)
{
    double start = clock_now_s();
    unsigned name;
    int index;

    lru_begin(&programs->lru);
    index = lru_find(&programs->lru, hash);
    if (index >= 0) return &programs->kept[index];
    if (programs->on_link) programs->on_link(programs->user, true);
    name = gl_program_create(programs->gl, params, error);
    if (programs->on_link) programs->on_link(programs->user, false);
    if (!name) return NULL;
    log_debug("renderer: program %s linked in %.1f ms", hash, 1000 * (clock_now_s() - start));
    index = lru_make_room(&programs->lru, 0, drop, programs);
    lru_put(&programs->lru, index, hash, 0);
    programs->kept[index] = (struct kept_program){.name = name};
    return &programs->kept[index];
}
