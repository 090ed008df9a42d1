// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_rules.h"
#include "core/scene/scene_reader.h"

static bool read(struct scene_density *density, const struct scene_reader *reader)
{
    static const char *const keys[] = {"kind", "bounds", "scale", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read_or(reader, "scale", &SCENE_SCALE, 1.0, &density->homogeneous.scale);
}

static void visit_timelines(struct scene_density *density, timeline_visitor *visit, void *user)
{
    visit("scale", &density->homogeneous.scale, user);
}

const struct density_rules density_rules_homogeneous = {
    .name = "homogeneous", .is_even = true, .read = read, .visit = visit_timelines};
