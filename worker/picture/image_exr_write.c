// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr.h"

#include "core/base/error.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/half_row.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr_zip.h"

#define IMATH_HALF_NO_LOOKUP_TABLE
#include <Imath/half.h>
#include <OpenEXR/openexr.h>
#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { CHANNEL_LIMIT = 8, THREAD_LIMIT = 64 };

struct channel {
    const char *name;
    exr_pixel_type_t type;
    const float *pixels; // borrowed from the image; the first channel's value of its first pixel
    size_t index;        // of the channel in a pixel
    size_t stride;       // in floats, from pixel to pixel
};

struct writer {
    exr_context_t context;
    int fd;
    struct channel channels[CHANNEL_LIMIT]; // in the file's order: sorted by name
    size_t channel_count;
    size_t width, height;
    size_t line_bytes;
    bool is_zip;
    int lines_per_chunk, chunk_count;

    pthread_mutex_t lock; // guards all that follows, and the library's calls that write
    pthread_cond_t written;
    int next_taken, next_written;
    bool failed;
    int errnum; // errno of the first write that failed
    struct error error;
};

static int64_t on_write(exr_const_context_t context, void *user, const void *bytes, uint64_t size, uint64_t offset,
                        exr_stream_error_func_ptr_t report)
{
    struct writer *writer = user;
    uint64_t done = 0;

    while (done < size) {
        ssize_t count = pwrite(writer->fd, (const char *)bytes + done, size - done, (off_t)(offset + done));

        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) {
            if (!writer->errnum) writer->errnum = count < 0 ? errno : EIO;
            return -1;
        }
        done += (uint64_t)count;
    }
    return (int64_t)done;
}

// Without this callback the library prints to standard error. While writing, its code says enough.
static void on_library_error(exr_const_context_t context, exr_result_t code, const char *message)
{
}

static void add_channel(struct writer *writer, const struct channel *channel)
{
    writer->channels[writer->channel_count++] = *channel;
    writer->line_bytes += writer->width * (channel->type == EXR_PIXEL_HALF ? 2 : 4);
}

static void add_channels(struct writer *writer, const struct image *image, enum job_pixel pixel)
{
    exr_pixel_type_t type = pixel == JOB_PIXEL_HALF ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    static const char *const rgba[] = {"R", "G", "B", "A"};
    static const char *const transmittance[] = {"transmittance.R", "transmittance.G", "transmittance.B"};

    for (size_t i = 4; i-- > 0;)
        add_channel(writer, &(struct channel){rgba[i], type, image->rgba, i, 4});
    if (image->depth) add_channel(writer, &(struct channel){"Z", EXR_PIXEL_FLOAT, image->depth, 0, 1});
    for (size_t i = image->transmittance ? 3 : 0; i-- > 0;)
        add_channel(writer, &(struct channel){transmittance[i], type, image->transmittance, i, 4});
}

static exr_result_t set_matrix(exr_context_t context, const char *name, const double values[16])
{
    exr_attr_m44f_t matrix;

    for (int i = 0; i < 16; i++)
        matrix.m[i] = (float)values[i];
    return exr_attr_set_m44f(context, 0, name, &matrix);
}

static exr_result_t set_capture_time(exr_context_t context, int64_t captured)
{
    time_t seconds = (time_t)captured;
    struct tm utc;
    char text[64];
    exr_result_t result;

    gmtime_r(&seconds, &utc);
    strftime(text, sizeof text, "%Y:%m:%d %H:%M:%S", &utc);
    result = exr_attr_set_string(context, 0, "capDate", text);
    return result ? result : exr_attr_set_float(context, 0, "utcOffset", 0.0f);
}

static exr_result_t set_standard_attributes(exr_context_t context, const struct image_exr_header *header)
{
    exr_attr_chromaticities_t rec709 = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    exr_attr_rational_t fps = {(int32_t)header->fps_numerator, (uint32_t)header->fps_denominator};
    exr_result_t result = exr_attr_set_rational(context, 0, "framesPerSecond", &fps);

    if (!result) result = exr_attr_set_chromaticities(context, 0, "chromaticities", &rec709);
    if (!result) result = set_matrix(context, "worldToCamera", header->world_to_camera);
    if (!result) result = set_matrix(context, "worldToNDC", header->world_to_ndc);
    if (!result) result = set_capture_time(context, header->captured);
    if (!result) result = exr_attr_set_string(context, 0, "software", "marchd " MARCHD_VERSION);
    if (!result && header->owner) result = exr_attr_set_string(context, 0, "owner", header->owner);
    return result;
}

static exr_result_t set_rays(exr_context_t context, const struct image_exr_rays *rays)
{
    exr_result_t result = EXR_ERR_SUCCESS;

    if (!rays->is_known) return result;
    result = exr_attr_set_double(context, 0, "marchd:raysPerPixel", rays->rays_per_pixel);
    if (!result) result = exr_attr_set_double(context, 0, "marchd:cutRays", rays->cut_rays);
    if (!result) result = exr_attr_set_double(context, 0, "marchd:cutShare", rays->cut_share);
    if (!result) result = exr_attr_set_double(context, 0, "marchd:cutTolerance", rays->cut_tolerance);
    return result;
}

// The number is text: it may exceed an int.
static exr_result_t set_plan(exr_context_t context, const struct image_exr_header *header)
{
    char number[24];
    exr_result_t result;

    snprintf(number, sizeof number, "%" PRId64, header->plan_number);
    result = exr_attr_set_string(context, 0, "marchd:planNumber", number);
    return result ? result : exr_attr_set_string(context, 0, "marchd:quality", header->quality);
}

static exr_result_t set_accuracy(exr_context_t context, const struct image_exr_header *header)
{
    const struct audit_result *audit = &header->audit;
    exr_result_t result = EXR_ERR_SUCCESS;

    if (header->plan && header->plan[0]) result = exr_attr_set_string(context, 0, "marchd:plan", header->plan);
    if (!result && header->plan_number > 0) result = set_plan(context, header);
    if (!result && header->is_draft) result = exr_attr_set_int(context, 0, "marchd:draft", 1);
    if (!result && header->sampling_error > 0.0)
        result = exr_attr_set_double(context, 0, "marchd:samplingError", header->sampling_error);
    if (result || audit->kind == AUDIT_NONE) return result;
    result = exr_attr_set_string(context, 0, "marchd:audit", audit_result_kind_name(audit->kind));
    if (!result) result = exr_attr_set_string(context, 0, "marchd:auditScope", audit->is_pooled ? "segment" : "frame");
    if (!result) result = exr_attr_set_double(context, 0, "marchd:tolerance", audit->tolerance);
    if (!result) result = exr_attr_set_double(context, 0, "marchd:error", audit->error);
    if (!result) result = exr_attr_set_double(context, 0, "marchd:error95", audit->error95);
    if (!result) result = exr_attr_set_int(context, 0, "marchd:auditRays", audit->ray_count);
    if (!result && audit->is_missed) result = exr_attr_set_int(context, 0, "marchd:missed", 1);
    return result;
}

static exr_result_t set_own_attributes(exr_context_t context, const struct image_exr_header *header)
{
    char job[32];
    const struct {
        const char *name, *text;
    } strings[] = {
        {"marchd:job", job},
        {"marchd:jobHash", header->job_hash},
        {"marchd:sequenceHash", header->sequence_hash},
        {"marchd:method", header->method},
        {"marchd:backend", header->backend},
        {"marchd:renderer", header->renderer},
        {"marchd:shaderHash", header->shader_hash},
    };
    exr_result_t result = EXR_ERR_SUCCESS;

    // An int attribute has 32 bits, a job's id 64.
    snprintf(job, sizeof job, "%" PRId64, header->job_id);
    for (size_t i = 0; i < sizeof strings / sizeof strings[0] && !result; i++)
        if (strings[i].text) result = exr_attr_set_string(context, 0, strings[i].name, strings[i].text);
    if (!result) result = exr_attr_set_int(context, 0, "marchd:frame", header->frame);
    if (!result) result = exr_attr_set_int(context, 0, "marchd:attempt", header->attempt);
    if (!result) result = exr_attr_set_double(context, 0, "marchd:step", header->step);
    if (!result) result = exr_attr_set_double(context, 0, "marchd:renderSeconds", header->render_seconds);
    return result;
}

static exr_result_t write_header(struct writer *writer, const struct image_exr_header *header)
{
    static const exr_compression_t compressions[] = {
        [JOB_COMPRESSION_NONE] = EXR_COMPRESSION_NONE, [JOB_COMPRESSION_RLE] = EXR_COMPRESSION_RLE,
        [JOB_COMPRESSION_ZIPS] = EXR_COMPRESSION_ZIPS, [JOB_COMPRESSION_ZIP] = EXR_COMPRESSION_ZIP,
        [JOB_COMPRESSION_PIZ] = EXR_COMPRESSION_PIZ,
    };
    exr_context_t context = writer->context;
    int part;
    exr_result_t result = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);

    if (!result)
        result = exr_initialize_required_attr_simple(context, part, (int32_t)writer->width, (int32_t)writer->height,
                                                     compressions[header->compression]);
    for (size_t i = 0; i < writer->channel_count && !result; i++)
        result = exr_add_channel(context, part, writer->channels[i].name, writer->channels[i].type,
                                 EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (!result) result = set_standard_attributes(context, header);
    if (!result) result = set_own_attributes(context, header);
    if (!result) result = set_rays(context, &header->rays);
    if (!result) result = set_accuracy(context, header);
    if (!result) result = exr_write_header(context);
    if (!result) result = exr_get_scanlines_per_chunk(context, part, &writer->lines_per_chunk);
    if (!result) result = exr_get_chunk_count(context, part, &writer->chunk_count);
    return result;
}

// The state of one thread that packs chunks.
struct packer {
    exr_encode_pipeline_t pipeline;
    struct image_exr_zip *zip; // owned; NULL: the library compresses, or nothing does
    char *lines;               // owned; the chunk before compression
    uint16_t *halves;          // owned; a line's pixels, channel by channel
    const void *bytes;         // the chunk as the file stores it; borrowed from the packer
    uint64_t size_bytes;
};

static void take_floats(char *to, const float *pixels, size_t count, size_t stride)
{
    if (stride == 1) {
        memcpy(to, pixels, count * sizeof(float));
        return;
    }
    for (size_t x = 0; x < count; x++)
        memcpy(to + x * sizeof(float), pixels + x * stride, sizeof(float));
}

// A chunk is stored line by line, and a line channel by channel. Channels of the same pixels are neighbours, so their
// pixels are converted to halves and taken apart once.
static void pack_lines(const struct writer *writer, uint16_t *halves, size_t first_line, size_t line_count,
                       char *packed)
{
    size_t width = writer->width;

    for (size_t y = first_line; y < first_line + line_count; y++) {
        const float *converted = NULL;

        for (size_t i = 0; i < writer->channel_count; i++) {
            const struct channel *channel = &writer->channels[i];
            const float *pixels = channel->pixels + y * width * channel->stride;

            if (channel->type != EXR_PIXEL_HALF) {
                take_floats(packed, pixels + channel->index, width, channel->stride);
                packed += width * sizeof(float);
                continue;
            }
            assert(channel->stride == HALF_ROW_PLANES);
            if (converted != pixels) half_row_split(halves, pixels, width);
            converted = pixels;
            memcpy(packed, halves + channel->index * width, width * sizeof *halves);
            packed += width * sizeof(uint16_t);
        }
    }
}

static exr_result_t compress_zip(const struct writer *writer, struct packer *packer)
{
    const exr_encode_pipeline_t *pipeline = &packer->pipeline;
    const void *zipped;
    size_t size_bytes;

    if (!packer->zip) packer->zip = image_exr_zip_create(writer->line_bytes * (size_t)writer->lines_per_chunk);
    if (!packer->zip) return EXR_ERR_OUT_OF_MEMORY;
    size_bytes = image_exr_zip_pack(packer->zip, pipeline->packed_buffer, pipeline->packed_bytes, &zipped);
    if (size_bytes > 0) {
        packer->bytes = zipped;
        packer->size_bytes = size_bytes;
    }
    return EXR_ERR_SUCCESS;
}

// OpenEXR 3.2 allocates too little for a small chunk: piz writes a table of up to 8192 bytes before the data, past the
// buffer's end. The library keeps a buffer that is large enough, and frees it.
static bool has_room_to_compress(exr_encode_pipeline_t *pipeline, size_t chunk_bytes)
{
    size_t size_bytes = 2 * chunk_bytes + 65536;

    if (pipeline->compressed_buffer) return true;
    pipeline->compressed_buffer = malloc(size_bytes);
    pipeline->compressed_alloc_size = pipeline->compressed_buffer ? size_bytes : 0;
    return pipeline->compressed_buffer;
}

// Readers take a chunk with the size of its raw pixels for an uncompressed one, so a chunk that
// compression does not make smaller is stored raw.
static exr_result_t compress(const struct writer *writer, struct packer *packer)
{
    exr_encode_pipeline_t *pipeline = &packer->pipeline;
    exr_result_t result;

    packer->bytes = pipeline->packed_buffer;
    packer->size_bytes = pipeline->packed_bytes;
    if (writer->is_zip) return compress_zip(writer, packer);
    if (!pipeline->compress_fn) return EXR_ERR_SUCCESS;
    if (!has_room_to_compress(pipeline, writer->line_bytes * (size_t)writer->lines_per_chunk))
        return EXR_ERR_OUT_OF_MEMORY;
    result = pipeline->compress_fn(pipeline);
    if (result || pipeline->compressed_bytes >= pipeline->packed_bytes) return result;
    packer->bytes = pipeline->compressed_buffer;
    packer->size_bytes = pipeline->compressed_bytes;
    return EXR_ERR_SUCCESS;
}

// Packs the chunk that starts at line `y`. exr_encoding_run would do the same but packs under the
// context's lock, which serializes the threads, so its stages are called one by one.
static exr_result_t encode_chunk(struct writer *writer, struct packer *packer, int y)
{
    exr_encode_pipeline_t *pipeline = &packer->pipeline;
    size_t chunk_bytes = writer->line_bytes * (size_t)writer->lines_per_chunk;
    exr_chunk_info_t chunk;
    exr_result_t result = exr_write_scanline_chunk_info(writer->context, 0, y, &chunk);

    if (result) return result;
    if (!pipeline->context) {
        result = exr_encoding_initialize(writer->context, 0, &chunk, pipeline);
        if (!result) result = exr_encoding_choose_default_routines(writer->context, 0, pipeline);
    } else {
        result = exr_encoding_update(writer->context, 0, &chunk, pipeline);
    }
    if (result) return result;
    if (!packer->lines) packer->lines = malloc(chunk_bytes);
    if (!packer->halves) packer->halves = malloc(writer->width * HALF_ROW_PLANES * sizeof *packer->halves);
    if (!packer->lines || !packer->halves) return EXR_ERR_OUT_OF_MEMORY;
    pipeline->packed_buffer = packer->lines;
    pipeline->packed_bytes = chunk.unpacked_size;
    assert(pipeline->packed_bytes <= chunk_bytes);
    pack_lines(writer, packer->halves, (size_t)y, (size_t)chunk.height, packer->lines);
    return compress(writer, packer);
}

static void fail_chunk(struct writer *writer, exr_result_t result, int y)
{
    if (writer->failed) return;
    writer->failed = true;
    if (writer->errnum)
        error_set_errno(&writer->error, writer->errnum, "line %d", y);
    else
        error_set(&writer->error, "line %d: %s", y, exr_get_default_error_message(result));
}

static void *write_chunks(void *user)
{
    struct writer *writer = user;
    struct packer packer = {0};

    pthread_mutex_lock(&writer->lock);
    while (!writer->failed && writer->next_taken < writer->chunk_count) {
        int index = writer->next_taken++;
        int y = index * writer->lines_per_chunk;
        exr_result_t result;

        pthread_mutex_unlock(&writer->lock);
        result = encode_chunk(writer, &packer, y);
        pthread_mutex_lock(&writer->lock);
        while (!writer->failed && writer->next_written < index)
            pthread_cond_wait(&writer->written, &writer->lock);
        if (writer->failed) break;
        if (!result) result = exr_write_scanline_chunk(writer->context, 0, y, packer.bytes, packer.size_bytes);
        if (result) fail_chunk(writer, result, y);
        writer->next_written++;
        pthread_cond_broadcast(&writer->written);
    }
    pthread_mutex_unlock(&writer->lock);
    packer.pipeline.packed_buffer = NULL; // owned by us
    if (packer.pipeline.context) exr_encoding_destroy(writer->context, &packer.pipeline);
    image_exr_zip_destroy(packer.zip);
    free(packer.lines);
    free(packer.halves);
    return NULL;
}

// Threads are made for each file, which costs about ten microseconds, so none is idle between files.
static void write_all_chunks(struct writer *writer, int thread_count)
{
    pthread_t threads[THREAD_LIMIT];
    int started = 0;

    if (thread_count > THREAD_LIMIT) thread_count = THREAD_LIMIT;
    if (thread_count > writer->chunk_count) thread_count = writer->chunk_count;
    while (started < thread_count - 1 && !pthread_create(&threads[started], NULL, write_chunks, writer))
        started++;
    write_chunks(writer);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
}

static bool write_file(struct writer *writer, const struct image_exr_header *header, int thread_count,
                       struct error *error)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_result_t result;

    initializer.error_handler_fn = on_library_error;
    initializer.user_data = writer;
    initializer.write_fn = on_write;
    // With a write_fn the name is not used, but the library requires one.
    result = exr_start_write(&writer->context, "frame.exr", EXR_WRITE_FILE_DIRECTLY, &initializer);
    if (!result) result = write_header(writer, header);
    if (result) {
        if (writer->errnum)
            error_set_errno(error, writer->errnum, "header");
        else
            error_set(error, "header: %s", exr_get_default_error_message(result));
        return false;
    }
    write_all_chunks(writer, thread_count);
    if (writer->failed) {
        error_set(error, "%s", writer->error.message);
        return false;
    }
    if (fsync(writer->fd) < 0) {
        writer->errnum = errno;
        error_set_errno(error, writer->errnum, "sync");
        return false;
    }
    return true;
}

bool image_exr_write(int fd, const struct image *image, const struct image_exr_header *header, int thread_count,
                     struct error *error)
{
    struct writer writer = {.fd = fd, .width = (size_t)image->width_px, .height = (size_t)image->height_px};
    bool ok;

    pthread_mutex_init(&writer.lock, NULL);
    pthread_cond_init(&writer.written, NULL);
    writer.is_zip = header->compression == JOB_COMPRESSION_ZIP || header->compression == JOB_COMPRESSION_ZIPS;
    add_channels(&writer, image, header->pixel);
    ok = write_file(&writer, header, thread_count, error);
    // Finishing writes nothing, because the table of chunks was written with the last chunk.
    exr_finish(&writer.context);
    pthread_cond_destroy(&writer.written);
    pthread_mutex_destroy(&writer.lock);
    errno = ok ? 0 : writer.errnum;
    return ok;
}

float image_exr_stored(float value, enum job_pixel pixel)
{
    return pixel == JOB_PIXEL_HALF ? imath_half_to_float(imath_float_to_half(value)) : value;
}
