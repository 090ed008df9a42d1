// SPDX-License-Identifier: Apache-2.0
#include "core/scene/medium_json.h"

#include "core/scene/blackbody_json.h"
#include "core/scene/density_json.h"
#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

static const struct timeline_limits COEFFICIENT = {.min = 0.0, .max = 1e9};
// Beyond this range 1 - |g| has too few digits in a shader's float.
static const struct timeline_limits COSINE = {.components = 1, .min = -0.99999, .max = 0.99999};

static bool read_lobe(const struct scene_reader *reader, struct scene_phase_lobe *lobe)
{
    static const char *const kinds[] = {"henyey_greenstein", "rayleigh", NULL};
    static const char *const keys[] = {"kind", "g", "weight", NULL};
    static const char *const rayleigh_keys[] = {"kind", "weight", NULL};
    int choice = SCENE_LOBE_HENYEY_GREENSTEIN;

    if (!json_check_object(reader->object, reader->error) ||
        !scene_reader_read_choice(reader, "kind", kinds, &choice) ||
        !json_check_keys(reader->object, choice == SCENE_LOBE_RAYLEIGH ? rayleigh_keys : keys, reader->error))
        return false;
    lobe->kind = (enum scene_lobe_kind)choice;
    lobe->g = (struct timeline){.component_count = 1};
    return (lobe->kind == SCENE_LOBE_RAYLEIGH || scene_reader_read(reader, "g", &COSINE, &lobe->g)) &&
           scene_reader_read_or(reader, "weight", &SCENE_SHARE, 1.0, &lobe->weight);
}

static bool read_phase(const struct scene_reader *medium_reader, struct scene_medium *medium)
{
    struct json_node lobes = json_node_child(medium_reader->object, "phase"), lobe = {0};
    struct scene_reader reader = {&lobe, medium_reader->span, medium_reader->error};

    if (json_node_is_absent(&lobes)) return true;
    if (!json_check_array(&lobes, 1, SCENE_LOBE_LIMIT, reader.error)) return false;
    while (json_node_next(&lobes, &lobe))
        if (!read_lobe(&reader, &medium->lobes[medium->lobe_count++])) return false;
    return true;
}

// Refuses the keys that a transfer function replaces.
static bool check_transfer(const struct scene_reader *reader)
{
    static const char *const keys[] = {"sigma_s", "sigma_a", "emission", "phase", "blackbody"};

    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        struct json_node node = json_node_child(reader->object, keys[i]);

        if (!json_node_is_absent(&node))
            return json_fail(&node, reader->error,
                             "not beside a transfer_function, which says how light is absorbed and emitted");
    }
    return true;
}

static bool check_light(const struct scene_reader *reader)
{
    static const char *const keys[] = {"sigma_s", "sigma_a", "emission", "blackbody"};

    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        if (scene_reader_has_key(reader, keys[i])) return true;
    return json_fail(reader->object, reader->error,
                     "expected sigma_s, sigma_a, emission or blackbody, got none of them");
}

static bool check_keys(const struct scene_reader *reader)
{
    static const char *const keys[] = {"density", "sigma_s", "sigma_a", "emission", "blackbody", "phase", NULL};

    return json_check_object(reader->object, reader->error) && json_check_keys(reader->object, keys, reader->error);
}

// Reads all but the density, which has been read.
static bool read_coefficients(struct scene_medium *medium, const struct scene_reader *reader)
{
    const struct scene_density *density = &medium->density;

    if (density->kind == SCENE_DENSITY_GRID && density->grid.point_count > 0 ? !check_transfer(reader)
                                                                             : !check_light(reader))
        return false;
    medium->has_emission = scene_reader_has_key(reader, "emission");
    return scene_reader_read_or(reader, "sigma_s", &COEFFICIENT, 0.0, &medium->sigma_s) &&
           scene_reader_read_or(reader, "sigma_a", &COEFFICIENT, 0.0, &medium->sigma_a) &&
           scene_reader_read_or(reader, "emission", &SCENE_RADIANCE, 0.0, &medium->emission) &&
           blackbody_from_json(&medium->blackbody, reader, density) && read_phase(reader, medium);
}

bool medium_from_json(struct scene_medium *medium, const struct scene_reader *reader)
{
    return check_keys(reader) && density_from_json(&medium->density, reader) && read_coefficients(medium, reader);
}

bool medium_interior_from_json(struct scene_medium *medium, const struct scene_reader *reader)
{
    if (scene_reader_has_key(reader, "density")) return medium_from_json(medium, reader);
    medium->density.kind = SCENE_DENSITY_HOMOGENEOUS;
    medium->density.homogeneous.scale = (struct timeline){.component_count = 1, .value = {1.0}};
    return check_keys(reader) && read_coefficients(medium, reader);
}
