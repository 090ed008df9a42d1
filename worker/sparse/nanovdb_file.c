// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/nanovdb_file.h"

#include "core/base/error.h"
#include "worker/sparse/nanovdb_leaf.h"
#include "worker/volume/volume_memory.h"

#include <blosc.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum {
    HEADER_BYTES = 16,
    METADATA_BYTES = 176, // of a grid's metadata before its name
    MAJOR_VERSION = 32,   // the layout in memory; minor versions share it
    NAME_LIMIT = 4096,
    RATIO_LIMIT = 1032 // the largest ratio that deflate reaches; LZ4, which Blosc packs with, reaches 255
};

enum codec { CODEC_NONE, CODEC_ZIP, CODEC_BLOSC };

enum { TYPE_COUNT = 20 };

// "NanoVDB0", and the magic of files since version 32.6.
static const uint64_t magic_first = 0x304244566f6e614e, magic_file = 0x324244566f6e614e;

static const char *const type_names[TYPE_COUNT] = {"unknown", "float", "double", "int16",  "int32",   "int64", "vec3f",
                                                   "vec3d",   "mask",  "half",   "uint32", "boolean", "rgba8", "fp4",
                                                   "fp8",     "fp16",  "fpn",    "vec4f",  "vec4d",   "index"};

struct grid_entry {
    const char *name; // in the file; ends in NUL
    uint32_t type;
    uint64_t grid_bytes, file_bytes;
    uint64_t offset; // of the packed grid in the file
    enum codec codec;
};

// The rest of a file that is being read.
struct reader {
    const unsigned char *bytes;
    uint64_t size_bytes, at;
};

static uint16_t read_u16(const unsigned char *bytes)
{
    uint16_t value;

    memcpy(&value, bytes, sizeof value);
    return value;
}

static uint32_t read_u32(const unsigned char *bytes)
{
    uint32_t value;

    memcpy(&value, bytes, sizeof value);
    return value;
}

static uint64_t read_u64(const unsigned char *bytes)
{
    uint64_t value;

    memcpy(&value, bytes, sizeof value);
    return value;
}

static const unsigned char *take(struct reader *reader, uint64_t count, const char *what, struct error *error)
{
    const unsigned char *taken = reader->bytes + reader->at;

    if (count > reader->size_bytes - reader->at) {
        error_set(error, "%s: expected %" PRIu64 " bytes at byte %" PRIu64 ", got %" PRIu64 ": the file is cut short",
                  what, count, reader->at, reader->size_bytes - reader->at);
        return NULL;
    }
    reader->at += count;
    return taken;
}

struct segment {
    unsigned grid_count;
    enum codec codec;
};

static bool read_segment(struct reader *reader, struct segment *segment, struct error *error)
{
    const unsigned char *header = take(reader, HEADER_BYTES, "segment", error);
    unsigned major;

    if (!header) return false;
    if (read_u64(header) != magic_first && read_u64(header) != magic_file) {
        error_set(error, "expected a NanoVDB file (\"NanoVDB0\" at byte %" PRIu64 ")", reader->at - HEADER_BYTES);
        return false;
    }
    major = read_u32(header + 8) >> 21;
    if (major != MAJOR_VERSION) {
        error_set(error, "version: expected NanoVDB %d, got %u; convert the source again", MAJOR_VERSION, major);
        return false;
    }
    segment->grid_count = read_u16(header + 12);
    if (read_u16(header + 14) > CODEC_BLOSC) {
        error_set(error, "codec: expected none, zip or Blosc, got number %u", (unsigned)read_u16(header + 14));
        return false;
    }
    segment->codec = read_u16(header + 14);
    return true;
}

// The metadata of all grids come before the segment's grids.
static bool read_entry(struct reader *reader, const struct segment *segment, struct grid_entry *entry,
                       struct error *error)
{
    const unsigned char *metadata = take(reader, METADATA_BYTES, "grid", error), *name;
    uint32_t name_bytes;

    if (!metadata) return false;
    name_bytes = read_u32(metadata + 136);
    if (name_bytes == 0 || name_bytes > NAME_LIMIT) {
        error_set(error, "grid name: expected 1 to %d bytes, got %" PRIu32, NAME_LIMIT, name_bytes);
        return false;
    }
    name = take(reader, name_bytes, "grid name", error);
    if (!name) return false;
    if (name[name_bytes - 1] != '\0') {
        error_set(error, "grid name: expected to end in NUL");
        return false;
    }
    *entry = (struct grid_entry){.name = (const char *)name,
                                 .type = read_u32(metadata + 32),
                                 .grid_bytes = read_u64(metadata),
                                 .file_bytes = read_u64(metadata + 8),
                                 .codec = segment->codec};
    return true;
}

static bool is_wanted(const struct grid_entry *entry, const char *name)
{
    return name ? strcmp(entry->name, name) == 0 : nanovdb_leaf_has_floats(entry->type);
}

// Searches a segment for the grid and moves the reader behind the segment.
static bool search_segment(struct reader *reader, const char *name, struct grid_entry *found, struct error *error)
{
    struct segment segment;
    struct reader metadata;
    struct grid_entry entry;

    if (!read_segment(reader, &segment, error)) return false;
    metadata = *reader;
    for (unsigned i = 0; i < segment.grid_count; ++i)
        if (!read_entry(reader, &segment, &entry, error)) return false;
    for (unsigned i = 0; i < segment.grid_count; ++i) {
        if (!read_entry(&metadata, &segment, &entry, error)) return false;
        entry.offset = reader->at;
        if (!take(reader, entry.file_bytes, entry.name, error)) return false;
        if (!found->name && is_wanted(&entry, name)) *found = entry;
    }
    return true;
}

static void set_missing_error(const struct nanovdb_bytes *file, const char *name, struct error *error)
{
    struct reader reader = {file->bytes, file->size_bytes, 0};
    char names[512] = "";
    size_t length = 0;

    while (reader.at < reader.size_bytes) {
        struct segment segment;
        struct grid_entry entry;
        uint64_t grids_bytes = 0;

        if (!read_segment(&reader, &segment, NULL)) break;
        for (unsigned i = 0; i < segment.grid_count && read_entry(&reader, &segment, &entry, NULL); ++i) {
            const char *type = entry.type < TYPE_COUNT ? type_names[entry.type] : "unknown";

            if (length < sizeof names)
                length += (size_t)snprintf(names + length, sizeof names - length, "%s\"%s\" (%s)", length ? ", " : "",
                                           entry.name, type);
            grids_bytes += entry.file_bytes;
        }
        if (!take(&reader, grids_bytes, "grids", NULL)) break;
    }
    if (name)
        error_set(error, "no grid is named \"%s\"; there are %s", name, length ? names : "none");
    else
        error_set(error, "expected a grid of floats; there are %s", length ? names : "none");
}

// Memory for a grid that `packed_bytes` are to unpack to.
static void *allocate_grid(const struct grid_entry *entry, uint64_t packed_bytes, const char *codec,
                           struct error *error)
{
    void *grid;

    if (entry->grid_bytes / RATIO_LIMIT > packed_bytes) {
        error_set(error, "%s: %" PRIu64 " bytes cannot unpack to %" PRIu64, codec, packed_bytes, entry->grid_bytes);
        return NULL;
    }
    if (!volume_memory_check((int64_t)entry->grid_bytes, volume_memory_limit(), error)) return NULL;
    grid = malloc(entry->grid_bytes ? entry->grid_bytes : 1);
    if (!grid) error_set(error, "out of memory for %" PRIu64 " bytes", entry->grid_bytes);
    return grid;
}

static void *inflate_grid(const struct nanovdb_bytes *file, const struct grid_entry *entry, struct error *error)
{
    const unsigned char *packed = (const unsigned char *)file->bytes + entry->offset;
    uLongf grid_bytes = entry->grid_bytes;
    void *grid;

    if (entry->file_bytes < 8 || read_u64(packed) != entry->file_bytes - 8) {
        error_set(error, "zip: the packed size differs from the one in the grid's entry");
        return NULL;
    }
    grid = allocate_grid(entry, entry->file_bytes - 8, "zip", error);
    if (!grid) return NULL;
    if (uncompress(grid, &grid_bytes, packed + 8, entry->file_bytes - 8) != Z_OK || grid_bytes != entry->grid_bytes) {
        error_set(error, "zip: the packed grid is damaged");
        free(grid);
        return NULL;
    }
    return grid;
}

// Chunks of at most 1 GiB, each with its packed size before it. True when they are the whole grid.
static bool unpack_chunks(struct reader *packed, unsigned char *grid, uint64_t grid_bytes)
{
    uint64_t done = 0;

    while (done < grid_bytes) {
        const unsigned char *size = take(packed, 8, "chunk", NULL);
        const unsigned char *chunk = size ? take(packed, read_u64(size), "chunk", NULL) : NULL;
        uint64_t room = grid_bytes - done < INT_MAX ? grid_bytes - done : INT_MAX;
        size_t count = 0;

        if (!chunk || blosc_cbuffer_validate(chunk, read_u64(size), &count) != 0 || count == 0 || count > room ||
            blosc_decompress_ctx(chunk, grid + done, room, 1) != (int)count)
            return false;
        done += count;
    }
    return packed->at == packed->size_bytes;
}

static void *unblosc_grid(const struct nanovdb_bytes *file, const struct grid_entry *entry, struct error *error)
{
    struct reader packed = {(const unsigned char *)file->bytes + entry->offset, entry->file_bytes, 0};
    void *grid = allocate_grid(entry, entry->file_bytes, "Blosc", error);

    if (!grid || unpack_chunks(&packed, grid, entry->grid_bytes)) return grid;
    error_set(error, "Blosc: the packed grid is damaged");
    free(grid);
    return NULL;
}

static void *copy_grid(const struct nanovdb_bytes *file, const struct grid_entry *entry, struct error *error)
{
    void *grid;

    if (entry->file_bytes != entry->grid_bytes) {
        error_set(error, "the grid's sizes in the file and in memory differ: %" PRIu64 " and %" PRIu64,
                  entry->file_bytes, entry->grid_bytes);
        return NULL;
    }
    grid = malloc(entry->grid_bytes ? entry->grid_bytes : 1);
    if (grid)
        memcpy(grid, (const char *)file->bytes + entry->offset, entry->grid_bytes);
    else
        error_set(error, "out of memory for %" PRIu64 " bytes", entry->grid_bytes);
    return grid;
}

static void *unpack(const struct nanovdb_bytes *file, const struct grid_entry *entry, struct error *error)
{
    if (!nanovdb_leaf_has_floats(entry->type)) {
        error_set(error, "expected float values, got %s",
                  entry->type < TYPE_COUNT ? type_names[entry->type] : "unknown ones");
        return NULL;
    }
    switch (entry->codec) {
    case CODEC_ZIP:
        return inflate_grid(file, entry, error);
    case CODEC_BLOSC:
        return unblosc_grid(file, entry, error);
    default:
        return copy_grid(file, entry, error);
    }
}

void *nanovdb_file_unpack(const struct nanovdb_bytes *file, const char *name, struct nanovdb_unpacked *unpacked,
                          struct error *error)
{
    struct reader reader = {file->bytes, file->size_bytes, 0};
    struct grid_entry entry = {0};
    void *grid;

    do
        if (!search_segment(&reader, name, &entry, error)) return NULL;
    while (!entry.name && reader.at < reader.size_bytes);
    if (!entry.name) {
        set_missing_error(file, name, error);
        return NULL;
    }
    grid = unpack(file, &entry, error);
    if (!grid) error_prefix(error, "grid \"%s\"", entry.name);
    *unpacked = (struct nanovdb_unpacked){.size_bytes = entry.grid_bytes, .type = entry.type};
    return grid;
}
