// The cost of encoding a frame and of the gate, per compression and thread count, in memory: exr_bench [FILE.exr].
// SPDX-License-Identifier: Apache-2.0
// Without a file the picture resembles a cloud, 1920x1080.
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/audit/gate.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { WIDTH = 1920, HEIGHT = 1080, RUNS = 5 };

// Wall clock seconds, and CPU seconds of all threads.
struct moment {
    double wall_ms, cpu_ms;
};

static double clock_ms(clockid_t clock)
{
    struct timespec now;

    clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static struct moment now(void)
{
    return (struct moment){clock_ms(CLOCK_MONOTONIC), clock_ms(CLOCK_PROCESS_CPUTIME_ID)};
}

static void keep_least(struct moment *least, struct moment start, struct moment end)
{
    least->wall_ms = fmin(least->wall_ms, end.wall_ms - start.wall_ms);
    least->cpu_ms = fmin(least->cpu_ms, end.cpu_ms - start.cpu_ms);
}

// A picture like a cloud's: black around it, smooth shading inside with structure down to the pixel.
static void paint(struct image *image)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float *pixel = image->rgba + ((size_t)y * WIDTH + (size_t)x) * 4;
            double u = (x - WIDTH / 2) / (HEIGHT * 0.4), v = (y - HEIGHT / 2) / (HEIGHT * 0.4);
            double density = 1.0 - u * u - v * v;

            for (int octave = 0; octave < 7; octave++)
                density += 0.5 / (1 << octave) * sin((3 << octave) * u + octave) * sin((3 << octave) * v - octave);
            for (int c = 0; c < 3; c++)
                pixel[c] = density > 0 ? (float)(density * (0.8 + 0.1 * c) * (1.2 + u)) : 0.0f;
            pixel[3] = density > 0 ? (float)(1.0 - exp(-4.0 * density)) : 0.0f;
        }
}

static bool measure(const struct image *image, enum job_compression compression, int thread_count)
{
    struct job job = {.width_px = image->width_px,
                      .height_px = image->height_px,
                      .output = {.has_depth = image->depth != NULL, .has_transmittance = image->transmittance != NULL},
                      .hash = "bench"};
    struct image_exr_header header = {
        .compression = compression, .fps_numerator = 24, .fps_denominator = 1, .job_hash = "bench"};
    struct gate_result result = {0};
    struct moment encode = {INFINITY, INFINITY}, gate = encode;

    for (int run = 0; run < RUNS; run++) {
        struct error error = {0};
        int fd = memfd_create("frame", MFD_CLOEXEC);
        struct moment start = now(), encoded;
        bool ok = image_exr_write(fd, image, &header, thread_count, &error);

        encoded = now();
        ok = ok &&
             gate_check(
                 &(struct gate_params){.fd = fd, .job = &job, .picture_hash = "bench", .thread_count = thread_count},
                 &result, &error);
        keep_least(&gate, encoded, now());
        keep_least(&encode, start, encoded);
        close(fd);
        if (ok) continue;
        fprintf(stderr, "%s\n", error.message);
        return false;
    }
    printf("%-11s %7d %9.1f %9.1f %8.1f %8.1f %7.2f\n", job_compression_name(compression), thread_count, encode.wall_ms,
           encode.cpu_ms, gate.wall_ms, gate.cpu_ms, (double)result.file.size_bytes / 1e6);
    return true;
}

static bool make_image(struct image *image, const char *path, struct error *error)
{
    bool ok;
    int fd;

    if (!path) {
        ok = image_init(image, WIDTH, HEIGHT, false, false, error);
        if (ok) paint(image);
        return ok;
    }
    fd = open(path, O_RDONLY | O_CLOEXEC);
    ok = image_exr_read(fd, image, NULL, 1, error);
    if (fd >= 0) close(fd);
    return ok;
}

int main(int argc, char *argv[])
{
    struct image image;
    struct error error = {0};
    bool ok = make_image(&image, argc > 1 ? argv[1] : NULL, &error);

    if (!ok) {
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    printf("%d x %d half RGBA%s%s, best of %d\n%-11s %7s %9s %9s %8s %8s %7s\n", image.width_px, image.height_px,
           image.depth ? ", Z" : "", image.transmittance ? ", transmittance" : "", RUNS, "compression", "threads",
           "encode ms", "CPU ms", "gate ms", "CPU ms", "MB");
    for (int i = JOB_COMPRESSION_NONE; i <= JOB_COMPRESSION_PIZ && ok; i++)
        for (int threads = 1; threads <= 2 && ok; threads++)
            ok = measure(&image, (enum job_compression)i, threads);
    image_finish(&image);
    return ok ? 0 : 1;
}
