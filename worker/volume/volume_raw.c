// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_layout.h"

#include "core/base/error.h"
#include "worker/volume/volume_placement.h"
#include "worker/volume/volume_stream.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    enum volume_stored stored;
} types[] = {
    [SCENE_VOXEL_UINT8] = {"uint8", VOLUME_STORED_UINT8},
    [SCENE_VOXEL_UINT16] = {"uint16", VOLUME_STORED_UINT16},
    [SCENE_VOXEL_INT16] = {"int16", VOLUME_STORED_INT16},
    [SCENE_VOXEL_FLOAT32] = {"float32", VOLUME_STORED_FLOAT32},
};

enum { TYPE_COUNT = sizeof types / sizeof types[0] };

// What a name like "head_256x256x109xuint8.raw" says; zero for what it does not say.
struct name_facts {
    int64_t size[3];
    bool has_size;
    enum volume_stored stored;
    bool has_type;
};

// Reads a number without sign or blanks; -1 if there is none.
static int64_t read_number(const char **text)
{
    int64_t number = 0;

    if (!isdigit((unsigned char)**text)) return -1;
    for (; isdigit((unsigned char)**text); (*text)++)
        if (number < VOLUME_VOXEL_LIMIT) number = 10 * number + (**text - '0');
    return number;
}

// Reads "WxHxD" at `text` and moves `text` behind it.
static bool read_size(const char **text, int64_t size[3])
{
    const char *at = *text;

    for (int axis = 0; axis < 3; axis++) {
        if (axis > 0 && *at++ != 'x') return false;
        size[axis] = read_number(&at);
        if (size[axis] < 0) return false;
    }
    *text = at;
    return true;
}

// Reads a type at `text`. The word must end there: "uint8x2" has none.
static bool read_type(const char *text, enum volume_stored *stored)
{
    for (size_t i = 0; i < TYPE_COUNT; i++) {
        size_t length = strlen(types[i].name);

        if (strncasecmp(text, types[i].name, length) != 0 || isalnum((unsigned char)text[length])) continue;
        *stored = types[i].stored;
        return true;
    }
    return false;
}

// The last size in the name counts, and the word after it, because folders and names may have other numbers.
static struct name_facts read_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    struct name_facts facts = {0};

    for (const char *at = name; *at;) {
        int64_t size[3];

        if ((at > name && isalnum((unsigned char)at[-1])) || !read_size(&at, size)) {
            at++;
            continue;
        }
        memcpy(facts.size, size, sizeof size);
        facts.has_size = true;
        facts.has_type = (*at == 'x' || *at == '_') && read_type(at + 1, &facts.stored);
    }
    return facts;
}

static bool read_keys(struct volume_layout *layout, const struct volume_source *source, struct error *error)
{
    const struct scene_raw *raw = &source->raw;
    struct name_facts facts = read_name(source->path);
    bool has_size = raw->size[0] || raw->size[1] || raw->size[2];
    const char *field = has_size ? "size" : "the name's size";

    for (int axis = 0; has_size && axis < 3; axis++)
        facts.size[axis] = raw->size[axis];
    if (!has_size && !facts.has_size) {
        error_set(error, "expected \"size\" or a name like head_256x256x109xuint8.raw");
        return false;
    }
    if (!raw->has_type && !facts.has_type) {
        error_set(error,
                  "expected \"type\" (uint8, uint16, int16 or float32) or a name like head_256x256x109xuint8.raw");
        return false;
    }
    layout->stored = raw->has_type ? types[raw->type].stored : facts.stored;
    layout->is_big_endian = raw->is_big_endian;
    return volume_layout_set_size(layout, field, facts.size, error);
}

// Writes which other keys would fit a file with `left` bytes for the voxels; an empty text when none would.
static void describe_fit(const struct volume_layout *layout, int64_t left, int64_t skip_bytes, char *text,
                         size_t text_size)
{
    int64_t voxels = volume_layout_voxels(layout), expected = volume_layout_bytes(layout);
    int64_t slice = expected / layout->size[2];
    size_t used = 0;

    text[0] = '\0';
    for (size_t i = 0; i < TYPE_COUNT; i++)
        if (voxels * (int64_t)volume_stored_size(types[i].stored) == left)
            used += (size_t)snprintf(text + used, text_size - used, ", type %s would fit", types[i].name);
    if (left >= slice && left % slice == 0)
        used += (size_t)snprintf(text + used, text_size - used, ", size [%d, %d, %" PRId64 "] would fit",
                                 layout->size[0], layout->size[1], left / slice);
    if (left > expected)
        snprintf(text + used, text_size - used, ", skip_bytes %" PRId64 " would fit", skip_bytes + left - expected);
}

static bool check_length(const struct volume_layout *layout, int64_t skip_bytes, struct error *error)
{
    int64_t left = volume_stream_left(layout->stream), expected = volume_layout_bytes(layout);
    char fit[256];

    if (left == expected) return true;
    describe_fit(layout, left, skip_bytes, fit, sizeof fit);
    error_set(error, "expected %d x %d x %d voxels of %s, %" PRId64 " bytes, got %" PRId64 " bytes%s", layout->size[0],
              layout->size[1], layout->size[2], volume_stored_name(layout->stored), expected, left, fit);
    return false;
}

bool volume_raw_open(struct volume_layout *layout, const struct volume_source *source, struct error *error)
{
    if (!read_keys(layout, source, error)) return false;
    layout->slope = 1.0;
    volume_placement_unit(layout->index_to_world, layout->size);
    return volume_stream_open(&layout->stream, source->path, error) &&
           volume_stream_skip(layout->stream, source->raw.skip_bytes, error) &&
           check_length(layout, source->raw.skip_bytes, error);
}
