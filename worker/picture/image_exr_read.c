// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr.h"

#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr_attributes.h"
#include "worker/picture/image_exr_zip.h"

#define IMATH_HALF_NO_LOOKUP_TABLE
#include <Imath/half.h>
#include <OpenEXR/openexr.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    THREAD_LIMIT = 64,
    FILE_CHANNEL_LIMIT = 256 // more than any renderer writes; a damaged header could ask for gigabytes
};

struct reader {
    exr_context_t context;
    int fd;
    exr_attr_box2i_t window;
    int lines_per_chunk, line_count;
    uint64_t chunk_bytes; // unpacked, at most

    pthread_mutex_t lock; // guards all that follows
    char message[256];    // the library's first error
    int next_line;
    bool is_spoilt; // a value that is not kept is not finite
    bool failed;
    struct error error; // the error of the first chunk that failed
};

static int64_t on_read(exr_const_context_t context, void *user, void *bytes, uint64_t size, uint64_t offset,
                       exr_stream_error_func_ptr_t report)
{
    struct reader *reader = user;
    uint64_t done = 0;

    while (done < size) {
        ssize_t count = pread(reader->fd, (char *)bytes + done, size - done, (off_t)(offset + done));

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return -1;
        if (count == 0) break;
        done += (uint64_t)count;
    }
    return (int64_t)done;
}

static int64_t on_query_size(exr_const_context_t context, void *user)
{
    const struct reader *reader = user;
    struct stat status;

    return fstat(reader->fd, &status) < 0 ? -1 : (int64_t)status.st_size;
}

// The first message names the cause; later ones only repeat that a call failed.
static void on_library_error(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *user = NULL;
    struct reader *reader;

    if (!context || exr_get_user_data(context, &user) || !user) return;
    reader = user;
    pthread_mutex_lock(&reader->lock);
    if (!reader->message[0]) snprintf(reader->message, sizeof reader->message, "%s", message);
    pthread_mutex_unlock(&reader->lock);
}

static bool fail(const struct reader *reader, exr_result_t result, struct error *error)
{
    error_set(error, "%s", reader->message[0] ? reader->message : exr_get_default_error_message(result));
    return false;
}

static bool open_file(struct reader *reader, struct error *error)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_result_t result;

    initializer.error_handler_fn = on_library_error;
    initializer.user_data = reader;
    initializer.read_fn = on_read;
    initializer.size_fn = on_query_size;
    initializer.max_image_width = IMAGE_SIDE_LIMIT;
    initializer.max_image_height = IMAGE_SIDE_LIMIT;
    initializer.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    result = exr_start_read(&reader->context, "file", &initializer);
    return result ? fail(reader, result, error) : true;
}

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
    exr_result_t result = exr_get_compression(reader->context, 0, &found);

    if (result) return fail(reader, result, error);
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
    exr_result_t result = exr_get_storage(reader->context, 0, &storage);

    if (result) return fail(reader, result, error);
    if (storage != EXR_STORAGE_SCANLINE) {
        error_set(error, "expected scanlines, got tiles or deep pixels");
        return false;
    }
    result = exr_get_data_window(reader->context, 0, &reader->window);
    if (!result) result = exr_get_channels(reader->context, 0, &channels);
    if (!result) result = exr_get_scanlines_per_chunk(reader->context, 0, &reader->lines_per_chunk);
    if (!result) result = exr_get_chunk_unpacked_size(reader->context, 0, &reader->chunk_bytes);
    if (result) return fail(reader, result, error);
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
    image_exr_attributes_read(reader->context, facts);
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
    const struct image *image;                           // NULL: values are checked and not kept
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

static void take_line(struct decoder *decoder, const exr_coding_channel_info_t *channel, size_t y, size_t width,
                      const char *packed)
{
    size_t stride;
    float *plane;

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
    }
    return EXR_ERR_SUCCESS;
}

static exr_result_t read_chunk(struct decoder *decoder, int y)
{
    struct reader *reader = decoder->reader;
    exr_decode_pipeline_t *pipeline = &decoder->pipeline;
    exr_chunk_info_t chunk;
    exr_result_t result = exr_read_scanline_chunk_info(reader->context, 0, y, &chunk);

    if (result) return result;
    // An uncompressed chunk is used as it was read, so all its bytes must be there.
    if (chunk.compression == EXR_COMPRESSION_NONE && chunk.packed_size != chunk.unpacked_size)
        return EXR_ERR_CORRUPT_CHUNK;
    if (pipeline->context) {
        result = exr_decoding_update(reader->context, 0, &chunk, pipeline);
    } else {
        result = exr_decoding_initialize(reader->context, 0, &chunk, pipeline);
        if (!result) result = exr_decoding_choose_default_routines(reader->context, 0, pipeline);
        pipeline->decoding_user_data = decoder;
        pipeline->unpack_and_convert_fn = on_unpack;
        decoder->decompress = pipeline->decompress_fn;
        if (chunk.compression == EXR_COMPRESSION_ZIP || chunk.compression == EXR_COMPRESSION_ZIPS)
            pipeline->decompress_fn = on_decompress;
    }
    return result ? result : exr_decoding_run(reader->context, 0, pipeline);
}

struct chunk_task {
    struct reader *reader;
    const struct image *image;
};

static void *read_chunks(void *user)
{
    const struct chunk_task *task = user;
    struct reader *reader = task->reader;
    struct decoder decoder = {.reader = reader, .image = task->image};

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
        fail(reader, result, &reader->error);
        error_prefix(&reader->error, "line %d", line);
    }
    if (decoder.is_spoilt) reader->is_spoilt = true;
    pthread_mutex_unlock(&reader->lock);
    if (decoder.pipeline.context) exr_decoding_destroy(reader->context, &decoder.pipeline);
    image_exr_zip_destroy(decoder.zip);
    return NULL;
}

// `image` is that of struct decoder.
static void read_all_chunks(struct reader *reader, const struct image *image, int thread_count)
{
    struct chunk_task task = {reader, image};
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
    struct reader reader = {.fd = fd};
    struct image_exr_facts found = {0};
    bool ok;

    pthread_mutex_init(&reader.lock, NULL);
    if (image) *image = (struct image){0};
    ok = open_file(&reader, error) && read_header(&reader, &found, error) &&
         (!image || read_pixels(&reader, &found, image, thread_count, error));
    exr_finish(&reader.context);
    pthread_mutex_destroy(&reader.lock);
    if (ok && facts) *facts = found;
    return ok;
}

bool image_exr_scan(int fd, bool *is_finite, int thread_count, struct error *error)
{
    struct reader reader = {.fd = fd};
    struct image_exr_facts facts = {0};
    bool ok;

    pthread_mutex_init(&reader.lock, NULL);
    ok = open_file(&reader, error) && read_header(&reader, &facts, error);
    if (ok) {
        read_all_chunks(&reader, NULL, thread_count);
        ok = !reader.failed;
        if (!ok) error_set(error, "%s", reader.error.message);
    }
    *is_finite = ok && !reader.is_spoilt;
    exr_finish(&reader.context);
    pthread_mutex_destroy(&reader.lock);
    return ok;
}
