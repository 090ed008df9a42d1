// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_layout.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/volume/volume_nrrd_header.h"
#include "worker/volume/volume_placement.h"
#include "worker/volume/volume_stream.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    enum volume_stored stored;
} types[] = {
    {"signed char", VOLUME_STORED_INT8},
    {"int8", VOLUME_STORED_INT8},
    {"int8_t", VOLUME_STORED_INT8},
    {"uchar", VOLUME_STORED_UINT8},
    {"unsigned char", VOLUME_STORED_UINT8},
    {"uint8", VOLUME_STORED_UINT8},
    {"uint8_t", VOLUME_STORED_UINT8},
    {"short", VOLUME_STORED_INT16},
    {"short int", VOLUME_STORED_INT16},
    {"signed short", VOLUME_STORED_INT16},
    {"signed short int", VOLUME_STORED_INT16},
    {"int16", VOLUME_STORED_INT16},
    {"int16_t", VOLUME_STORED_INT16},
    {"ushort", VOLUME_STORED_UINT16},
    {"unsigned short", VOLUME_STORED_UINT16},
    {"unsigned short int", VOLUME_STORED_UINT16},
    {"uint16", VOLUME_STORED_UINT16},
    {"uint16_t", VOLUME_STORED_UINT16},
    {"int", VOLUME_STORED_INT32},
    {"signed int", VOLUME_STORED_INT32},
    {"int32", VOLUME_STORED_INT32},
    {"int32_t", VOLUME_STORED_INT32},
    {"uint", VOLUME_STORED_UINT32},
    {"unsigned int", VOLUME_STORED_UINT32},
    {"uint32", VOLUME_STORED_UINT32},
    {"uint32_t", VOLUME_STORED_UINT32},
    {"longlong", VOLUME_STORED_INT64},
    {"long long", VOLUME_STORED_INT64},
    {"long long int", VOLUME_STORED_INT64},
    {"signed long long", VOLUME_STORED_INT64},
    {"signed long long int", VOLUME_STORED_INT64},
    {"int64", VOLUME_STORED_INT64},
    {"int64_t", VOLUME_STORED_INT64},
    {"ulonglong", VOLUME_STORED_UINT64},
    {"unsigned long long", VOLUME_STORED_UINT64},
    {"unsigned long long int", VOLUME_STORED_UINT64},
    {"uint64", VOLUME_STORED_UINT64},
    {"uint64_t", VOLUME_STORED_UINT64},
    {"float", VOLUME_STORED_FLOAT32},
    {"double", VOLUME_STORED_FLOAT64},
};

enum { TYPE_COUNT = sizeof types / sizeof types[0] };

// Spaces, and the signs that map their axes to right, anterior, superior (or to a right-handed world).
static const struct space {
    const char *name, *short_name;
    double signs[3];
    bool is_medical; // lengths without a unit are millimetres
} spaces[] = {
    {"right-anterior-superior", "RAS", {1, 1, 1}, true},      {"left-anterior-superior", "LAS", {-1, 1, 1}, true},
    {"left-posterior-superior", "LPS", {-1, -1, 1}, true},    {"scanner-xyz", "scanner-xyz", {1, 1, 1}, true},
    {"3D-right-handed", "3D-right-handed", {1, 1, 1}, false}, {"3D-left-handed", "3D-left-handed", {1, 1, -1}, false},
};

enum { SPACE_COUNT = sizeof spaces / sizeof spaces[0] };

static const struct {
    const char *name;
    double metres;
} units[] = {
    {"m", 1},     {"meter", 1},     {"cm", 1e-2},         {"mm", 1e-3},        {"millimeter", 1e-3},
    {"um", 1e-6}, {"micron", 1e-6}, {"micrometer", 1e-6}, {"\302\265m", 1e-6}, {"\316\274m", 1e-6},
    {"nm", 1e-9},
};

enum { UNIT_COUNT = sizeof units / sizeof units[0] };

struct nrrd {
    struct volume_nrrd_header header;
    struct volume_layout *layout; // borrowed
    const char *path;             // borrowed
};

// Sets the error "FIELD: expected WHAT, got "TEXT"", the text shortened and made printable.
static bool fail_expected(const struct nrrd *nrrd, enum volume_nrrd_field field, const char *expected,
                          struct error *error)
{
    const char *text = nrrd->header.texts[field];
    char shown[48];

    if (!text) {
        error_set(error, "%s: expected %s, got nothing", volume_nrrd_field_name(field), expected);
        return false;
    }
    snprintf(shown, sizeof shown, "%s", text);
    for (char *at = shown; *at; at++)
        if (!isprint((unsigned char)*at)) *at = '?';
    error_set(error, "%s: expected %s, got \"%s\"%s", volume_nrrd_field_name(field), expected, shown,
              strlen(text) >= sizeof shown ? "..." : "");
    return false;
}

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " \t");
}

// Reads exactly `count` whole numbers.
static bool read_integers(const struct nrrd *nrrd, enum volume_nrrd_field field, size_t count, int64_t *numbers)
{
    const char *text = nrrd->header.texts[field];

    if (!text) return false;
    for (size_t i = 0; i < count; i++) {
        char *end;

        errno = 0;
        numbers[i] = strtoll(text, &end, 10);
        if (end == text || errno != 0 || (*end && !isblank((unsigned char)*end))) return false;
        text = skip_blanks(end);
    }
    return !*text;
}

// Returns the text after the number, or NULL.
static const char *read_double(const char *text, double *number)
{
    char *end;

    *number = strtod(text, &end);
    return end == text ? NULL : skip_blanks(end);
}

// Reads "(x,y,z)"; returns the text after it, or NULL.
static const char *read_vector(const char *text, double vector[3])
{
    for (size_t i = 0; i < 3; i++) {
        if (*text != (i == 0 ? '(' : ',')) return NULL;
        text = read_double(skip_blanks(text + 1), &vector[i]);
        if (!text) return NULL;
    }
    return *text == ')' ? skip_blanks(text + 1) : NULL;
}

static bool read_layout(struct nrrd *nrrd, struct error *error)
{
    const char *type = nrrd->header.texts[NRRD_TYPE];
    const char *endian = nrrd->header.texts[NRRD_ENDIAN];
    int64_t dimension;
    int64_t size[3];
    size_t i = 0;

    if (!read_integers(nrrd, NRRD_DIMENSION, 1, &dimension) || dimension != 3)
        return fail_expected(nrrd, NRRD_DIMENSION, "3 (one number a voxel)", error);
    if (!read_integers(nrrd, NRRD_SIZES, 3, size)) return fail_expected(nrrd, NRRD_SIZES, "3 whole numbers", error);
    if (!volume_layout_set_size(nrrd->layout, "sizes", size, error)) return false;
    while (type && i < TYPE_COUNT && strcasecmp(type, types[i].name) != 0)
        i++;
    if (!type || i == TYPE_COUNT)
        return fail_expected(nrrd, NRRD_TYPE, "a number type like \"unsigned char\", \"short\" or \"float\"", error);
    nrrd->layout->stored = types[i].stored;
    if (volume_stored_size(types[i].stored) == 1) return true;
    if (!endian || (strcasecmp(endian, "little") != 0 && strcasecmp(endian, "big") != 0))
        return fail_expected(nrrd, NRRD_ENDIAN, "\"little\" or \"big\"", error);
    nrrd->layout->is_big_endian = strcasecmp(endian, "big") == 0;
    return true;
}

// Refuses axes of colours, times or vectors, which are no axes of space.
static bool check_kinds(const struct nrrd *nrrd, struct error *error)
{
    const char *text = nrrd->header.texts[NRRD_KINDS];
    static const char *const names[] = {"domain", "space", "none", "???"};

    while (text && *text) {
        size_t length = strcspn(text, " \t");
        bool is_known = false;

        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
            is_known |= strlen(names[i]) == length && strncasecmp(text, names[i], length) == 0;
        if (!is_known) return fail_expected(nrrd, NRRD_KINDS, "\"domain\" or \"space\" for each axis", error);
        text = skip_blanks(text + length);
    }
    return true;
}

// Reads three quoted units as metres. An empty unit, and each unit of a missing field, is `otherwise`.
static bool read_units(const struct nrrd *nrrd, enum volume_nrrd_field field, double otherwise, double metres[3],
                       struct error *error)
{
    const char *expected = "three of \"m\", \"cm\", \"mm\", \"um\", \"nm\" in quotes";
    const char *text = nrrd->header.texts[field];

    for (size_t axis = 0; axis < 3; axis++) {
        const char *end;
        size_t length;
        size_t i = 0;

        metres[axis] = otherwise;
        if (!text) continue;
        end = *text == '"' ? strchr(text + 1, '"') : NULL;
        if (!end) return fail_expected(nrrd, field, expected, error);
        length = (size_t)(end - text - 1);
        while (i < UNIT_COUNT && (strlen(units[i].name) != length || strncmp(text + 1, units[i].name, length) != 0))
            i++;
        if (length > 0 && i == UNIT_COUNT) return fail_expected(nrrd, field, expected, error);
        if (length > 0) metres[axis] = units[i].metres;
        text = skip_blanks(end + 1);
    }
    return !text || !*text || fail_expected(nrrd, field, expected, error);
}

// Sets `*space` to NULL when no space is named.
static bool find_space(const struct nrrd *nrrd, const struct space **space, struct error *error)
{
    const char *text = nrrd->header.texts[NRRD_SPACE];
    int64_t dimension;

    *space = NULL;
    for (size_t i = 0; text && i < SPACE_COUNT; i++)
        if (strcasecmp(text, spaces[i].name) == 0 || strcasecmp(text, spaces[i].short_name) == 0) *space = &spaces[i];
    if (text && !*space)
        return fail_expected(nrrd, NRRD_SPACE, "a space of three dimensions like \"left-posterior-superior\"", error);
    if (!nrrd->header.texts[NRRD_SPACE_DIMENSION]) return true;
    if (text) {
        error_set(error, "space dimension: not allowed beside \"space\"");
        return false;
    }
    return (read_integers(nrrd, NRRD_SPACE_DIMENSION, 1, &dimension) && dimension == 3) ||
           fail_expected(nrrd, NRRD_SPACE_DIMENSION, "3", error);
}

// Without an origin the grid is centred at the world's origin.
static bool place_in_space(const struct nrrd *nrrd, const struct space *space, struct error *error)
{
    const char *text = nrrd->header.texts[NRRD_SPACE_DIRECTIONS];
    const char *origin_text = nrrd->header.texts[NRRD_SPACE_ORIGIN];
    double *m = nrrd->layout->index_to_world;
    double vectors[4][3] = {0}; // of the three axes, then the origin
    double metres[3];

    if (!read_units(nrrd, NRRD_SPACE_UNITS, space && space->is_medical ? 1e-3 : 1.0, metres, error)) return false;
    for (size_t axis = 0; text && axis < 3; axis++)
        text = read_vector(text, vectors[axis]);
    if (!text || *text) return fail_expected(nrrd, NRRD_SPACE_DIRECTIONS, "three vectors like (1,0,0)", error);
    for (size_t row = 0; row < 3; row++)
        for (size_t axis = 0; axis < 3; axis++)
            vectors[3][row] -= 0.5 * (nrrd->layout->size[axis] - 1) * vectors[axis][row];
    if (origin_text) {
        origin_text = read_vector(origin_text, vectors[3]);
        if (!origin_text || *origin_text) return fail_expected(nrrd, NRRD_SPACE_ORIGIN, "a vector like (0,0,0)", error);
    }
    for (size_t row = 0; row < 3; row++)
        for (size_t axis = 0; axis < 4; axis++)
            m[4 * row + axis] = vectors[axis][row] * metres[row] * (space ? space->signs[row] : 1.0);
    if (volume_placement_check(m, error)) return true;
    error_prefix(error, "space directions");
    return false;
}

// Only the sides of voxels are known, so the grid is centred at the origin. NaN for all three means that they are
// unknown.
static bool place_by_spacings(const struct nrrd *nrrd, const struct space *space, struct error *error)
{
    const char *text = nrrd->header.texts[NRRD_SPACINGS];
    double spacing[3];
    double metres[3];

    if (!read_units(nrrd, NRRD_UNITS, space && space->is_medical ? 1e-3 : 1.0, metres, error)) return false;
    for (size_t axis = 0; text && axis < 3; axis++)
        text = read_double(text, &spacing[axis]);
    if (!text || *text) return fail_expected(nrrd, NRRD_SPACINGS, "3 numbers", error);
    if (isnan(spacing[0]) && isnan(spacing[1]) && isnan(spacing[2])) {
        volume_placement_unit(nrrd->layout->index_to_world, nrrd->layout->size);
        return true;
    }
    for (size_t axis = 0; axis < 3; axis++) {
        if (!(spacing[axis] > 0.0 && isfinite(spacing[axis])))
            return fail_expected(nrrd, NRRD_SPACINGS, "3 numbers above 0", error);
        spacing[axis] *= metres[axis];
    }
    volume_placement_centered(nrrd->layout->index_to_world, nrrd->layout->size, spacing);
    return true;
}

static bool set_placement(const struct nrrd *nrrd, struct error *error)
{
    char *const *texts = nrrd->header.texts;
    const struct space *space;

    if (!find_space(nrrd, &space, error)) return false;
    if (texts[NRRD_SPACE_DIRECTIONS]) {
        if (texts[NRRD_SPACINGS]) {
            error_set(error, "spacings: not allowed beside \"space directions\"");
            return false;
        }
        if (space || texts[NRRD_SPACE_DIMENSION]) return place_in_space(nrrd, space, error);
        return fail_expected(nrrd, NRRD_SPACE, "a name, as there are \"space directions\"", error);
    }
    if (texts[NRRD_SPACINGS]) return place_by_spacings(nrrd, space, error);
    if (texts[NRRD_AXIS_MINS] || texts[NRRD_AXIS_MAXS])
        return fail_expected(nrrd, NRRD_SPACINGS, "the voxels' sides (\"axis mins\" and \"axis maxs\" are not read)",
                             error);
    volume_placement_unit(nrrd->layout->index_to_world, nrrd->layout->size);
    return true;
}

// Opens the file that "data file" names; a relative name is relative to the header's folder.
static bool open_data_file(struct nrrd *nrrd, struct error *error)
{
    const char *name = nrrd->header.texts[NRRD_DATA_FILE];
    const char *slash = strrchr(nrrd->path, '/');
    char *path;
    bool ok;

    if (!*name || strncmp(name, "LIST", 4) == 0 || strchr(name, '%'))
        return fail_expected(nrrd, NRRD_DATA_FILE, "one file (neither LIST nor a pattern)", error);
    volume_stream_close(nrrd->layout->stream);
    nrrd->layout->stream = NULL;
    if (name[0] == '/' || !slash)
        path = xstrdup(name);
    else
        path = xasprintf("%.*s%s", (int)(slash + 1 - nrrd->path), nrrd->path, name);
    ok = volume_stream_open(&nrrd->layout->stream, path, error);
    if (!ok) error_prefix(error, "data file %s", path);
    free(path);
    return ok;
}

static bool skip_lines(struct volume_stream *stream, int64_t count, struct error *error)
{
    int byte = 0;

    while (count > 0) {
        if (!volume_stream_read_byte(stream, &byte, error)) return false;
        if (byte == '\n') count--;
        if (byte >= 0) continue;
        error_set(error, "line skip: the file ends %" PRId64 " lines before", count);
        return false;
    }
    return true;
}

// Skips lines, then bytes after decompression. -1 bytes means that the voxels are at the file's end.
static bool go_to_voxels(const struct nrrd *nrrd, struct error *error)
{
    struct volume_stream *stream = nrrd->layout->stream;
    const char *encoding = nrrd->header.texts[NRRD_ENCODING];
    bool is_raw = encoding && strcasecmp(encoding, "raw") == 0;
    int64_t lines = 0, bytes = 0;

    if (!is_raw && (!encoding || (strcasecmp(encoding, "gzip") != 0 && strcasecmp(encoding, "gz") != 0)))
        return fail_expected(nrrd, NRRD_ENCODING, "\"raw\" or \"gzip\"", error);
    if (nrrd->header.texts[NRRD_LINE_SKIP] && (!read_integers(nrrd, NRRD_LINE_SKIP, 1, &lines) || lines < 0))
        return fail_expected(nrrd, NRRD_LINE_SKIP, "a whole number of at least 0", error);
    if (nrrd->header.texts[NRRD_BYTE_SKIP] && (!read_integers(nrrd, NRRD_BYTE_SKIP, 1, &bytes) || bytes < -is_raw))
        return fail_expected(nrrd, NRRD_BYTE_SKIP, "a whole number of at least 0 (or -1 where the encoding is raw)",
                             error);
    if (!skip_lines(stream, lines, error)) return false;
    if (!is_raw) volume_stream_unzip(stream);
    if (bytes < 0) bytes = volume_stream_left(stream) - volume_layout_bytes(nrrd->layout);
    return (bytes <= 0 || volume_stream_skip(stream, bytes, error)) && volume_layout_check_length(nrrd->layout, error);
}

static bool open_voxels(struct nrrd *nrrd, struct error *error)
{
    bool is_detached = nrrd->header.texts[NRRD_DATA_FILE];

    if (!is_detached && !nrrd->header.has_end) {
        error_set(error,
                  "expected an empty line and the voxels behind the header, or \"data file\", got the file's end");
        return false;
    }
    if (is_detached && !open_data_file(nrrd, error)) return false;
    if (go_to_voxels(nrrd, error)) return true;
    if (is_detached) error_prefix(error, "data file %s", volume_stream_path(nrrd->layout->stream));
    return false;
}

bool volume_nrrd_open(struct volume_layout *layout, const struct volume_source *source, struct error *error)
{
    struct nrrd nrrd = {.layout = layout, .path = source->path};
    bool ok;

    layout->slope = 1.0;
    ok = volume_stream_open(&layout->stream, source->path, error) &&
         volume_nrrd_header_read(&nrrd.header, layout->stream, error) && read_layout(&nrrd, error) &&
         check_kinds(&nrrd, error) && set_placement(&nrrd, error) && open_voxels(&nrrd, error);
    volume_nrrd_header_finish(&nrrd.header);
    return ok;
}
