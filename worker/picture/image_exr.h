// Writes and reads EXR files, with several threads that each take a chunk. Only image_exr*.c includes OpenEXRCore.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "core/job/job_beyond.h"
#include "worker/picture/audit_result.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct image;
struct json_writer;

enum {
    IMAGE_EXR_PLAN_SIZE = 320,   // bytes of the text that says how a frame's method was chosen
    IMAGE_EXR_QUALITY_SIZE = 512 // bytes of its settings as JSON
};

// Rays of a scene with reflection or refraction; see struct ray_counts.
struct image_exr_rays {
    bool is_known;
    double rays_per_pixel, cut_rays; // per pixel and sample
    double cut_share;                // of the light
    double cut_tolerance;            // the largest share that the job allows
};

// The contents of the header beside the pixels. Strings are borrowed for the call.
struct image_exr_header {
    enum job_pixel pixel;
    enum job_compression compression;
    int64_t fps_numerator, fps_denominator;
    double world_to_camera[16]; // row vectors as OpenEXR has them (p' = p M), row-major
    double world_to_ndc[16];
    const char *owner;
    // Where it was rendered, by which name of the farm, and for which farm; NULL: not written, like the next three.
    const char *host, *node, *farm;
    const char *job_name;
    const char *comment, *tags; // the user's; tags in one line, separated by ", "
    int64_t job_id;
    const char *job_hash;      // the hash of the job and of what the frame's files hold
    const char *sequence_hash; // the hash of the job alone, the same in all files of a sequence
    int32_t frame;
    int attempt;
    const char *method; // that rendered the frame
    double step;
    const char *backend, *renderer;
    int orders;   // of scattering, as in struct scene; 0 or 1: not written
    double paths; // random ones of each pixel that was traced, all followed to their end; 0: not written
    const char *shader_hash;
    double render_seconds;
    struct image_exr_rays rays;
    double traced;             // as in struct frame_accuracy; 0: not written
    struct audit_result audit; // AUDIT_NONE: not written
    double sampling_error;     // relative RMSE due to the number of samples; 0: not measured
    struct job_beyond beyond;  // what the modelled orders leave out; not known: not written
    const char *plan;          // how the method was chosen; NULL or empty: the job states it
    int64_t plan_number;       // 0: none
    const char *quality;       // the settings of a planned frame, as JSON; NULL or empty: none
    bool is_draft;             // a quick look, which promises no accuracy
    int64_t captured;          // Unix time, s
    bool is_checked;           // not written: a value that is not finite, or too large for the pixels, fails the write
};

// Writes the image to `fd` (empty, open for reading and writing) with `thread_count` compressing threads, and syncs it.
// The bytes do not depend on `thread_count`. On failure errno is the file system's error, or 0 when the cause is
// another.
bool image_exr_write(int fd, const struct image *image, const struct image_exr_header *header, int thread_count,
                     struct error *error);

// Returns a colour's value as a file with such pixels stores it.
float image_exr_stored(float value, enum job_pixel pixel);

// The header that was read; the struct has its strings.
struct image_exr_facts {
    enum job_compression compression;
    enum job_pixel pixel;
    bool has_alpha, has_depth, has_transmittance;
    int width_px, height_px;
    int64_t fps_numerator, fps_denominator; // 0: absent, or no positive number
    char job_hash[64];                      // marchd:jobHash, empty when absent
    char sequence_hash[64];                 // marchd:sequenceHash, empty when absent
    char job_name[JOB_NAME_LIMIT + 1];      // marchd:name, empty when absent
    int64_t job_id;
    int32_t frame;
    double render_seconds;
    struct image_exr_rays rays; // is_known: the file has a cut share
    double traced;              // 0: absent, or no share
    // A kind other than AUDIT_NONE: the file has an error and names what it was compared with. Other numbers that it
    // lacks are NaN.
    struct audit_result audit;
    double sampling_error;    // 0: absent
    struct job_beyond beyond; // is_known: the file has both numbers
    char method[32];
    double step;
    char plan[IMAGE_EXR_PLAN_SIZE];
    int64_t plan_number;                  // 0: absent
    char quality[IMAGE_EXR_QUALITY_SIZE]; // empty: absent
    bool is_draft;
};

// The accuracy of the file's frame, as messages state it.
struct frame_accuracy image_exr_accuracy(const struct image_exr_facts *facts);

// Reads all pixels of a file written here, or of any scanline EXR with R, G, B and perhaps A (opaque without). `image`
// may be NULL to read the header only; on failure it is empty. `facts` may be NULL.
bool image_exr_read(int fd, struct image *image, struct image_exr_facts *facts, int thread_count, struct error *error);
// Reads all pixels of such a file, keeps none, and finds whether every value of every channel is finite.
bool image_exr_scan(int fd, bool *is_finite, int thread_count, struct error *error);

enum { IMAGE_EXR_LINES_CHANNELS = 3 };

// Some channels of a file, line by line from the top: a large picture is shrunk without being held whole.
struct image_exr_lines {
    int width_px, height_px; // that the file has; another size is an error
    int first_row, row_count;
    const char *channels[IMAGE_EXR_LINES_CHANNELS]; // borrowed; NULL: no more; those that the file lacks are 0
    void (*on_line)(void *user, int row, const float *values); // a line of the first channel, then one of the second
    void *user;
};

bool image_exr_read_lines(int fd, const struct image_exr_lines *lines, struct error *error);
// Writes the header as one JSON object: size, compression, channels, and attributes by their names.
bool image_exr_describe(int fd, struct json_writer *writer, struct error *error);

// The names of a file's channels, in its order. The zero value is empty.
struct image_exr_names {
    char **names; // owned
    size_t count;
};

bool image_exr_names_read(int fd, struct image_exr_names *names, struct error *error);
void image_exr_names_finish(struct image_exr_names *names);
bool image_exr_names_have(const struct image_exr_names *names, const char *name);
