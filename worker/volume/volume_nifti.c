// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_layout.h"

#include "core/base/error.h"
#include "worker/volume/volume_placement.h"
#include "worker/volume/volume_stream.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

// Sizes of the two versions' headers. Each header begins with its size.
enum { HEADER_1_SIZE = 348, HEADER_2_SIZE = 540 };

// The fields that are used, of either version, in native byte order. Names are the standard's.
struct nifti_header {
    int version;
    bool is_big_endian;
    bool is_swapped;
    unsigned char bytes[HEADER_2_SIZE];
    int64_t dim[8];
    int64_t datatype, bitpix;
    double pixdim[8];
    double vox_offset, scl_slope, scl_inter;
    int64_t qform_code, sform_code, xyzt_units;
    double quatern[3], qoffset[3], srow[12];
};

enum field_kind { FIELD_INT8, FIELD_INT16, FIELD_INT32, FIELD_INT64, FIELD_FLOAT32, FIELD_FLOAT64 };

static const size_t field_sizes[] = {1, 2, 4, 8, 4, 8};

struct field {
    size_t offset; // in the header
    enum field_kind kind;
};

static const struct datatype {
    int64_t code;
    const char *name;
    bool is_read;
    enum volume_stored stored;
} datatypes[] = {
    {2, "uint8", true, VOLUME_STORED_UINT8},
    {256, "int8", true, VOLUME_STORED_INT8},
    {512, "uint16", true, VOLUME_STORED_UINT16},
    {4, "int16", true, VOLUME_STORED_INT16},
    {768, "uint32", true, VOLUME_STORED_UINT32},
    {8, "int32", true, VOLUME_STORED_INT32},
    {1280, "uint64", true, VOLUME_STORED_UINT64},
    {1024, "int64", true, VOLUME_STORED_INT64},
    {16, "float32", true, VOLUME_STORED_FLOAT32},
    {64, "float64", true, VOLUME_STORED_FLOAT64},
    {1, "binary", false, 0},
    {32, "complex64", false, 0},
    {128, "RGB24", false, 0},
    {1536, "float128", false, 0},
    {1792, "complex128", false, 0},
    {2048, "complex256", false, 0},
    {2304, "RGBA32", false, 0},
};

enum { DATATYPE_COUNT = sizeof datatypes / sizeof datatypes[0] };

static void take(const struct nifti_header *header, struct field field, size_t index, void *number)
{
    size_t size = field_sizes[field.kind];
    const unsigned char *at = header->bytes + field.offset + index * size;

    for (size_t i = 0; i < size; i++)
        ((unsigned char *)number)[i] = at[header->is_swapped ? size - 1 - i : i];
}

static int64_t take_integer(const struct nifti_header *header, struct field field, size_t index)
{
    int8_t i8 = 0;
    int16_t i16 = 0;
    int32_t i32 = 0;
    int64_t i64 = 0;

    switch (field.kind) {
    case FIELD_INT8:
        take(header, field, index, &i8);
        return i8;
    case FIELD_INT16:
        take(header, field, index, &i16);
        return i16;
    case FIELD_INT32:
        take(header, field, index, &i32);
        return i32;
    default:
        take(header, field, index, &i64);
        return i64;
    }
}

static void take_numbers(const struct nifti_header *header, struct field field, size_t count, double *numbers)
{
    for (size_t i = 0; i < count; i++) {
        float f32 = 0;
        double f64 = 0;

        if (field.kind == FIELD_FLOAT32) {
            take(header, field, i, &f32);
            numbers[i] = f32;
        } else if (field.kind == FIELD_FLOAT64) {
            take(header, field, i, &f64);
            numbers[i] = f64;
        } else {
            numbers[i] = (double)take_integer(header, field, i);
        }
    }
}

// The positions of each version's fields.
static const struct header_layout {
    struct field dim, datatype, bitpix, pixdim, vox_offset, scl_slope, scl_inter, xyzt_units, qform_code, sform_code,
        quatern, qoffset, srow;
    size_t magic;
} header_layouts[] = {
    {{40, FIELD_INT16},
     {70, FIELD_INT16},
     {72, FIELD_INT16},
     {76, FIELD_FLOAT32},
     {108, FIELD_FLOAT32},
     {112, FIELD_FLOAT32},
     {116, FIELD_FLOAT32},
     {123, FIELD_INT8},
     {252, FIELD_INT16},
     {254, FIELD_INT16},
     {256, FIELD_FLOAT32},
     {268, FIELD_FLOAT32},
     {280, FIELD_FLOAT32},
     344},
    {{16, FIELD_INT64},
     {12, FIELD_INT16},
     {14, FIELD_INT16},
     {104, FIELD_FLOAT64},
     {168, FIELD_INT64},
     {176, FIELD_FLOAT64},
     {184, FIELD_FLOAT64},
     {500, FIELD_INT32},
     {344, FIELD_INT32},
     {348, FIELD_INT32},
     {352, FIELD_FLOAT64},
     {376, FIELD_FLOAT64},
     {400, FIELD_FLOAT64},
     4},
};

static void decode(struct nifti_header *header)
{
    const struct header_layout *at = &header_layouts[header->version - 1];

    for (size_t i = 0; i < 8; i++)
        header->dim[i] = take_integer(header, at->dim, i);
    header->datatype = take_integer(header, at->datatype, 0);
    header->bitpix = take_integer(header, at->bitpix, 0);
    header->qform_code = take_integer(header, at->qform_code, 0);
    header->sform_code = take_integer(header, at->sform_code, 0);
    header->xyzt_units = take_integer(header, at->xyzt_units, 0);
    take_numbers(header, at->pixdim, 8, header->pixdim);
    take_numbers(header, at->vox_offset, 1, &header->vox_offset);
    take_numbers(header, at->scl_slope, 1, &header->scl_slope);
    take_numbers(header, at->scl_inter, 1, &header->scl_inter);
    take_numbers(header, at->quatern, 3, header->quatern);
    take_numbers(header, at->qoffset, 3, header->qoffset);
    take_numbers(header, at->srow, 12, header->srow);
}

static bool check_magic(const struct nifti_header *header, struct error *error)
{
    static const char single[][9] = {"n+1\0\0\0\0\0", "n+2\0\r\n\032\n"};
    static const char pair[][4] = {"ni1", "ni2"};
    const unsigned char *magic = header->bytes + header_layouts[header->version - 1].magic;
    size_t length = header->version == 1 ? 4 : 8;

    if (memcmp(magic, single[header->version - 1], length) == 0) return true;
    if (memcmp(magic, pair[header->version - 1], 4) == 0)
        error_set(error, "header and voxels are in two files (.hdr and .img): join them into one .nii first");
    else
        error_set(error, "expected NIfTI's magic \"n+%d\" at byte %zu, got something else", header->version,
                  header_layouts[header->version - 1].magic);
    return false;
}

static bool read_header(struct nifti_header *header, struct volume_stream *stream, struct error *error)
{
    uint32_t size;

    if (!volume_stream_read(stream, header->bytes, sizeof size, error)) return false;
    memcpy(&size, header->bytes, sizeof size);
    header->is_swapped = size == __builtin_bswap32(HEADER_1_SIZE) || size == __builtin_bswap32(HEADER_2_SIZE);
    header->is_big_endian = header->is_swapped != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    if (header->is_swapped) size = __builtin_bswap32(size);
    if (size != HEADER_1_SIZE && size != HEADER_2_SIZE) {
        if (memcmp(header->bytes, "\x1f\x8b", 2) == 0)
            error_set(error, "is compressed by gzip: its name must end in .nii.gz");
        else
            error_set(error, "expected NIfTI's header size, 348 or 540, in the first 4 bytes, got %" PRIu32, size);
        return false;
    }
    header->version = size == HEADER_1_SIZE ? 1 : 2;
    if (!volume_stream_read(stream, header->bytes + sizeof size, size - sizeof size, error)) return false;
    if (!check_magic(header, error)) return false;
    decode(header);
    return true;
}

static bool read_size(struct volume_layout *layout, const struct nifti_header *header, struct error *error)
{
    const int64_t *dim = header->dim;

    if (dim[0] < 3 || dim[0] > 7) {
        error_set(error, "dim[0]: expected 3 dimensions, got %" PRId64, dim[0]);
        return false;
    }
    for (int axis = 4; axis <= dim[0]; axis++) {
        if (dim[axis] == 1) continue;
        error_set(error, "dim[%d]: expected one volume, got %" PRId64 ": write the wanted one into a file of its own",
                  axis, dim[axis]);
        return false;
    }
    return volume_layout_set_size(layout, "dim", dim + 1, error);
}

static bool read_type(struct volume_layout *layout, const struct nifti_header *header, struct error *error)
{
    for (size_t i = 0; i < DATATYPE_COUNT; i++) {
        if (datatypes[i].code != header->datatype) continue;
        if (!datatypes[i].is_read) {
            error_set(error, "datatype: expected real numbers of 8 to 64 bits, got %s", datatypes[i].name);
            return false;
        }
        layout->stored = datatypes[i].stored;
        layout->is_big_endian = header->is_big_endian;
        if (header->bitpix == 8 * (int64_t)volume_stored_size(layout->stored)) return true;
        error_set(error, "bitpix: expected %zu for %s, got %" PRId64, 8 * volume_stored_size(layout->stored),
                  datatypes[i].name, header->bitpix);
        return false;
    }
    error_set(error, "datatype: %" PRId64 " is none of the standard's", header->datatype);
    return false;
}

// Slope 0 means that the stored numbers are the values. So does NaN, which common writers store where nothing is
// scaled.
static bool read_scaling(struct volume_layout *layout, const struct nifti_header *header, struct error *error)
{
    layout->slope = 1.0;
    layout->intercept = 0.0;
    if (header->scl_slope == 0.0 || isnan(header->scl_slope)) return true;
    // Values are single precision after this.
    if (!(fabs(header->scl_slope) < 1e30) || !(fabs(header->scl_slope) > 1e-30) || !(fabs(header->scl_inter) < 1e30)) {
        error_set(error, "scl_slope, scl_inter: expected numbers from 1e-30 to 1e30 in size, got %g, %g",
                  header->scl_slope, header->scl_inter);
        return false;
    }
    layout->slope = header->scl_slope;
    layout->intercept = header->scl_inter;
    return true;
}

static bool read_unit(const struct nifti_header *header, double *metres, struct error *error)
{
    static const double units[] = {1e-3, 1.0, 1e-3, 1e-6}; // unknown, metre, millimetre, micrometre
    int64_t unit = header->xyzt_units & 7;

    if (unit < (int64_t)(sizeof units / sizeof units[0])) {
        *metres = units[unit];
        return true;
    }
    error_set(error, "xyzt_units: expected a length, 0 to 3, got %" PRId64, unit);
    return false;
}

static bool check_pixdim(const struct nifti_header *header, struct error *error)
{
    for (int axis = 1; axis <= 3; axis++) {
        if (header->pixdim[axis] > 0.0 && isfinite(header->pixdim[axis])) continue;
        error_set(error, "pixdim[%d]: expected a voxel's side above 0, got %g", axis, header->pixdim[axis]);
        return false;
    }
    return true;
}

// Builds the rotation of the unit quaternion (a, b, c, d), whose a >= 0 is not stored. pixdim[0] < 0 reverses k.
static bool place_by_qform(double m[12], const struct nifti_header *header, struct error *error)
{
    double b = header->quatern[0], c = header->quatern[1], d = header->quatern[2];
    double rest = 1.0 - (b * b + c * c + d * d);
    double a = rest > 0.0 ? sqrt(rest) : 0.0;
    double length = rest > 0.0 ? 1.0 : sqrt(b * b + c * c + d * d);
    double side[3] = {header->pixdim[1], header->pixdim[2], header->pixdim[3]};

    // In single precision the quaternion of a half turn may be a little longer than 1. A longer one is no rotation.
    if (!(rest > -1e-3)) {
        error_set(error, "quatern_b, c, d: expected a length of at most 1, got (%g, %g, %g)", b, c, d);
        return false;
    }
    if (!check_pixdim(header, error)) return false;
    if (header->pixdim[0] < 0.0) side[2] = -side[2];
    b /= length, c /= length, d /= length;
    const double rotation[3][3] = {
        {a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
        {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
        {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c},
    };
    for (size_t row = 0; row < 3; row++) {
        for (size_t axis = 0; axis < 3; axis++)
            m[4 * row + axis] = rotation[row][axis] * side[axis];
        m[4 * row + 3] = header->qoffset[row];
    }
    return true;
}

// Tries the standard's methods 3, 2 and 1. Method 1 has the origin at the first voxel's centre.
static bool set_placement(struct volume_layout *layout, const struct nifti_header *header, struct error *error)
{
    double *m = layout->index_to_world;
    double metres;

    if (!read_unit(header, &metres, error)) return false;
    if (header->sform_code > 0) {
        memcpy(m, header->srow, sizeof header->srow);
    } else if (header->qform_code > 0) {
        if (!place_by_qform(m, header, error)) return false;
    } else {
        if (!check_pixdim(header, error)) return false;
        for (size_t axis = 0; axis < 3; axis++)
            m[5 * axis] = header->pixdim[axis + 1];
    }
    for (size_t i = 0; i < 12; i++)
        m[i] *= metres;
    if (volume_placement_check(m, error)) return true;
    error_prefix(error, "%s", header->sform_code > 0 ? "srow" : header->qform_code > 0 ? "qform" : "pixdim");
    return false;
}

static bool go_to_voxels(const struct volume_layout *layout, const struct nifti_header *header, struct error *error)
{
    int64_t header_size = header->version == 1 ? HEADER_1_SIZE : HEADER_2_SIZE;
    int64_t least = header_size + 4; // four bytes after the header say whether extensions follow
    double offset = header->vox_offset;

    // Some writers store 0 for the smallest offset.
    if (offset == 0.0) offset = (double)least;
    if (!(offset >= (double)least && offset < 9e15 && offset == floor(offset))) {
        error_set(error, "vox_offset: expected a whole number of at least %" PRId64 ", got %g", least, offset);
        return false;
    }
    return volume_stream_skip(layout->stream, (int64_t)offset - header_size, error);
}

static bool open_nifti(struct volume_layout *layout, const struct volume_source *source, bool is_compressed,
                       struct error *error)
{
    struct nifti_header header = {0};

    if (!volume_stream_open(&layout->stream, source->path, error)) return false;
    if (is_compressed) volume_stream_unzip(layout->stream);
    return read_header(&header, layout->stream, error) && read_size(layout, &header, error) &&
           read_type(layout, &header, error) && read_scaling(layout, &header, error) &&
           set_placement(layout, &header, error) && go_to_voxels(layout, &header, error) &&
           volume_layout_check_length(layout, error);
}

bool volume_nifti_open(struct volume_layout *layout, const struct volume_source *source, struct error *error)
{
    return open_nifti(layout, source, false, error);
}

bool volume_nifti_gzip_open(struct volume_layout *layout, const struct volume_source *source, struct error *error)
{
    return open_nifti(layout, source, true, error);
}
