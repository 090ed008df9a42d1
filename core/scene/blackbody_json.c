// SPDX-License-Identifier: Apache-2.0
#include "core/scene/blackbody_json.h"

#include "core/scene/file_format.h"
#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

#include <stdlib.h>

static const struct timeline_limits INTENSITY = {.components = 1, .min = 0.0, .max = 1e15};

static bool fail_density(const struct json_node *object, struct error *error)
{
    char *endings = file_format_list_endings(FILE_GRID_SPARSE, "or");

    (void)json_fail(object, error, "only beside a density of kind \"grid\" from a %s file, which holds its temperature",
                    endings);
    free(endings);
    return false;
}

bool blackbody_from_json(struct scene_blackbody *blackbody, const struct scene_reader *medium,
                         const struct scene_density *density)
{
    static const char *const keys[] = {"grid", "kelvin", "intensity", NULL};
    struct json_node object = json_node_child(medium->object, "blackbody");
    struct scene_reader reader = {&object, medium->span, medium->error};

    if (json_node_is_absent(&object)) return true;
    if (!json_check_object(&object, reader.error) || !json_check_keys(&object, keys, reader.error)) return false;
    if (density->kind != SCENE_DENSITY_GRID || !scene_grid_is_sparse(&density->grid))
        return fail_density(&object, reader.error);
    return scene_reader_read_grid_name(&reader, &blackbody->grid_name) &&
           scene_reader_read(&reader, "kelvin", &SCENE_SCALE, &blackbody->kelvin) &&
           scene_reader_read_or(&reader, "intensity", &INTENSITY, 1.0, &blackbody->intensity);
}
