// Time against error of frame 0: ladder_bench TRUTH STRIDE JOB... The jobs show the same scene at the same size, each its own
// way. TRUTH keeps the light of every STRIDE-th pixel and row, from STRIDE / 2 on, as doubles; it is measured when it is not there.
#include "core/alloc.h"
#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "core/job_json.h"
#include "reference/reference.h"
#include "worker/gl_context.h"
#include "worker/image.h"
#include "worker/renderer.h"
#include "worker/truth.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { RUNS = 5, JOB_BYTES = 1 << 20 };

static double clock_s(clockid_t clock)
{
    struct timespec now;

    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool load_job(struct job *job, const char *path, struct error *error)
{
    size_t length;
    char *text = NULL;
    bool ok = file_read_text(path, JOB_BYTES, &text, &length, error) && job_parse(job, text, length, NULL, error);

    free(text);
    return ok;
}

static struct truth_place *list_places(const struct job *job, int stride, size_t *count)
{
    size_t limit = (size_t)job->width_px * (size_t)job->height_px;
    struct truth_place *places = xcalloc(limit, sizeof *places);

    *count = 0;
    for (int y = stride / 2; y < job->height_px; y += stride)
        for (int x = stride / 2; x < job->width_px; x += stride)
            places[(*count)++] = (struct truth_place){x, y};
    return places;
}

static bool measure_truth(const struct job *job, const struct truth_place *places, size_t count, double *light,
                          struct error *error)
{
    struct truth *truth = truth_open(&(struct truth_params){.job = job, .frame = 0}, error);
    struct truth_pixel *pixels = xcalloc(count, sizeof *pixels);

    if (truth) {
        truth_measure_many(truth, &(struct truth_many){.places = places, .pixels = pixels, .count = count});
        for (size_t i = 0; i < 3 * count; i++)
            light[i] = pixels[i / 3].rgb[i % 3];
    }
    truth_close(truth);
    free(pixels);
    return truth != NULL;
}

static bool load_truth(const char *path, const struct job *job, const struct truth_place *places, size_t count,
                       double *light, struct error *error)
{
    FILE *file = fopen(path, "re");
    bool ok = file && fread(light, 3 * sizeof *light, count, file) == count;

    if (file) {
        fclose(file);
        if (!ok) error_set(error, "%s: expected the light of %zu pixels", path, count);
        return ok;
    }
    if (!measure_truth(job, places, count, light, error)) return false;
    file = fopen(path, "we");
    ok = file && fwrite(light, 3 * sizeof *light, count, file) == count;
    if (file && fclose(file) != 0) ok = false;
    if (!ok) error_set(error, "%s: cannot be written", path);
    return ok;
}

// The first frame compiles and reads; of the next ones the fastest counts.
static bool render(struct renderer *renderer, const struct job *job, struct image *image, double best[static 2],
                   struct error *error)
{
    best[0] = best[1] = 1e30;
    for (int i = RUNS; i >= 0; i--) {
        double wall = clock_s(CLOCK_MONOTONIC), cpu = clock_s(CLOCK_PROCESS_CPUTIME_ID);
        struct renderer_result result;

        if (!renderer_render(renderer, job, i, image, NULL, NULL, &result, error)) return false;
        wall = clock_s(CLOCK_MONOTONIC) - wall;
        cpu = clock_s(CLOCK_PROCESS_CPUTIME_ID) - cpu;
        if (i < RUNS && wall < best[0]) best[0] = wall;
        if (i < RUNS && cpu < best[1]) best[1] = cpu;
    }
    return true;
}

static bool print_job(struct renderer *renderer, const char *path, const char *truth_path, int stride,
                      struct error *error)
{
    struct truth_place *places = NULL;
    struct reference_error found;
    struct image image = {0};
    struct job job = {0};
    double *light = NULL, best[2];
    float *seen = NULL;
    size_t count;
    bool ok = load_job(&job, path, error) && image_init(&image, job.width_px, job.height_px, false, false, error);

    if (!ok) goto out;
    places = list_places(&job, stride, &count);
    light = xcalloc(3 * count, sizeof *light);
    seen = xcalloc(3 * count, sizeof *seen);
    ok = load_truth(truth_path, &job, places, count, light, error) && render(renderer, &job, &image, best, error);
    if (!ok) goto out;
    for (size_t i = 0; i < 3 * count; i++) {
        const struct truth_place *place = &places[i / 3];

        seen[i] = image.rgba[4 * ((size_t)place->y * (size_t)job.width_px + (size_t)place->x) + i % 3];
    }
    found = reference_image_error(seen, light, 3 * count);
    printf("%.6f %.6f %.6e %s\n", best[0], best[1], found.relative_rmse, path);
    fflush(stdout);
out:
    free(seen);
    free(light);
    free(places);
    image_finish(&image);
    job_finish(&job);
    return ok;
}

int main(int argc, char *argv[])
{
    struct error error = {0};
    struct gl_context *context = gl_context_create(GL_BACKEND_OSMESA, NULL, &error);
    struct renderer *renderer = context ? renderer_create(context, NULL) : NULL;
    int stride = argc > 3 ? atoi(argv[2]) : 0, failures = !renderer;

    if (!context) fprintf(stderr, "%s\n", error.message);
    if (stride < 1) {
        fprintf(stderr, "usage: ladder_bench TRUTH STRIDE JOB...\n");
        failures = 2;
    }
    for (int i = 3; !failures && i < argc; i++)
        if (!print_job(renderer, argv[i], argv[1], stride, &error)) {
            fprintf(stderr, "%s: %s\n", argv[i], error.message);
            failures = 1;
        }
    if (renderer) renderer_destroy(renderer);
    if (context) gl_context_destroy(context);
    return failures;
}
