// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/texture_image.h"

#include "core/base/error.h"
#include "core/scene/file_format.h"
#include "core/scene/scene.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/picture/image_png_read.h"
#include "worker/picture/srgb.h"
#include "worker/volume/volume_memory.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    READER_THREADS = 4,
    PIXEL_BYTES = 8 + 2 * 4 * sizeof(float) // at most: in the file's own form, in memory and in GL
};

// Files are told apart by their first bytes, whatever their names.
struct format {
    const char *magic;
    size_t magic_bytes; // at most MAGIC_LIMIT
    bool (*find_size)(int fd, int *width_px, int *height_px, struct error *error);
    bool (*read)(int fd, const struct scene_texture *texture, struct image *image, struct error *error);
};

enum { MAGIC_LIMIT = 8 };

static bool find_exr_size(int fd, int *width_px, int *height_px, struct error *error)
{
    struct image_exr_facts facts;

    if (!image_exr_read(fd, NULL, &facts, 1, error)) return false;
    *width_px = facts.width_px;
    *height_px = facts.height_px;
    return true;
}

static bool find_png_size(int fd, int *width_px, int *height_px, struct error *error)
{
    struct image_png_facts facts;

    if (!image_png_read(fd, true, NULL, &facts, error)) return false;
    *width_px = facts.width_px;
    *height_px = facts.height_px;
    return true;
}

static void tell_value(const struct image *image, size_t pixel, size_t channel, double limit, struct error *error)
{
    float value = image->rgba[4 * pixel + channel];
    size_t width = (size_t)image->width_px;

    error_set(error, "channel %c at pixel (%zu, %zu) is %g: expected a value in [0, %.10g]", "RGB"[channel],
              pixel % width, pixel / width, (double)value, limit);
}

// NaN is in no interval.
static bool check_values(const struct image *image, double limit, struct error *error)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;

    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++) {
            float value = image->rgba[4 * i + c];

            if (value >= 0.0f && (double)value <= limit) continue;
            tell_value(image, i, c, limit, error);
            return false;
        }
    return true;
}

static void decode(struct image *image)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;

    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++)
            image->rgba[4 * i + c] = (float)srgb_decode((double)image->rgba[4 * i + c]);
}

static bool read_exr(int fd, const struct scene_texture *texture, struct image *image, struct error *error)
{
    double limit = texture->is_radiance ? SCENE_IMAGE_RADIANCE_LIMIT : 1.0;

    if (!image_exr_read(fd, image, NULL, READER_THREADS, error)) return false;
    if (!check_values(image, limit, error)) {
        image_finish(image);
        return false;
    }
    if (!texture->is_linear) decode(image);
    return true;
}

static bool read_png(int fd, const struct scene_texture *texture, struct image *image, struct error *error)
{
    return image_png_read(fd, texture->is_linear, image, NULL, error);
}

// Each format with FILE_IMAGE in core/scene/file_format.c is a row.
static const struct format formats[] = {
    {"\x89PNG\r\n\x1a\n", 8, find_png_size, read_png},
    {"\x76\x2f\x31\x01", 4, find_exr_size, read_exr},
};

enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

// NULL on failure.
static const struct format *find_format(int fd, struct error *error)
{
    char bytes[MAGIC_LIMIT] = {0}, *endings;

    if (pread(fd, bytes, sizeof bytes, 0) < 0) {
        error_set_errno(error, errno, "it cannot be read");
        return NULL;
    }
    for (size_t i = 0; i < FORMAT_COUNT; ++i)
        if (memcmp(bytes, formats[i].magic, formats[i].magic_bytes) == 0) return &formats[i];
    endings = file_format_list_endings(FILE_IMAGE, "or");
    error_set(error, "expected the contents of a %s file", endings);
    free(endings);
    return NULL;
}

static bool read_image(int fd, struct image *image, const struct scene_texture *texture, struct error *error)
{
    const struct format *format = find_format(fd, error);
    int width_px, height_px;

    if (!format || !format->find_size(fd, &width_px, &height_px, error)) return false;
    if (!volume_memory_check((int64_t)width_px * height_px * PIXEL_BYTES, volume_memory_limit(), error)) return false;
    return format->read(fd, texture, image, error);
}

static int open_file(const char *path, struct error *error)
{
    struct stat status;
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);

    if (fd < 0) {
        error_set_errno(error, errno, "%s", path);
        return -1;
    }
    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) return fd;
    error_set(error, "%s: expected a regular file", path);
    close(fd);
    return -1;
}

bool texture_image_find_size(const char *path, int *width_px, int *height_px, struct error *error)
{
    int fd = open_file(path, error);
    const struct format *format;
    bool ok;

    if (fd < 0) return false;
    format = find_format(fd, error);
    ok = format && format->find_size(fd, width_px, height_px, error);
    if (!ok) error_prefix(error, "%s", path);
    close(fd);
    return ok;
}

bool texture_image_load(struct image *image, const struct scene_texture *texture, struct error *error)
{
    int fd = open_file(texture->file, error);
    bool ok;

    *image = (struct image){0};
    if (fd < 0) return false;
    ok = read_image(fd, image, texture, error);
    if (!ok) error_prefix(error, "%s", texture->file);
    close(fd);
    return ok;
}
