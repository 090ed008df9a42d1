// The processor seconds of a frame's parts: frame_parts_bench [--frame N] JOB.json...
// SPDX-License-Identifier: Apache-2.0
// Jobs state a method. Medians of five, of all threads, with grids filled again each time. A line has: width, height,
// pixels traced, and ms of grids (a list of one pixel), camera rays (what is left of the picture), interpolation,
// copies of what was traced, the picture, and the file in memory with its gate. Interpolation and copies are timed by
// functions that the linker puts around the worker's (bench/CMakeLists.txt).
#include "cli/job/job_document.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/audit/gate.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/picture/pixel.h"
#include "worker/pixels/pixel_lattice.h"
#include "worker/render/renderer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

enum { RUNS = 5 };

enum part { PART_GRIDS, PART_SPREAD, PART_COPIES, PART_PICTURE, PART_FILE, PART_COUNT };

static double spread_s, copies_s;

// The linker gives these names to the worker's functions and to what replaces them.
bool __real_pixel_lattice_refine(struct pixel_lattice *lattice);
bool __wrap_pixel_lattice_refine(struct pixel_lattice *lattice);
void __real_pixel_lattice_give(struct pixel_lattice *lattice, const struct pixel_planes *planes);
void __wrap_pixel_lattice_give(struct pixel_lattice *lattice, const struct pixel_planes *planes);

bool __wrap_pixel_lattice_refine(struct pixel_lattice *lattice)
{
    double start = clock_read_s(CLOCK_THREAD_CPUTIME_ID);
    bool is_finer = __real_pixel_lattice_refine(lattice);

    spread_s += clock_read_s(CLOCK_THREAD_CPUTIME_ID) - start;
    return is_finer;
}

void __wrap_pixel_lattice_give(struct pixel_lattice *lattice, const struct pixel_planes *planes)
{
    double start = clock_read_s(CLOCK_THREAD_CPUTIME_ID);

    __real_pixel_lattice_give(lattice, planes);
    copies_s += clock_read_s(CLOCK_THREAD_CPUTIME_ID) - start;
}

struct bench {
    struct renderer *renderer;
    struct job job;
    int32_t frame;
    double seconds[PART_COUNT][RUNS];
    double traced;
};

static int compare(const void *a, const void *b)
{
    double one = *(const double *)a, other = *(const double *)b;

    return (one > other) - (one < other);
}

static double median_ms(double *seconds)
{
    qsort(seconds, RUNS, sizeof *seconds, compare);
    return 1e3 * seconds[RUNS / 2];
}

// `list` is NULL for the whole frame.
static bool render(struct bench *bench, struct image *image, const struct pixel *list, struct renderer_result *result,
                   struct error *error)
{
    renderer_forget(bench->renderer); // else the frame would be copied, and its grids kept
    return renderer_render(
        bench->renderer,
        &(struct renderer_frame){
            .job = &bench->job, .frame = bench->frame, .pixels = list, .pixel_count = list ? 1 : 0, .image = image},
        result, error);
}

static bool write_file(const struct bench *bench, const struct image *image, struct error *error)
{
    const struct image_exr_header header = {.compression = bench->job.output.compression,
                                            .fps_numerator = 24,
                                            .fps_denominator = 1,
                                            .job_hash = bench->job.hash,
                                            .is_checked = true};
    struct gate_result gate = {0};
    int fd = memfd_create("frame", MFD_CLOEXEC);
    bool ok =
        image_exr_write(fd, image, &header, 1, error) &&
        gate_check(
            &(struct gate_params){.fd = fd, .job = &bench->job, .picture_hash = bench->job.hash, .thread_count = 1},
            &gate, error);

    close(fd);
    return ok;
}

static bool run(struct bench *bench, int number, struct error *error)
{
    const struct pixel middle = {bench->job.width_px / 2, bench->job.height_px / 2};
    const struct job_output *output = &bench->job.output;
    struct renderer_result result = {0};
    struct image one = {0}, whole = {0};
    double start = 0.0, gridded = 0.0, drawn = 0.0, end = 0.0;
    bool ok = image_init(&one, 1, 1, output->has_depth, output->has_transmittance, error) &&
              image_init_for_job(&whole, &bench->job, error);

    start = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
    ok = ok && render(bench, &one, &middle, &result, error);
    spread_s = copies_s = 0.0;
    gridded = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
    ok = ok && render(bench, &whole, NULL, &result, error);
    drawn = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
    ok = ok && write_file(bench, &whole, error);
    end = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
    image_finish(&whole);
    image_finish(&one);
    if (!ok || number < 0) return ok;
    bench->traced = result.traced * bench->job.width_px * bench->job.height_px;
    bench->seconds[PART_GRIDS][number] = gridded - start;
    bench->seconds[PART_SPREAD][number] = spread_s;
    bench->seconds[PART_COPIES][number] = copies_s;
    bench->seconds[PART_PICTURE][number] = drawn - gridded;
    bench->seconds[PART_FILE][number] = end - drawn;
    return true;
}

static bool measure(struct bench *bench, const char *path)
{
    struct error error = {{0}};
    char *document = job_document_load(path, NULL, 0, &error);
    bool ok = document && job_document_check(path, document, "/", &bench->job, &error);
    double grids, spread, copies, picture;

    free(document);
    for (int i = -1; ok && i < RUNS; i++)
        ok = run(bench, i, &error);
    if (!ok) {
        fprintf(stderr, "%s: %s\n", path, error.message);
        return false;
    }
    grids = median_ms(bench->seconds[PART_GRIDS]);
    spread = median_ms(bench->seconds[PART_SPREAD]);
    copies = median_ms(bench->seconds[PART_COPIES]);
    picture = median_ms(bench->seconds[PART_PICTURE]);
    printf("%d %d %.0f %.2f %.2f %.2f %.2f %.2f %.2f\n", bench->job.width_px, bench->job.height_px, bench->traced,
           grids, picture - grids - spread - copies, spread, copies, picture, median_ms(bench->seconds[PART_FILE]));
    fflush(stdout);
    job_finish(&bench->job);
    return true;
}

int main(int argc, char *argv[])
{
    struct error error = {{0}};
    struct gl_context *context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
    struct bench bench = {0};
    int failures = context == NULL, first = 1;

    if (!context) fprintf(stderr, "%s\n", error.message);
    if (context) bench.renderer = renderer_create(context, NULL);
    if (argc > 2 && !strcmp(argv[1], "--frame")) {
        bench.frame = atoi(argv[2]);
        first = 3;
    }
    for (int i = first; context && i < argc; i++)
        failures += !measure(&bench, argv[i]);
    if (context) {
        renderer_destroy(bench.renderer);
        gl_context_destroy(context);
    }
    return failures > 0;
}
