// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr.h"

#include "core/base/error.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr_line.h"
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

enum { THREAD_LIMIT = 64 };

struct writer {
    exr_context_t context;
    int fd;
    const struct image *image; // borrowed
    size_t line_bytes;
    bool is_zip, is_half, is_checked; // of the header
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

static exr_result_t add_channels(const struct writer *writer, int part)
{
    static const char *const names[] = {
        "A", "B", "G", "R", "Z", "transmittance.B", "transmittance.G", "transmittance.R"};
    enum { Z = 4, END = sizeof names / sizeof names[0] };
    const struct image *image = writer->image;
    exr_result_t result = EXR_ERR_SUCCESS;

    for (int i = 0; i < END && !result; i++) {
        exr_pixel_type_t type = i != Z && writer->is_half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;

        if ((i == Z && !image->depth) || (i > Z && !image->transmittance)) continue;
        result = exr_add_channel(writer->context, part, names[i], type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    }
    return result;
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
    if (!result && header->comment) result = exr_attr_set_string(context, 0, "comments", header->comment);
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
    if (!result && header->traced > 0.0) result = exr_attr_set_double(context, 0, "marchd:traced", header->traced);
    if (!result && header->beyond.is_known) {
        result = exr_attr_set_double(context, 0, "marchd:beyond", header->beyond.error);
        if (!result) result = exr_attr_set_double(context, 0, "marchd:beyond95", header->beyond.error95);
    }
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
    char job[32], orders[SCENE_ORDERS_SIZE];
    const struct {
        const char *name, *text;
    } strings[] = {
        {"marchd:job", job},
        {"marchd:name", header->job_name},
        {"marchd:tags", header->tags},
        {"marchd:host", header->host},
        {"marchd:node", header->node},
        {"marchd:farm", header->farm},
        {"marchd:jobHash", header->job_hash},
        {"marchd:sequenceHash", header->sequence_hash},
        {"marchd:method", header->method},
        {"marchd:scattering", header->orders > 1 ? orders : NULL},
        {"marchd:backend", header->backend},
        {"marchd:renderer", header->renderer},
        {"marchd:shaderHash", header->shader_hash},
    };
    exr_result_t result = EXR_ERR_SUCCESS;

    // An int attribute has 32 bits, a job's id 64.
    snprintf(job, sizeof job, "%" PRId64, header->job_id);
    scene_format_orders(header->orders, orders);
    for (size_t i = 0; i < sizeof strings / sizeof strings[0] && !result; i++)
        if (strings[i].text) result = exr_attr_set_string(context, 0, strings[i].name, strings[i].text);
    if (!result) result = exr_attr_set_int(context, 0, "marchd:frame", header->frame);
    if (!result) result = exr_attr_set_int(context, 0, "marchd:attempt", header->attempt);
    if (!result) result = exr_attr_set_double(context, 0, "marchd:step", header->step);
    if (!result && header->paths > 0.0) result = exr_attr_set_double(context, 0, "marchd:paths", header->paths);
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
        result = exr_initialize_required_attr_simple(context, part, writer->image->width_px, writer->image->height_px,
                                                     compressions[header->compression]);
    if (!result) result = add_channels(writer, part);
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
    exr_encode_pipeline_t pipeline; // of the library, where that compresses or nothing does
    struct image_exr_zip *zip;      // owned; NULL until it packs
    struct image_pixel pixel;       // all pixels of the last chunk that zip packed, if its `line_count` is not 0
    int line_count;
    char *lines;       // owned; the chunk before compression, of which zip needs only a line
    const void *bytes; // the chunk as the file stores it; borrowed from the packer
    uint64_t size_bytes;
};

// A line is checked right before it is packed, while the processor's cache has it.
static bool pack_line(const struct writer *writer, int y, char *line)
{
    if (writer->is_checked && !image_rows_are_finite(writer->image, writer->is_half, y, 1)) return false;
    image_exr_line_pack(writer->image, writer->is_half, y, line);
    return true;
}

// True when the chunk's pixels are all those of the one before. `packer` notes what the chunk is.
static bool is_repeated(const struct writer *writer, struct packer *packer, int y, int line_count)
{
    struct image_pixel before = packer->pixel;
    int before_count = packer->line_count;

    packer->line_count = image_rows_are_constant(writer->image, y, line_count, &packer->pixel) ? line_count : 0;
    return packer->line_count > 0 && before_count == line_count && memcmp(&before, &packer->pixel, sizeof before) == 0;
}

// The bytes of the chunk before are still there: an equal one costs no more than reading its pixels once.
static exr_result_t zip_chunk(const struct writer *writer, struct packer *packer, int y, int line_count)
{
    size_t size_bytes;

    if (is_repeated(writer, packer, y, line_count)) return EXR_ERR_SUCCESS;
    if (!packer->zip) packer->zip = image_exr_zip_create(writer->line_bytes * (size_t)writer->lines_per_chunk);
    if (!packer->lines) packer->lines = malloc(writer->line_bytes);
    if (!packer->zip || !packer->lines) return EXR_ERR_OUT_OF_MEMORY;
    image_exr_zip_begin(packer->zip, writer->line_bytes * (size_t)line_count);
    for (int line = y; line < y + line_count; line++) {
        if (!pack_line(writer, line, packer->lines)) return EXR_ERR_INVALID_ARGUMENT;
        image_exr_zip_add(packer->zip, packer->lines, writer->line_bytes);
    }
    packer->bytes = image_exr_zip_end(packer->zip, &size_bytes);
    packer->size_bytes = size_bytes;
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
    if (!pipeline->compress_fn) return EXR_ERR_SUCCESS;
    if (!has_room_to_compress(pipeline, writer->line_bytes * (size_t)writer->lines_per_chunk))
        return EXR_ERR_OUT_OF_MEMORY;
    result = pipeline->compress_fn(pipeline);
    if (result || pipeline->compressed_bytes >= pipeline->packed_bytes) return result;
    packer->bytes = pipeline->compressed_buffer;
    packer->size_bytes = pipeline->compressed_bytes;
    return EXR_ERR_SUCCESS;
}

// exr_encoding_run would do the same but packs under the context's lock, which serializes the threads, so its stages
// are called one by one.
static exr_result_t compress_chunk(const struct writer *writer, struct packer *packer, int y)
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
    if (!packer->lines) return EXR_ERR_OUT_OF_MEMORY;
    pipeline->packed_buffer = packer->lines;
    pipeline->packed_bytes = chunk.unpacked_size;
    assert(pipeline->packed_bytes <= chunk_bytes);
    for (int line = 0; line < chunk.height; line++)
        if (!pack_line(writer, y + line, packer->lines + (size_t)line * writer->line_bytes))
            return EXR_ERR_INVALID_ARGUMENT;
    return compress(writer, packer);
}

// Packs the chunk that starts at line `y`.
static exr_result_t encode_chunk(const struct writer *writer, struct packer *packer, int y)
{
    int lines_left = writer->image->height_px - y;

    if (!writer->is_zip) return compress_chunk(writer, packer, y);
    return zip_chunk(writer, packer, y, lines_left < writer->lines_per_chunk ? lines_left : writer->lines_per_chunk);
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
    struct writer writer = {.fd = fd,
                            .image = image,
                            .is_zip = header->compression == JOB_COMPRESSION_ZIP ||
                                      header->compression == JOB_COMPRESSION_ZIPS,
                            .line_bytes = image_exr_line_bytes(image, header->pixel == JOB_PIXEL_HALF),
                            .is_half = header->pixel == JOB_PIXEL_HALF,
                            .is_checked = header->is_checked};
    bool ok;

    pthread_mutex_init(&writer.lock, NULL);
    pthread_cond_init(&writer.written, NULL);
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
