// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_png.h"

#include "core/base/error.h"
#include "core/base/file.h"

#include <png.h>
#include <stdlib.h>

typedef bool write_file(const char *path, const void *bytes, size_t size_bytes, struct error *error);

static bool write_png(png_image *png, const char *path, const unsigned char *rgb, write_file *write,
                      struct error *error)
{
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(*png);
    void *bytes = malloc(size);
    bool ok = false;

    if (!bytes)
        error_set(error, "%s: no memory for %d x %d pixels", path, (int)png->width, (int)png->height);
    else if (!png_image_write_to_memory(png, bytes, &size, 0, rgb, 0, NULL))
        error_set(error, "%s: %s", path, png->message);
    else
        ok = write(path, bytes, size, error);
    free(bytes);
    return ok;
}

static png_image describe(int width_px, int height_px, png_uint_32 flags)
{
    return (png_image){.version = PNG_IMAGE_VERSION,
                       .width = (png_uint_32)width_px,
                       .height = (png_uint_32)height_px,
                       .format = PNG_FORMAT_RGB,
                       .flags = flags};
}

bool image_png_write(const char *path, const unsigned char *rgb, int width_px, int height_px, struct error *error)
{
    png_image png = describe(width_px, height_px, 0);

    return write_png(&png, path, rgb, file_write_atomic, error);
}

bool image_png_replace(const char *path, const unsigned char *rgb, int width_px, int height_px, struct error *error)
{
    png_image png = describe(width_px, height_px, PNG_IMAGE_FLAG_FAST);

    return write_png(&png, path, rgb, file_replace, error);
}
