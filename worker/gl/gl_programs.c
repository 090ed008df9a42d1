// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_programs.h"

#include "core/base/log.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"

#include <string.h>
#include <time.h>

void gl_programs_finish(struct gl_programs *programs)
{
    for (size_t i = 0; i < GL_PROGRAMS_LIMIT; ++i)
        if (programs->kept[i].name) programs->gl->DeleteProgram(programs->kept[i].name);
    memset(programs->kept, 0, sizeof programs->kept);
}

static double now_s(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct kept_program *gl_programs_find(struct gl_programs *programs, const char *hash,
                                      const struct gl_program_params *params, struct error *error)
{
    struct kept_program *oldest = &programs->kept[0];
    double start = now_s();
    unsigned name;

    for (size_t i = 0; i < GL_PROGRAMS_LIMIT; ++i) {
        struct kept_program *kept = &programs->kept[i];

        if (kept->name && strcmp(kept->hash, hash) == 0) {
            kept->used = ++programs->use_count;
            return kept;
        }
        if (kept->used < oldest->used) oldest = kept;
    }
    name = gl_program_create(programs->gl, params, error);
    if (!name) return NULL;
    log_debug("renderer: program %s linked in %.1f ms", hash, 1000 * (now_s() - start));
    if (oldest->name) programs->gl->DeleteProgram(oldest->name);
    *oldest = (struct kept_program){.name = name, .used = ++programs->use_count};
    memcpy(oldest->hash, hash, sizeof oldest->hash);
    return oldest;
}
