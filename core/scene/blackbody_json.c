// SPDX-License-Identifier: Apache-2.0
#include "core/scene/blackbody_json.h"

#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

static const struct timeline_limits INTENSITY = {.components = 1, .min = 0.0, .max = 1e15};

bool blackbody_from_json(struct scene_blackbody *blackbody, const struct scene_reader *medium,
                         const struct scene_density *density)
{
    static const char *const keys[] = {"grid", "kelvin", "intensity", NULL};
    struct json_node object = json_node_child(medium->object, "blackbody");
    struct scene_reader reader = {&object, medium->span, medium->error};

    if (json_node_is_absent(&object)) return true;
    if (!json_check_object(&object, reader.error) || !json_check_keys(&object, keys, reader.error)) return false;
    if (density->kind != SCENE_DENSITY_GRID || !scene_grid_is_vdb(&density->grid))
        return json_fail(
            &object, reader.error,
            "only beside a density of kind \"grid\" from a .nvdb or .vdb file, which holds its temperature");
    return scene_reader_read_grid_name(&reader, &blackbody->grid_name) &&
           scene_reader_read(&reader, "kelvin", &SCENE_SCALE, &blackbody->kelvin) &&
           scene_reader_read_or(&reader, "intensity", &INTENSITY, 1.0, &blackbody->intensity);
}
