// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_png_read.h"

#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/srgb.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// All that changes between setjmp and longjmp is in this struct.
struct reader {
    int fd;
    off_t offset;
    png_structp png;
    png_infop info;
    char message[128]; // the library's error
    int width_px, height_px, bits, channels;
    bool has_palette;
    unsigned char *raw; // owned; the stored values, 16-bit ones with the high byte first
    size_t row_bytes;
    png_bytep *rows; // owned; into `raw`
    png_colorp palette;
    int palette_count;
};

static void on_error(png_structp png, png_const_charp message)
{
    struct reader *reader = png_get_error_ptr(png);

    snprintf(reader->message, sizeof reader->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png, (void)message;
}

static void on_read(png_structp png, png_bytep bytes, size_t size)
{
    struct reader *reader = png_get_io_ptr(png);
    size_t done = 0;

    while (done < size) {
        ssize_t count = pread(reader->fd, bytes + done, size - done, reader->offset);

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) png_error(png, "it cannot be read");
        if (count == 0) png_error(png, "the file ends too soon");
        done += (size_t)count;
        reader->offset += count;
    }
}

// Checks the size before the library allocates a row.
static void check_size(struct reader *reader)
{
    png_uint_32 width = png_get_image_width(reader->png, reader->info);
    png_uint_32 height = png_get_image_height(reader->png, reader->info);
    char message[sizeof reader->message];

    if (width <= IMAGE_SIDE_LIMIT && height <= IMAGE_SIDE_LIMIT) return;
    snprintf(message, sizeof message, "expected sides of at most %d pixels, got %u x %u", IMAGE_SIDE_LIMIT,
             (unsigned)width, (unsigned)height);
    png_error(reader->png, message);
}

static void read_header(struct reader *reader)
{
    png_structp png = reader->png;

    png_read_info(png, reader->info);
    check_size(reader);
    reader->width_px = (int)png_get_image_width(png, reader->info);
    reader->height_px = (int)png_get_image_height(png, reader->info);
    reader->bits = png_get_bit_depth(png, reader->info);
    reader->channels = png_get_channels(png, reader->info);
    reader->has_palette = png_get_color_type(png, reader->info) == PNG_COLOR_TYPE_PALETTE;
    if (reader->has_palette) png_get_PLTE(png, reader->info, &reader->palette, &reader->palette_count);
    png_set_packing(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, reader->info);
    reader->row_bytes = png_get_rowbytes(png, reader->info);
}

static void read_rows(struct reader *reader)
{
    png_read_image(reader->png, reader->rows);
    png_read_end(reader->png, NULL);
}

static bool run(struct reader *reader, void (*step)(struct reader *reader), struct error *error)
{
    if (setjmp(png_jmpbuf(reader->png))) {
        error_set(error, "PNG: %s", reader->message);
        return false;
    }
    step(reader);
    return true;
}

static bool open_file(struct reader *reader, struct error *error)
{
    reader->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, reader, on_error, on_warning);
    if (reader->png) reader->info = png_create_info_struct(reader->png);
    if (!reader->info) {
        error_set(error, "PNG: out of memory");
        return false;
    }
    png_set_read_fn(reader->png, reader, on_read);
    png_set_user_limits(reader->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); // so that the message is ours
    // Texts and profiles are not used, and unpacked they could take gigabytes.
    png_set_keep_unknown_chunks(reader->png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    return run(reader, read_header, error);
}

static bool read_raw(struct reader *reader, struct error *error)
{
    size_t height = (size_t)reader->height_px;

    reader->raw = malloc(height * reader->row_bytes);
    reader->rows = malloc(height * sizeof *reader->rows);
    if (!reader->raw || !reader->rows) {
        error_set(error, "PNG: no memory for %d x %d pixels", reader->width_px, reader->height_px);
        return false;
    }
    for (size_t y = 0; y < height; y++)
        reader->rows[y] = reader->raw + y * reader->row_bytes;
    return run(reader, read_rows, error);
}

// Makes the table of linear light by stored value. The caller owns it; NULL: no memory.
static float *make_table(int bits, bool is_linear)
{
    size_t count = (size_t)1 << bits;
    float *table = malloc(count * sizeof *table);

    for (size_t i = 0; table && i < count; i++) {
        double value = (double)i / (double)(count - 1);

        table[i] = (float)(is_linear ? value : srgb_decode(value));
    }
    return table;
}

static bool look_up(const struct reader *reader, const float *table, struct image *image, struct error *error)
{
    size_t width = (size_t)reader->width_px, count = width * (size_t)reader->height_px;

    for (size_t i = 0; i < count; i++) {
        int index = reader->rows[i / width][i % width];
        float *pixel = image->rgba + i * 4;

        if (index >= reader->palette_count) {
            error_set(error, "PNG: pixel (%zu, %zu) has colour %d of a palette of %d", i % width, i / width, index,
                      reader->palette_count);
            return false;
        }
        pixel[0] = table[reader->palette[index].red];
        pixel[1] = table[reader->palette[index].green];
        pixel[2] = table[reader->palette[index].blue];
        pixel[3] = 1.0f;
    }
    return true;
}

static void convert(const struct reader *reader, const float *table, struct image *image)
{
    size_t width = (size_t)reader->width_px, count = width * (size_t)reader->height_px;
    size_t bytes = reader->bits == 16 ? 2 : 1, stride = bytes * (size_t)reader->channels;
    size_t step = reader->channels >= 3 ? bytes : 0; // 0 for grey: all three are its one value

    for (size_t i = 0; i < count; i++) {
        const unsigned char *values = reader->rows[i / width] + i % width * stride;
        float *pixel = image->rgba + i * 4;

        for (size_t c = 0; c < 3; c++) {
            const unsigned char *value = values + c * step;

            pixel[c] = table[bytes == 2 ? value[0] << 8 | value[1] : value[0]];
        }
        pixel[3] = 1.0f;
    }
}

static bool read_pixels(struct reader *reader, bool is_linear, struct image *image, struct error *error)
{
    float *table = make_table(reader->has_palette ? 8 : reader->bits, is_linear); // a palette's colours have 8 bits
    bool ok = false;

    if (!table) {
        error_set(error, "PNG: out of memory");
        return false;
    }
    if (!image_init(image, reader->width_px, reader->height_px, false, false, error)) goto out;
    if (!read_raw(reader, error)) goto out;
    ok = true;
    if (reader->has_palette)
        ok = look_up(reader, table, image, error);
    else
        convert(reader, table, image);
out:
    if (!ok) image_finish(image);
    free(table);
    return ok;
}

bool image_png_read(int fd, bool is_linear, struct image *image, struct image_png_facts *facts, struct error *error)
{
    struct reader reader = {.fd = fd};
    bool ok;

    if (image) *image = (struct image){0};
    ok = open_file(&reader, error) && (!image || read_pixels(&reader, is_linear, image, error));
    if (ok && facts) *facts = (struct image_png_facts){reader.width_px, reader.height_px, reader.bits};
    png_destroy_read_struct(&reader.png, &reader.info, NULL);
    free(reader.raw);
    free(reader.rows);
    return ok;
}
