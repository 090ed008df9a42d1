// Checksums of all chunks are corrected first, because a fuzzer does not find them.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_png_read.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { SIGNATURE_BYTES = 8, CHUNK_BYTES = 12, PIXEL_LIMIT = 1 << 20 };

static void put_sums(uint8_t *bytes, size_t size)
{
    for (size_t at = SIGNATURE_BYTES; at + CHUNK_BYTES <= size;) {
        size_t length =
            (size_t)bytes[at] << 24 | (size_t)bytes[at + 1] << 16 | (size_t)bytes[at + 2] << 8 | bytes[at + 3];
        unsigned long sum;

        if (length > size - at - CHUNK_BYTES) return;
        sum = crc32(0, bytes + at + 4, (uInt)length + 4);
        for (int i = 0; i < 4; i++)
            bytes[at + 8 + length + (size_t)i] = (uint8_t)(sum >> (24 - 8 * i));
        at += CHUNK_BYTES + length;
    }
}

// A file that is read has values in [0, 1] only; one that is refused has a reason.
static void read_image(int fd)
{
    struct image_png_facts facts;
    struct error error = {{0}};
    struct image image;

    if (!image_png_read(fd, false, NULL, &facts, &error)) {
        if (strncmp(error.message, "PNG: ", 5) != 0) abort();
        return;
    }
    if ((int64_t)facts.width_px * facts.height_px > PIXEL_LIMIT) return; // too slow
    if (!image_png_read(fd, false, &image, NULL, &error)) {
        if (image.rgba || !error.message[0]) abort();
        return;
    }
    for (size_t i = 0; i < (size_t)image.width_px * (size_t)image.height_px * 4; i++)
        if (!(image.rgba[i] >= 0 && image.rgba[i] <= 1)) abort();
    image_finish(&image);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    uint8_t *copy = malloc(size + 1);
    int fd = memfd_create("png", MFD_CLOEXEC);

    if (!copy || fd < 0) abort();
    memcpy(copy, bytes, size);
    put_sums(copy, size);
    if (write(fd, copy, size) != (ssize_t)size) abort();
    read_image(fd);
    close(fd);
    free(copy);
    return 0;
}
