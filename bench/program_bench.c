// The CPU time of jobs' programs: program_bench JOB...
// SPDX-License-Identifier: Apache-2.0
// Measures compiling and linking, then tiny frames of each on a new renderer. In the first the driver also makes
// machine code; in the others it should not. A job with a tolerance has its draft's program.
#include "cli/job/job_document.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/gl/gl_context.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"
#include "worker/picture/image.h"
#include "worker/plan/draft.h"
#include "worker/render/renderer.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_program.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { WIDTH = 16, HEIGHT = 9, FRAMES = 12 };

static double now_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static bool time_link(struct gl_context *context, const struct job *job, double *link_ms, size_t *text_bytes,
                      struct error *error)
{
    struct scene_inputs inputs = {0};
    struct scene_program program = {0};
    struct gl_functions gl;
    unsigned name = 0;
    double start;

    if (!gl_functions_load(&gl, context, error) ||
        !scene_inputs_open(&inputs, job, frame_range_at(&job->frames, 0), NULL, NULL, error) ||
        !scene_program_init(&program, job, &inputs, NULL, error))
        goto out;
    *text_bytes = strlen(program.fragment);
    start = now_ms();
    name = gl_program_create(&gl,
                             &(struct gl_program_params){.vertex = program.vertex,
                                                         .fragment = program.fragment,
                                                         .module_names = program.module_names,
                                                         .module_count = program.module_count},
                             error);
    *link_ms = now_ms() - start;
    if (name) gl.DeleteProgram(name);
out:
    scene_program_finish(&program);
    scene_inputs_finish(&inputs);
    return name != 0;
}

static bool time_frame(struct renderer *renderer, const struct job *job, int index, double *ms, struct error *error)
{
    struct renderer_result result;
    struct image image = {0};
    double start = now_ms();
    bool ok = image_init(&image, job->width_px, job->height_px, job->output.has_depth, job->output.has_transmittance,
                         error) &&
              renderer_render(
                  renderer,
                  &(struct renderer_frame){.job = job, .frame = frame_range_at(&job->frames, index), .image = &image},
                  &result, error);

    *ms = now_ms() - start;
    image_finish(&image);
    return ok;
}

static bool measure(struct gl_context *context, const char *path)
{
    struct error error = {0};
    char *document = job_document_load(path, NULL, 0, &error);
    struct job job = {0};
    struct renderer *renderer = NULL;
    double link_ms = 0.0, first_ms = 0.0, slowest_ms = 0.0;
    size_t text_bytes = 0;
    char reason[IMAGE_EXR_PLAN_SIZE];
    bool ok = document && job_document_check(path, document, "/", &job, &error);

    if (job.quality.method == JOB_METHOD_AUTO) job.quality.method = JOB_METHOD_DRAFT;
    ok = ok && draft_settle(&job, reason, &error);
    job.width_px = WIDTH;
    job.height_px = HEIGHT;
    if (ok) renderer = renderer_create(context, NULL);
    ok = ok && time_link(context, &job, &link_ms, &text_bytes, &error) &&
         time_frame(renderer, &job, 0, &first_ms, &error);
    for (int i = 1; ok && i < FRAMES; i++) {
        double ms;

        ok = time_frame(renderer, &job, i, &ms, &error);
        slowest_ms = fmax(slowest_ms, ms);
    }
    if (ok)
        printf("%-12s %9.1f %12.0f %12.0f %12.0f\n", job.name, (double)text_bytes / 1024.0, link_ms, first_ms,
               slowest_ms);
    else
        printf("%s: %s\n", path, error.message);
    if (renderer) renderer_destroy(renderer);
    job_finish(&job);
    free(document);
    return ok;
}

int main(int argc, char *argv[])
{
    struct error error = {0};
    struct gl_context *context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
    int failures = context == NULL;

    if (!context) printf("%s\n", error.message);
    printf("%-12s %9s %12s %12s %12s\n", "job", "text KiB", "link ms", "first ms", "slowest next");
    for (int i = 1; context && i < argc; i++)
        failures += !measure(context, argv[i]);
    if (context) gl_context_destroy(context);
    return failures > 0;
}
