// EXR files from outside: the module that reads our frames also reads textures.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/json/json_write.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { PIXEL_LIMIT = 1 << 16 };

// A file that is read has the size in its header; one that is refused has a reason.
static void read_image(int fd)
{
    struct image_exr_facts facts;
    struct error error = {{0}};
    struct image image;

    if (!image_exr_read(fd, NULL, &facts, 1, &error)) {
        if (!error.message[0]) abort();
        return;
    }
    if (facts.width_px < 1 || facts.height_px < 1) abort();
    if ((int64_t)facts.width_px * facts.height_px > PIXEL_LIMIT) return; // too slow
    if (!image_exr_read(fd, &image, NULL, 2, &error)) {
        if (image.rgba || !error.message[0]) abort();
        return;
    }
    if (image.width_px != facts.width_px || image.height_px != facts.height_px) abort();
    image_finish(&image);
}

static void count_line(void *user, int row, const float *values)
{
    ++*(int *)user;
}

// Every line of a file that is read arrives once, in order; a header is one JSON value.
static void read_lines(int fd)
{
    int count = 0;
    struct image_exr_lines lines = {.channels = {"B", "Z"}, .on_line = count_line, .user = &count};
    struct json_writer writer = {0};
    struct image_exr_facts facts;
    struct error error = {{0}};

    if (!image_exr_read(fd, NULL, &facts, 1, NULL)) return;
    if (!image_exr_describe(fd, &writer, NULL) || writer.text[writer.length - 1] != '}') abort();
    json_writer_finish(&writer);
    if ((int64_t)facts.width_px * facts.height_px > PIXEL_LIMIT) return;
    lines.width_px = facts.width_px;
    lines.height_px = facts.height_px;
    lines.first_row = facts.height_px / 2;
    lines.row_count = facts.height_px - lines.first_row;
    if (image_exr_read_lines(fd, &lines, &error) ? count != lines.row_count : !error.message[0]) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    int fd = memfd_create("exr", MFD_CLOEXEC);

    if (fd < 0 || write(fd, bytes, size) != (ssize_t)size) abort();
    read_image(fd);
    read_lines(fd);
    close(fd);
    return 0;
}
