// The cost of a volume: reading it, the first frame, the next ones, and memory. Each volume has its own process.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { WIDTH = 960, HEIGHT = 540, SLAB = 8 };

static const double MIB = 1024.0 * 1024.0;

static const struct {
    int side;
    const char *type;
    size_t voxel_bytes;
} volumes[] = {{16, "uint8", 1}, {256, "uint8", 1}, {256, "float32", 4}, {512, "uint8", 1}, {512, "float32", 4}};

// Returns the peak memory of this process, bytes.
static double peak_bytes(void)
{
    FILE *status = fopen("/proc/self/status", "re");
    char line[256];
    double kib = 0.0;

    while (status && fgets(line, sizeof line, status))
        if (sscanf(line, "VmHWM: %lf kB", &kib) == 1) break;
    if (status) fclose(status);
    return 1024.0 * kib;
}

// Returns the value, 0 to 255, of a ball with ripples inside.
static void fill_slice(double *slice, int side, int k)
{
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            double x = 2.0 * (i + 0.5) / side - 1.0, y = 2.0 * (j + 0.5) / side - 1.0, z = 2.0 * (k + 0.5) / side - 1.0;
            double inside = fmax(0.95 - sqrt(x * x + y * y + z * z), 0.0);

            slice[j * side + i] = fmin(255.0, 160.0 * sqrt(inside) * (1.0 + 0.5 * sin(20.0 * x) * sin(17.0 * y + z)));
        }
}

static bool write_volume(const char *path, int side, bool is_float)
{
    FILE *file = fopen(path, "we");
    size_t count = (size_t)side * (size_t)side;
    double *slice = xmalloc(count * sizeof *slice);
    bool ok = file != NULL;

    for (int k = 0; ok && k < side; k++) {
        fill_slice(slice, side, k);
        for (size_t i = 0; ok && i < count; i++) {
            float value = (float)slice[i];
            unsigned char byte = (unsigned char)value;

            ok = fwrite(is_float ? (void *)&value : (void *)&byte, is_float ? sizeof value : 1, 1, file) == 1;
        }
    }
    free(slice);
    return file && fclose(file) == 0 && ok;
}

static bool read_alone(const char *path, double *seconds, struct error *error)
{
    struct volume *volume = NULL;
    double start = clock_now_s();
    void *slab = NULL;
    bool ok = volume_open(&volume, &(struct volume_source){.path = path}, error);

    if (ok) slab = xmalloc((size_t)volume->size[0] * (size_t)volume->size[1] * SLAB * volume_type_size(volume->type));
    while (ok && volume->next_slice < volume->size[2])
        ok = volume_read(volume, SLAB, slab, error);
    *seconds = clock_now_s() - start;
    volume_close(volume);
    free(slab);
    return ok;
}

static bool make_job(struct job *job, const char *path, struct error *error)
{
    char *text =
        xasprintf("{\"version\": 1, \"name\": \"volume\", \"frames\": \"0-9\", \"fps\": 24, \"resolution\": [%d, %d],"
                  " \"camera\": {\"position\": {\"orbit\": {\"radius\": 2, \"height\": 0.4, \"period\": 4}},"
                  " \"target\": [0, 0, 0], \"fov\": 35}, \"scene\": {\"media\": [{\"density\": {\"kind\": \"grid\","
                  " \"file\": \"%s\", \"unit_distance\": 0.02, \"transfer_function\": [[40, 0, 0, 0, 0], [90, 0.9, "
                  "0.5, 0.3, 0.2],"
                  " [255, 1, 0.9, 0.8, 0.9]]}}]}, \"quality\": {\"method\": \"midpoint\", \"step_voxels\": 0.5,"
                  " \"min_transmittance\": 0.002}, \"output\": {\"path\": \"volume.####.exr\"}}",
                  WIDTH, HEIGHT, path);
    bool ok = job_parse(job, text, strlen(text), NULL, error);

    free(text);
    return ok;
}

static bool render(struct renderer *renderer, const struct job *job, int frame, double *seconds, struct error *error)
{
    struct renderer_result result;
    struct image image = {0};
    double start = clock_now_s();
    bool ok = image_init(&image, WIDTH, HEIGHT, false, false, error) &&
              renderer_render(renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = &image}, &result,
                              error);

    *seconds = clock_now_s() - start;
    image_finish(&image);
    return ok;
}

// `folder` has both files. The small volume comes first, so that GL's own memory is not counted.
static bool measure(const char *small_path, const char *path, double volume_bytes)
{
    struct error error = {0};
    struct gl_context *context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
    struct renderer *renderer = context ? renderer_create(context, NULL) : NULL;
    struct job small = {0}, job = {0};
    double read_s = 0.0, small_s = 0.0, first_s = 0.0, next_s = 0.0, before;
    bool ok = renderer && make_job(&small, small_path, &error) && make_job(&job, path, &error) &&
              render(renderer, &small, 0, &small_s, &error);

    before = peak_bytes();
    ok = ok && render(renderer, &job, 0, &first_s, &error) && render(renderer, &job, 1, &next_s, &error);
    double grown = peak_bytes() - before;
    ok = ok && read_alone(path, &read_s, &error);
    if (ok)
        printf("%8.0f %9.3f %9.3f %9.3f %11.3f %12.2f\n", volume_bytes / MIB, read_s, first_s, next_s, first_s - next_s,
               grown / volume_bytes);
    else
        printf("%s\n", error.message);
    job_finish(&small);
    job_finish(&job);
    if (renderer) renderer_destroy(renderer);
    if (context) gl_context_destroy(context);
    return ok;
}

int main(void)
{
    const char *parent = getenv("TMPDIR");
    char *folder = xasprintf("%s/volume_bench.XXXXXX", parent ? parent : "/tmp");
    char *small_path;
    int failures = 0;

    if (!mkdtemp(folder)) return 1;
    small_path = xasprintf("%s/small_16x16x16xuint8.raw", folder);
    printf("%-14s %8s %9s %9s %9s %11s %12s\n", "volume", "MiB", "read s", "first s", "next s", "first-next",
           "memory/volume");
    for (size_t i = 0; i < sizeof volumes / sizeof volumes[0]; i++) {
        int side = volumes[i].side, status = 1;
        char *path = i == 0 ? xstrdup(small_path)
                            : xasprintf("%s/ball_%dx%dx%dx%s.raw", folder, side, side, side, volumes[i].type);
        pid_t child;

        if (!write_volume(path, side, volumes[i].voxel_bytes == 4)) return 1;
        if (i > 0) {
            printf("%4d^3 %-8s", side, volumes[i].type);
            fflush(stdout);
            child = fork();
            if (child == 0) {
                bool ok = measure(small_path, path, (double)side * side * side * (double)volumes[i].voxel_bytes);

                fflush(stdout);
                _exit(!ok);
            }
            waitpid(child, &status, 0);
            failures += status != 0;
            unlink(path);
        }
        free(path);
    }
    unlink(small_path);
    rmdir(folder);
    free(small_path);
    free(folder);
    return failures > 0;
}
