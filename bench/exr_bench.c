// The cost of encoding a frame and of the gate, in memory, and of zip's steps: exr_bench [FILE.exr...].
// SPDX-License-Identifier: Apache-2.0
// Without a file the pictures resemble a cloud, and an empty sky.
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/audit/gate.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/picture/image_exr_line.h"
#include "worker/picture/image_exr_zip.h"

#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { RUNS = 9, CHUNK_LINES = 16 };

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

static int compare(const void *a, const void *b)
{
    double first = *(const double *)a, second = *(const double *)b;

    return (first > second) - (first < second);
}

static double median(double values[static RUNS])
{
    qsort(values, RUNS, sizeof *values, compare);
    return values[RUNS / 2];
}

// A picture like a cloud's: black around it, smooth shading inside with structure down to the pixel.
static void paint(struct image *image)
{
    int width = image->width_px, height = image->height_px;

    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            size_t at = (size_t)y * (size_t)width + (size_t)x;
            float *pixel = image->rgba + 4 * at;
            double u = (x - width / 2) / (height * 0.4), v = (y - height / 2) / (height * 0.4);
            double density = 1.0 - u * u - v * v;

            for (int octave = 0; octave < 7; octave++)
                density += 0.5 / (1 << octave) * sin((3 << octave) * u + octave) * sin((3 << octave) * v - octave);
            for (int c = 0; c < 3; c++)
                pixel[c] = density > 0 ? (float)(density * (0.8 + 0.1 * c) * (1.2 + u)) : 0.0f;
            pixel[3] = density > 0 ? (float)(1.0 - exp(-4.0 * density)) : 0.0f;
            for (int c = 0; c < 4 && image->transmittance; c++)
                image->transmittance[4 * at + (size_t)c] = c < 3 ? 1.0f - pixel[3] : 0.0f;
            if (image->depth) image->depth[at] = density > 0 ? (float)(2.0 - 0.3 * density) : 0.0f;
        }
}

static void paint_sky(struct image *image)
{
    memset(image->rgba, 0, 4 * (size_t)image->width_px * (size_t)image->height_px * sizeof *image->rgba);
}

static bool measure(const struct image *image, enum job_compression compression, int thread_count)
{
    struct job job = {.width_px = image->width_px,
                      .height_px = image->height_px,
                      .output = {.has_depth = image->depth != NULL, .has_transmittance = image->transmittance != NULL},
                      .hash = "bench"};
    struct image_exr_header header = {
        .compression = compression, .fps_numerator = 24, .fps_denominator = 1, .job_hash = "bench", .is_checked = true};
    struct gate_result result = {0};
    double encode_wall_ms[RUNS], encode_cpu_ms[RUNS], gate_wall_ms[RUNS], gate_cpu_ms[RUNS];

    for (int run = 0; run < RUNS; run++) {
        struct error error = {0};
        int fd = memfd_create("frame", MFD_CLOEXEC);
        struct moment start = now(), encoded, end;
        bool ok = image_exr_write(fd, image, &header, thread_count, &error);

        encoded = now();
        ok = ok &&
             gate_check(
                 &(struct gate_params){.fd = fd, .job = &job, .picture_hash = "bench", .thread_count = thread_count},
                 &result, &error);
        end = now();
        encode_wall_ms[run] = encoded.wall_ms - start.wall_ms;
        encode_cpu_ms[run] = encoded.cpu_ms - start.cpu_ms;
        gate_wall_ms[run] = end.wall_ms - encoded.wall_ms;
        gate_cpu_ms[run] = end.cpu_ms - encoded.cpu_ms;
        close(fd);
        if (ok) continue;
        fprintf(stderr, "%s\n", error.message);
        return false;
    }
    printf("%-11s %7d %9.1f %9.1f %8.1f %8.1f %7.2f\n", job_compression_name(compression), thread_count,
           median(encode_wall_ms), median(encode_cpu_ms), median(gate_wall_ms), median(gate_cpu_ms),
           (double)result.file.size_bytes / 1e6);
    return true;
}

// The chunks of a picture, as a file has them.
struct chunks {
    const struct image *image;
    struct image_exr_zip *zip; // owned, as is what follows
    char *line, *chunk, *packed;
    size_t *packed_bytes;
    size_t line_bytes, count; // chunks of CHUNK_LINES; lines that are left over are left out
    volatile uint64_t bits;   // what reading found, so that it is not optimized away
};

static void read_pixels(struct chunks *chunks)
{
    const struct image *image = chunks->image;
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    uint64_t bits = 0, pair;

    for (size_t i = 0; i < 4 * count; i += 2) {
        memcpy(&pair, image->rgba + i, sizeof pair);
        bits |= pair;
        if (!image->transmittance) continue;
        memcpy(&pair, image->transmittance + i, sizeof pair);
        bits |= pair;
    }
    chunks->bits = bits;
}

static void check_pixels(struct chunks *chunks)
{
    chunks->bits = image_is_finite(chunks->image, true, NULL);
}

static void make_lines(struct chunks *chunks)
{
    for (int y = 0; y < chunks->image->height_px; y++)
        image_exr_line_pack(chunks->image, true, y, chunks->line);
}

static void pack_chunks(struct chunks *chunks)
{
    size_t chunk_bytes = CHUNK_LINES * chunks->line_bytes;

    for (size_t i = 0; i < chunks->count; i++) {
        const void *packed;

        image_exr_zip_begin(chunks->zip, chunk_bytes);
        for (int line = 0; line < CHUNK_LINES; line++) {
            image_exr_line_pack(chunks->image, true, (int)i * CHUNK_LINES + line, chunks->line);
            image_exr_zip_add(chunks->zip, chunks->line, chunks->line_bytes);
        }
        packed = image_exr_zip_end(chunks->zip, &chunks->packed_bytes[i]);
        memcpy(chunks->packed + i * chunk_bytes, packed, chunks->packed_bytes[i]);
    }
}

static void unpack_chunks(struct chunks *chunks)
{
    size_t chunk_bytes = CHUNK_LINES * chunks->line_bytes;

    for (size_t i = 0; i < chunks->count; i++)
        if (chunks->packed_bytes[i] < chunk_bytes)
            chunks->bits = image_exr_zip_unpack(chunks->zip, chunks->packed + i * chunk_bytes, chunks->packed_bytes[i],
                                                chunks->chunk, chunk_bytes);
}

static void print_step(const char *name, struct chunks *chunks, void (*step)(struct chunks *))
{
    double cpu_ms[RUNS];

    for (int run = 0; run < RUNS; run++) {
        double start_ms = now().cpu_ms;

        step(chunks);
        cpu_ms[run] = now().cpu_ms - start_ms;
    }
    printf("  %-42s %6.1f CPU ms\n", name, median(cpu_ms));
}

static bool print_steps(const struct image *image)
{
    struct chunks chunks = {.image = image,
                            .line_bytes = image_exr_line_bytes(image, true),
                            .count = (size_t)image->height_px / CHUNK_LINES};
    size_t chunk_bytes = CHUNK_LINES * chunks.line_bytes;
    bool ok;

    chunks.zip = image_exr_zip_create(chunk_bytes);
    chunks.line = malloc(chunks.line_bytes);
    chunks.chunk = malloc(chunk_bytes);
    chunks.packed = malloc(chunks.count * chunk_bytes);
    chunks.packed_bytes = calloc(chunks.count, sizeof *chunks.packed_bytes);
    ok = chunks.zip && chunks.line && chunks.chunk && chunks.packed && chunks.packed_bytes;
    if (ok) {
        print_step("reading its colours once", &chunks, read_pixels);
        print_step("the check of all values by itself", &chunks, check_pixels);
        print_step("lines of halves", &chunks, make_lines);
        print_step("lines of halves, filtered and packed", &chunks, pack_chunks);
        print_step("unpacked and joined", &chunks, unpack_chunks);
    }
    image_exr_zip_destroy(chunks.zip);
    free(chunks.line);
    free(chunks.chunk);
    free(chunks.packed);
    free(chunks.packed_bytes);
    return ok;
}

static bool print_picture(const struct image *image, const char *name, bool is_zip_alone)
{
    bool ok = true;

    printf("%s, %d x %d half RGBA%s%s, median of %d\n%-11s %7s %9s %9s %8s %8s %7s\n", name, image->width_px,
           image->height_px, image->depth ? ", Z" : "", image->transmittance ? ", transmittance" : "", RUNS,
           "compression", "threads", "encode ms", "CPU ms", "gate ms", "CPU ms", "MB");
    for (int i = JOB_COMPRESSION_NONE; i <= JOB_COMPRESSION_PIZ && ok; i++)
        for (int threads = 1; threads <= 2 && ok; threads++)
            if (i == JOB_COMPRESSION_ZIP || !is_zip_alone) ok = measure(image, (enum job_compression)i, threads);
    return ok && print_steps(image);
}

static bool print_file(const char *path, struct error *error)
{
    struct image image;
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    bool ok = image_exr_read(fd, &image, NULL, 1, error);

    if (fd >= 0) close(fd);
    ok = ok && print_picture(&image, path, true);
    image_finish(&image);
    return ok;
}

static bool print_painted(struct error *error)
{
    static const struct {
        const char *name;
        int width_px, height_px;
        bool has_all, is_zip_alone;
        void (*paint)(struct image *image);
    } pictures[] = {
        {"cloud", 1920, 1080, false, false, paint},  {"cloud", 1920, 1080, true, true, paint},
        {"cloud", 3840, 2160, false, true, paint},   {"cloud", 3840, 2160, true, true, paint},
        {"sky", 1920, 1080, false, true, paint_sky},
    };
    bool ok = true;

    for (size_t i = 0; i < sizeof pictures / sizeof pictures[0] && ok; i++) {
        struct image image;

        if (!image_init(&image, pictures[i].width_px, pictures[i].height_px, pictures[i].has_all, pictures[i].has_all,
                        error))
            return false;
        pictures[i].paint(&image);
        ok = print_picture(&image, pictures[i].name, pictures[i].is_zip_alone);
        image_finish(&image);
    }
    return ok;
}

int main(int argc, char *argv[])
{
    struct error error = {0};
    bool ok = argc > 1 || print_painted(&error);

    for (int i = 1; i < argc && ok; i++)
        ok = print_file(argv[i], &error);
    if (!ok) fprintf(stderr, "%s\n", error.message);
    return ok ? 0 : 1;
}
