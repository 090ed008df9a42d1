// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr_attributes.h"
#include "worker/picture/image_exr_json.h"
#include "worker/picture/image_exr_source.h"
#include "worker/picture/image_exr_zip.h"

#define IMATH_HALF_NO_LOOKUP_TABLE
#include <Imath/half.h>
#include <OpenEXR/openexr.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum {
    THREAD_LIMIT = 64,
    FILE_CHANNEL_LIMIT = 256 // more than any renderer writes; a damaged header could ask for gigabytes
};

struct reader {
    struct image_exr_source source;
    exr_attr_box2i_t window;
    int lines_per_chunk, line_count;
    uint64_t chunk_bytes; // unpacked, at most

    pthread_mutex_t lock; // guards all that follows
    int next_line;
    bool is_spoilt; // a value that is not kept is not finite
    bool failed;
    struct error error; // the error of the first chunk that failed
};

static bool check_channels(struct reader *reader, const exr_attr_chlist_t *channels, struct error *error)
{
    int needed = 0;

    if (channels->num_channels > FILE_CHANNEL_LIMIT) {
        error_set(error, "expected at most %d channels, got %d", FILE_CHANNEL_LIMIT, channels->num_channels);
        return false;
    }
    for (int i = 0; i < channels->num_channels; i++) {
        const exr_attr_chlist_entry_t *channel = &channels->entries[i];

        if (channel->x_sampling != 1 || channel->y_sampling != 1) {
            error_set(error, "channel %s: expected a value for every pixel, got one for %d x %d", channel->name.str,
                      channel->x_sampling, channel->y_sampling);
            return false;
        }
        needed += !strcmp(channel->name.str, "R") || !strcmp(channel->name.str, "G") || !strcmp(channel->name.str, "B");
    }
    if (needed == 3) return true;
    error_set(error, "expected channels R, G and B");
    return false;
}

static bool has_channel(const exr_attr_chlist_t *channels, const char *name)
{
    for (int i = 0; i < channels->num_channels; i++)
        if (!strcmp(channels->entries[i].name.str, name)) return true;
    return false;
}

static bool read_compression(struct reader *reader, enum job_compression *compression, struct error *error)
{
    exr_compression_t found;
    exr_result_t result = exr_get_compression(reader->source.context, 0, &found);

    if (result) return image_exr_source_fail(&reader->source, result, error);
    switch (found) {
    case EXR_COMPRESSION_NONE:
        *compression = JOB_COMPRESSION_NONE;
        return true;
    case EXR_COMPRESSION_RLE:
        *compression = JOB_COMPRESSION_RLE;
        return true;
    case EXR_COMPRESSION_ZIPS:
        *compression = JOB_COMPRESSION_ZIPS;
        return true;
    case EXR_COMPRESSION_ZIP:
        *compression = JOB_COMPRESSION_ZIP;
        return true;
    case EXR_COMPRESSION_PIZ:
        *compression = JOB_COMPRESSION_PIZ;
        return true;
    default:
        error_set(error, "expected compression none, rle, zips, zip or piz");
        return false;
    }
}

static bool read_header(struct reader *reader, struct image_exr_facts *facts, struct error *error)
{
    const exr_attr_chlist_t *channels;
    exr_storage_t storage;
    exr_result_t result = exr_get_storage(reader->source.context, 0, &storage);

    if (result) return image_exr_source_fail(&reader->source, result, error);
    if (storage != EXR_STORAGE_SCANLINE) {
        error_set(error, "expected scanlines, got tiles or deep pixels");
        return false;
    }
    result = exr_get_data_window(reader->source.context, 0, &reader->window);
    if (!result) result = exr_get_channels(reader->source.context, 0, &channels);
    if (!result) result = exr_get_scanlines_per_chunk(reader->source.context, 0, &reader->lines_per_chunk);
    if (!result) result = exr_get_chunk_unpacked_size(reader->source.context, 0, &reader->chunk_bytes);
    if (result) return image_exr_source_fail(&reader->source, result, error);
    facts->width_px = (int)((int64_t)reader->window.max.x - reader->window.min.x + 1);
    facts->height_px = (int)((int64_t)reader->window.max.y - reader->window.min.y + 1);
    if (!check_channels(reader, channels, error)) return false;
    if (!read_compression(reader, &facts->compression, error)) return false;
    facts->pixel = JOB_PIXEL_HALF;
    for (int i = 0; i < channels->num_channels; i++)
        if (strcmp(channels->entries[i].name.str, "Z") != 0 && channels->entries[i].pixel_type != EXR_PIXEL_HALF)
            facts->pixel = JOB_PIXEL_FLOAT;
    facts->has_depth = has_channel(channels, "Z");
    facts->has_transmittance = has_channel(channels, "transmittance.R") && has_channel(channels, "transmittance.G") &&
                               has_channel(channels, "transmittance.B");
    facts->has_alpha = has_channel(channels, "A");
    image_exr_attributes_read(reader->source.context, facts);
    return true;
}

// Returns the destination of a channel's values; NULL when they are not kept.
static float *find_plane(const struct image *image, const char *name, size_t *stride)
{
    static const char *const rgba[] = {"R", "G", "B", "A"};
    static const char *const transmittance[] = {"transmittance.R", "transmittance.G", "transmittance.B"};

    *stride = 4;
    for (int i = 0; i < 4; i++)
        if (!strcmp(name, rgba[i])) return image->rgba + i;
    for (int i = 0; i < 3 && image->transmittance; i++)
        if (!strcmp(name, transmittance[i])) return image->transmittance + i;
    *stride = 1;
    return strcmp(name, "Z") ? NULL : image->depth;
}

static void unpack_values(float *values, size_t stride, const char *packed, size_t count, uint16_t type)
{
    for (size_t x = 0; x < count; x++) {
        uint32_t integer;
        uint16_t half;

        if (type == EXR_PIXEL_HALF) {
            memcpy(&half, packed + x * sizeof half, sizeof half);
            values[x * stride] = imath_half_to_float(half);
        } else if (type == EXR_PIXEL_FLOAT) {
            memcpy(values + x * stride, packed + x * sizeof(float), sizeof(float));
        } else {
            memcpy(&integer, packed + x * sizeof integer, sizeof integer);
            values[x * stride] = (float)integer;
        }
    }
}

// The state of one thread that reads chunks.
struct decoder {
    exr_decode_pipeline_t pipeline;
    struct reader *reader;
    const struct image *image;                           // NULL: values are not kept
    const struct image_exr_lines *lines;                 // NULL: nobody asks for lines; else `image` is, too
    float *values;                                       // borrowed; of the line that is unpacked
    struct image_exr_zip *zip;                           // owned; NULL until something is unpacked
    exr_result_t (*decompress)(exr_decode_pipeline_t *); // the library's
    bool is_spoilt;                                      // a value was not finite
};

// A chunk that compression does not make smaller is stored as it is; the library finds such chunks.
static exr_result_t on_decompress(exr_decode_pipeline_t *pipeline)
{
    struct decoder *decoder = pipeline->decoding_user_data;
    size_t size_bytes = pipeline->chunk.unpacked_size;

    if (pipeline->chunk.packed_size >= size_bytes) return decoder->decompress(pipeline);
    if (!decoder->zip) decoder->zip = image_exr_zip_create(decoder->reader->chunk_bytes);
    if (!decoder->zip) return EXR_ERR_OUT_OF_MEMORY;
    if (pipeline->unpacked_alloc_size < size_bytes) {
        if (pipeline->unpacked_alloc_size > 0) free(pipeline->unpacked_buffer);
        pipeline->unpacked_alloc_size = 0;
        pipeline->unpacked_buffer = malloc(size_bytes);
        if (!pipeline->unpacked_buffer) return EXR_ERR_OUT_OF_MEMORY;
        pipeline->unpacked_alloc_size = size_bytes;
    }
    if (image_exr_zip_unpack(decoder->zip, pipeline->packed_buffer, pipeline->chunk.packed_size,
                             pipeline->unpacked_buffer, size_bytes))
        return EXR_ERR_SUCCESS;
    return EXR_ERR_CORRUPT_CHUNK;
}

// Has no early exit, so that it vectorizes. Integers are always finite.
static bool has_spoilt(const char *packed, size_t count, uint16_t type)
{
    uint32_t worst = 0;
    uint16_t worst_half = 0;

    if (type == EXR_PIXEL_HALF) {
        for (size_t x = 0; x < count; x++) {
            uint16_t half;

            memcpy(&half, packed + x * sizeof half, sizeof half);
            half &= 0x7c00;
            worst_half = half > worst_half ? half : worst_half;
        }
    } else if (type == EXR_PIXEL_FLOAT) {
        for (size_t x = 0; x < count; x++) {
            uint32_t bits;

            memcpy(&bits, packed + x * sizeof bits, sizeof bits);
            bits &= 0x7f800000;
            worst = bits > worst ? bits : worst;
        }
    }
    return worst_half == 0x7c00 || worst == 0x7f800000;
}

static void take_wanted(struct decoder *decoder, const exr_coding_channel_info_t *channel, size_t width,
                        const char *packed)
{
    const struct image_exr_lines *lines = decoder->lines;

    for (size_t i = 0; i < IMAGE_EXR_LINES_CHANNELS && lines->channels[i]; i++)
        if (!strcmp(lines->channels[i], channel->channel_name))
            unpack_values(decoder->values + i * width, 1, packed, width, channel->data_type);
}

static bool is_wanted(const struct image_exr_lines *lines, size_t y)
{
    return y >= (size_t)lines->first_row && y < (size_t)lines->first_row + (size_t)lines->row_count;
}

static void take_line(struct decoder *decoder, const exr_coding_channel_info_t *channel, size_t y, size_t width,
                      const char *packed)
{
    size_t stride;
    float *plane;

    if (decoder->lines) {
        take_wanted(decoder, channel, width, packed);
        return;
    }
    if (!decoder->image) {
        decoder->is_spoilt |= has_spoilt(packed, width, channel->data_type);
        return;
    }
    plane = find_plane(decoder->image, channel->channel_name, &stride);
    if (plane) unpack_values(plane + y * width * stride, stride, packed, width, channel->data_type);
}

// The library's own unpacking cannot leave out a channel of an uncompressed file.
static exr_result_t on_unpack(exr_decode_pipeline_t *pipeline)
{
    struct decoder *decoder = pipeline->decoding_user_data;
    const exr_attr_box2i_t *window = &decoder->reader->window;
    const char *packed = pipeline->unpacked_buffer;
    size_t width = (size_t)((int64_t)window->max.x - window->min.x + 1);
    uint64_t line_bytes = 0;

    for (int i = 0; i < pipeline->channel_count; i++)
        line_bytes += width * (uint64_t)pipeline->channels[i].bytes_per_element;
    if (!packed || line_bytes * (uint64_t)pipeline->chunk.height != pipeline->chunk.unpacked_size)
        return EXR_ERR_CORRUPT_CHUNK;
    for (int line = 0; line < pipeline->chunk.height; line++) {
        size_t y = (size_t)((int64_t)pipeline->chunk.start_y - window->min.y + line);

        for (int i = 0; i < pipeline->channel_count; i++) {
            const exr_coding_channel_info_t *channel = &pipeline->channels[i];

            take_line(decoder, channel, y, width, packed);
            packed += width * (size_t)channel->bytes_per_element;
        }
        if (decoder->lines && is_wanted(decoder->lines, y))
            decoder->lines->on_line(decoder->lines->user, (int)y, decoder->values);
    }
    return EXR_ERR_SUCCESS;
}

static exr_result_t read_chunk(struct decoder *decoder, int y)
{
    struct reader *reader = decoder->reader;
    exr_decode_pipeline_t *pipeline = &decoder->pipeline;
    exr_chunk_info_t chunk;
    exr_result_t result = exr_read_scanline_chunk_info(reader->source.context, 0, y, &chunk);

    if (result) return result;
    // An uncompressed chunk is used as it was read, so all its bytes must be there.
    if (chunk.compression == EXR_COMPRESSION_NONE && chunk.packed_size != chunk.unpacked_size)
        return EXR_ERR_CORRUPT_CHUNK;
    if (pipeline->context) {
        result = exr_decoding_update(reader->source.context, 0, &chunk, pipeline);
    } else {
        result = exr_decoding_initialize(reader->source.context, 0, &chunk, pipeline);
        if (!result) result = exr_decoding_choose_default_routines(reader->source.context, 0, pipeline);
        pipeline->decoding_user_data = decoder;
        pipeline->unpack_and_convert_fn = on_unpack;
        decoder->decompress = pipeline->decompress_fn;
        if (chunk.compression == EXR_COMPRESSION_ZIP || chunk.compression == EXR_COMPRESSION_ZIPS)
            pipeline->decompress_fn = on_decompress;
    }
    return result ? result : exr_decoding_run(reader->source.context, 0, pipeline);
}

struct chunk_task {
    struct reader *reader;
    const struct image *image;
    const struct image_exr_lines *lines;
    float *values; // as in struct decoder
};

static void *read_chunks(void *user)
{
    const struct chunk_task *task = user;
    struct reader *reader = task->reader;
    struct decoder decoder = {.reader = reader, .image = task->image, .lines = task->lines, .values = task->values};

    pthread_mutex_lock(&reader->lock);
    while (!reader->failed && reader->next_line < reader->line_count) {
        int line = reader->next_line;
        exr_result_t result;

        reader->next_line += reader->lines_per_chunk;
        pthread_mutex_unlock(&reader->lock);
        result = read_chunk(&decoder, reader->window.min.y + line);
        pthread_mutex_lock(&reader->lock);
        if (!result || reader->failed) continue;
        reader->failed = true;
        image_exr_source_fail(&reader->source, result, &reader->error);
        error_prefix(&reader->error, "line %d", line);
    }
    if (decoder.is_spoilt) reader->is_spoilt = true;
    pthread_mutex_unlock(&reader->lock);
    if (decoder.pipeline.context) exr_decoding_destroy(reader->source.context, &decoder.pipeline);
    image_exr_zip_destroy(decoder.zip);
    return NULL;
}

// `image` is that of struct decoder.
static void read_all_chunks(struct reader *reader, const struct image *image, int thread_count)
{
    struct chunk_task task = {.reader = reader, .image = image};
    pthread_t threads[THREAD_LIMIT];
    int started = 0;

    reader->line_count = (int)((int64_t)reader->window.max.y - reader->window.min.y + 1);
    if (thread_count > THREAD_LIMIT) thread_count = THREAD_LIMIT;
    while (started < thread_count - 1 && !pthread_create(&threads[started], NULL, read_chunks, &task))
        started++;
    read_chunks(&task);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
}

static bool read_pixels(struct reader *reader, const struct image_exr_facts *facts, struct image *image,
                        int thread_count, struct error *error)
{
    if (!image_init(image, facts->width_px, facts->height_px, facts->has_depth, facts->has_transmittance, error))
        return false;
    if (!facts->has_alpha)
        for (size_t i = 0; i < (size_t)image->width_px * (size_t)image->height_px; i++)
            image->rgba[i * 4 + 3] = 1.0f;
    read_all_chunks(reader, image, thread_count);
    if (!reader->failed) return true;
    error_set(error, "%s", reader->error.message);
    image_finish(image);
    return false;
}

bool image_exr_read(int fd, struct image *image, struct image_exr_facts *facts, int thread_count, struct error *error)
{
    struct reader reader = {0};
    struct image_exr_facts found = {0};
    bool ok;

    pthread_mutex_init(&reader.lock, NULL);
    if (image) *image = (struct image){0};
    ok = image_exr_source_open(&reader.source, fd, error) && read_header(&reader, &found, error) &&
         (!image || read_pixels(&reader, &found, image, thread_count, error));
    image_exr_source_close(&reader.source);
    pthread_mutex_destroy(&reader.lock);
    if (ok && facts) *facts = found;
    return ok;
}

bool image_exr_scan(int fd, bool *is_finite, int thread_count, struct error *error)
{
    struct reader reader = {0};
    struct image_exr_facts facts = {0};
    bool ok;

    pthread_mutex_init(&reader.lock, NULL);
    ok = image_exr_source_open(&reader.source, fd, error) && read_header(&reader, &facts, error);
    if (ok) {
        read_all_chunks(&reader, NULL, thread_count);
        ok = !reader.failed;
        if (!ok) error_set(error, "%s", reader.error.message);
    }
    *is_finite = ok && !reader.is_spoilt;
    image_exr_source_close(&reader.source);
    pthread_mutex_destroy(&reader.lock);
    return ok;
}

static bool read_lines(struct reader *reader, const struct image_exr_facts *facts, const struct image_exr_lines *lines,
                       struct error *error)
{
    struct chunk_task task = {.reader = reader, .lines = lines};

    if (lines->width_px < 1 || facts->width_px != lines->width_px || facts->height_px != lines->height_px) {
        error_set(error, "it changed while it was read");
        return false;
    }
    task.values = calloc((size_t)lines->width_px * IMAGE_EXR_LINES_CHANNELS, sizeof *task.values);
    if (!task.values) {
        error_set(error, "no memory for a line of %d pixels", lines->width_px);
        return false;
    }
    reader->next_line = lines->first_row - lines->first_row % reader->lines_per_chunk;
    reader->line_count = lines->first_row + lines->row_count;
    read_chunks(&task);
    free(task.values);
    if (reader->failed) error_set(error, "%s", reader->error.message);
    return !reader->failed;
}

bool image_exr_read_lines(int fd, const struct image_exr_lines *lines, struct error *error)
{
    struct reader reader = {0};
    struct image_exr_facts facts = {0};
    bool ok;

    pthread_mutex_init(&reader.lock, NULL);
    ok = image_exr_source_open(&reader.source, fd, error) && read_header(&reader, &facts, error) &&
         read_lines(&reader, &facts, lines, error);
    image_exr_source_close(&reader.source);
    pthread_mutex_destroy(&reader.lock);
    return ok;
}

bool image_exr_describe(int fd, struct json_writer *writer, struct error *error)
{
    struct reader reader = {0};
    struct image_exr_facts facts = {0};
    bool ok;

    pthread_mutex_init(&reader.lock, NULL);
    ok = image_exr_source_open(&reader.source, fd, error) && read_header(&reader, &facts, error);
    if (ok) image_exr_json_write(reader.source.context, &facts, writer);
    image_exr_source_close(&reader.source);
    pthread_mutex_destroy(&reader.lock);
    return ok;
}

bool image_exr_names_read(int fd, struct image_exr_names *names, struct error *error)
{
    struct reader reader = {0};
    struct image_exr_facts facts = {0};
    const exr_attr_chlist_t *channels;
    bool ok;

    *names = (struct image_exr_names){0};
    pthread_mutex_init(&reader.lock, NULL);
    ok = image_exr_source_open(&reader.source, fd, error) && read_header(&reader, &facts, error);
    if (ok && !exr_get_channels(reader.source.context, 0, &channels)) {
        names->names = xcalloc((size_t)channels->num_channels, sizeof *names->names);
        for (int i = 0; i < channels->num_channels; i++)
            names->names[names->count++] = xstrdup(channels->entries[i].name.str);
    }
    image_exr_source_close(&reader.source);
    pthread_mutex_destroy(&reader.lock);
    return ok;
}

void image_exr_names_finish(struct image_exr_names *names)
{
    for (size_t i = 0; i < names->count; i++)
        free(names->names[i]);
    free(names->names);
    *names = (struct image_exr_names){0};
}

bool image_exr_names_have(const struct image_exr_names *names, const char *name)
{
    for (size_t i = 0; i < names->count; i++)
        if (!strcmp(names->names[i], name)) return true;
    return false;
}
