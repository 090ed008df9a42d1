// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_json.h"

#include "core/scene/bounds_json.h"
#include "core/scene/density_rules.h"
#include "core/scene/scene_reader.h"

#include <string.h>

bool density_from_json(struct scene_density *density, const struct scene_reader *medium)
{
    struct json_node object = json_node_child(medium->object, "density"), kind = json_node_child(&object, "kind");
    struct scene_reader reader = {&object, medium->span, medium->error};
    const char *names[DENSITY_RULES_LIMIT];
    int choice;

    density_rules_list(names);
    if (!json_check_object(&object, reader.error) || !json_read_enum(&kind, names, &choice, reader.error)) return false;
    // After a failure scene_finish frees what was read.
    memset(density, 0, sizeof *density);
    density->kind = (enum scene_density_kind)choice;
    return density_rules_of(density)->read(density, &reader) && bounds_from_json(&density->bounds, &reader);
}
