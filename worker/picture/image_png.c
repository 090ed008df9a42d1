// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_png.h"

#include "core/base/error.h"
#include "core/base/file.h"

#include <png.h>
#include <stdlib.h>

bool image_png_write(const char *path, const unsigned char *rgb, int width_px, int height_px, struct error *error)
{
    png_image png = {.version = PNG_IMAGE_VERSION,
                     .width = (png_uint_32)width_px,
                     .height = (png_uint_32)height_px,
                     .format = PNG_FORMAT_RGB};
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    void *bytes = malloc(size);
    bool ok = false;

    if (!bytes)
        error_set(error, "%s: no memory for %d x %d pixels", path, width_px, height_px);
    else if (!png_image_write_to_memory(&png, bytes, &size, 0, rgb, 0, NULL))
        error_set(error, "%s: %s", path, png.message);
    else
        ok = file_write_atomic(path, bytes, size, error);
    free(bytes);
    return ok;
}
