// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_timer.h"

#include "core/base/alloc.h"
#include "worker/gl/gl_context.h"
#include "worker/gl/gl_functions.h"

#include <stdlib.h>

struct gl_timer {
    struct gl_functions gl;
    GLuint query;
};

struct gl_timer *gl_timer_create(const struct gl_context *context)
{
    struct gl_timer *timer;

    if (gl_context_facts(context)->is_software) return NULL;
    timer = xcalloc(1, sizeof *timer);
    if (gl_functions_load(&timer->gl, context, NULL)) {
        timer->gl.CreateQueries(GL_TIME_ELAPSED, 1, &timer->query);
        return timer;
    }
    free(timer);
    return NULL;
}

void gl_timer_destroy(struct gl_timer *timer)
{
    if (!timer) return;
    timer->gl.DeleteQueries(1, &timer->query);
    free(timer);
}

void gl_timer_begin(struct gl_timer *timer)
{
    timer->gl.BeginQuery(GL_TIME_ELAPSED, timer->query);
}

double gl_timer_end(struct gl_timer *timer)
{
    GLuint64 nanoseconds = 0;

    timer->gl.EndQuery(GL_TIME_ELAPSED);
    timer->gl.GetQueryObjectui64v(timer->query, GL_QUERY_RESULT, &nanoseconds);
    return 1e-9 * (double)nanoseconds;
}
