// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_rules.h"
#include "core/scene/scene_reader.h"

static const struct timeline_limits FREQUENCY = {.components = 1, .min = 0.0, .max = 1e9, .excludes_min = true};
static const struct timeline_limits LACUNARITY = {.components = 1, .min = 1.0, .max = 100.0};
static const struct timeline_limits HURST = {.components = 1, .min = 0.0, .max = 10.0};
// Beyond this range nearly every density would be 0 or infinite: the exponent goes from 1 / 1999 to 1999.
static const struct timeline_limits BIAS = {.components = 1, .min = -0.999, .max = 0.999};
static const struct timeline_limits LATTICE = {.components = 3, .min = -1e9, .max = 1e9};

static bool read_rotation(const struct scene_reader *noise_reader, struct scene_noise *noise)
{
    static const char *const keys[] = {"axis", "angle", NULL};
    struct json_node object = json_node_child(noise_reader->object, "rotate");
    struct scene_reader reader = {&object, noise_reader->span, noise_reader->error};

    if (json_node_is_absent(&object))
        return scene_reader_read_direction(&reader, "axis", &noise->axis) &&
               scene_reader_read_or(&reader, "angle", &SCENE_ANGLE, 0.0, &noise->angle);
    return json_check_object(&object, reader.error) && json_check_keys(&object, keys, reader.error) &&
           scene_reader_read_direction(&reader, "axis", &noise->axis) &&
           scene_reader_read(&reader, "angle", &SCENE_ANGLE, &noise->angle);
}

static bool read(struct scene_density *density, const struct scene_reader *reader)
{
    struct scene_noise *noise = &density->noise;
    static const char *const keys[] = {"kind", "bounds", "frequency", "octaves", "lacunarity", "H",
                                       "bias", "mode",   "offset",    "rotate",  "scale",      NULL};
    static const char *const modes[] = {"remap", "clip", "absolute", NULL};
    struct json_node octaves = json_node_child(reader->object, "octaves");
    int64_t count = 1;
    int mode = SCENE_NOISE_REMAP;

    if (!json_check_keys(reader->object, keys, reader->error) ||
        (!json_node_is_absent(&octaves) &&
         !json_read_integer(&octaves, 1, SCENE_OCTAVE_LIMIT, &count, reader->error)) ||
        !scene_reader_read_choice(reader, "mode", modes, &mode))
        return false;
    noise->octaves = (int)count;
    noise->mode = (enum scene_noise_mode)mode;
    return scene_reader_read(reader, "frequency", &FREQUENCY, &noise->frequency) &&
           scene_reader_read_or(reader, "lacunarity", &LACUNARITY, 2.0, &noise->lacunarity) &&
           scene_reader_read_or(reader, "H", &HURST, 1.0, &noise->hurst) &&
           scene_reader_read_or(reader, "bias", &BIAS, 0.0, &noise->bias) &&
           scene_reader_read_or(reader, "offset", &LATTICE, 0.0, &noise->offset) && read_rotation(reader, noise) &&
           scene_reader_read_or(reader, "scale", &SCENE_SCALE, 1.0, &noise->scale);
}

static void visit_timelines(struct scene_density *density, timeline_visitor *visit, void *user)
{
    struct scene_noise *noise = &density->noise;

    visit("frequency", &noise->frequency, user);
    visit("lacunarity", &noise->lacunarity, user);
    visit("hurst", &noise->hurst, user);
    visit("bias", &noise->bias, user);
    visit("offset", &noise->offset, user);
    visit("axis", &noise->axis, user);
    visit("angle", &noise->angle, user);
    visit("scale", &noise->scale, user);
}

static void write_hash_text(const struct scene_density *density, FILE *text)
{
    fprintf(text, " octaves %d mode %d", density->noise.octaves, (int)density->noise.mode);
}

const struct density_rules density_rules_noise = {
    .name = "noise", .read = read, .visit = visit_timelines, .write_hash_text = write_hash_text};
