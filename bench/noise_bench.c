// Noise and bias of pictures by random paths: noise_bench [--frame N] [--truth FILE] JOB...
// SPDX-License-Identifier: Apache-2.0
// It runs in the folder to which the jobs' files are relative. Each job is rendered twice, by independent paths: half
// the square of the difference is noise. FILE has two such pictures of the same scene; the first job makes them where
// it is missing. What both pictures of a job differ by from both of them, multiplied crosswise, is error without the
// noise of either. Lines have processor seconds of the second picture, which links and reads nothing, the noise of one
// picture and that error, both over the light's RMS, the mean light, and the job.
#include "bench/job_file.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct pair {
    struct image images[2];
    double processor_s; // of the second
};

static void finish_pair(struct pair *pair)
{
    image_finish(&pair->images[0]);
    image_finish(&pair->images[1]);
}

static bool render_pair(struct pair *pair, struct renderer *renderer, const struct job *job, int32_t frame,
                        struct error *error)
{
    static const enum renderer_stream STREAMS[] = {RENDERER_STREAM_PICTURE, RENDERER_STREAM_PLAN_AGAIN};

    for (int i = 0; i < 2; i++) {
        double began = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
        struct renderer_result result;

        if (!image_init(&pair->images[i], job->width_px, job->height_px, false, false, error) ||
            !renderer_render(
                renderer,
                &(struct renderer_frame){.job = job, .frame = frame, .stream = STREAMS[i], .image = &pair->images[i]},
                &result, error))
            return false;
        pair->processor_s = clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - began;
    }
    return true;
}

// Reads or writes both pictures.
static bool exchange_pair(struct pair *pair, const struct job *job, const char *path, bool writes, struct error *error)
{
    size_t count = 4 * (size_t)job->width_px * (size_t)job->height_px;
    FILE *file = fopen(path, writes ? "we" : "re");
    bool ok = file != NULL;

    for (int i = 0; i < 2 && ok; i++) {
        if (!writes) ok = image_init(&pair->images[i], job->width_px, job->height_px, false, false, error);
        if (ok)
            ok = (writes ? fwrite(pair->images[i].rgba, sizeof(float), count, file)
                         : fread(pair->images[i].rgba, sizeof(float), count, file)) == count;
    }
    if (file && fclose(file) != 0) ok = false;
    if (!ok) error_set(error, "%s: cannot be %s", path, writes ? "written" : "read");
    return ok;
}

static void print_pair(const struct pair *pair, const struct pair *truth, const struct job *job, const char *path)
{
    size_t count = (size_t)job->width_px * (size_t)job->height_px;
    double light = 0.0, noise = 0.0, off = 0.0, mean = 0.0;

    for (size_t i = 0; i < 4 * count; i++) {
        double a = (double)pair->images[0].rgba[i], b = (double)pair->images[1].rgba[i];

        if (i % 4 == 3) continue;
        light += a * b;
        mean += 0.5 * (a + b);
        noise += 0.5 * (a - b) * (a - b);
        if (truth) {
            double c = (double)truth->images[0].rgba[i], d = (double)truth->images[1].rgba[i];

            off += 0.5 * ((a - c) * (b - d) + (a - d) * (b - c));
        }
    }
    printf("%8.3f s  noise %.3e  off %+.3e  mean %.6e  %s\n", pair->processor_s, sqrt(noise / light),
           copysign(sqrt(fabs(off) / light), off), mean / (3.0 * (double)count), path);
    fflush(stdout);
}

static bool print_job(struct renderer *renderer, const char *path, int32_t frame, const char *truth_path,
                      struct error *error)
{
    struct pair pair = {0}, truth = {0};
    struct job job = {0};
    bool ok = job_file_load(&job, path, error) && render_pair(&pair, renderer, &job, frame, error);

    if (ok && truth_path && !exchange_pair(&truth, &job, truth_path, false, NULL)) {
        ok = exchange_pair(&pair, &job, truth_path, true, error);
        truth_path = NULL;
    }
    if (ok) print_pair(&pair, truth_path ? &truth : NULL, &job, path);
    finish_pair(&truth);
    finish_pair(&pair);
    job_finish(&job);
    return ok;
}

int main(int argc, char *argv[])
{
    struct error error = {0};
    const char *truth = NULL;
    int32_t frame = 1;
    struct gl_context *context;
    struct renderer *renderer;
    bool ok = true;
    int i = 1;

    for (; i + 1 < argc && argv[i][0] == '-'; i += 2) {
        if (!strcmp(argv[i], "--frame")) frame = atoi(argv[i + 1]);
        if (!strcmp(argv[i], "--truth")) truth = argv[i + 1];
    }
    context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
    renderer = context ? renderer_create(context, getenv("SHADER_DIR")) : NULL;
    if (!renderer) ok = false;
    for (; ok && i < argc; i++)
        ok = print_job(renderer, argv[i], frame, truth, &error);
    if (!ok) fprintf(stderr, "%s\n", error.message);
    if (renderer) renderer_destroy(renderer);
    if (context) gl_context_destroy(context);
    return !ok;
}
