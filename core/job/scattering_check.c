// SPDX-License-Identifier: Apache-2.0
#include "core/job/scattering_check.h"

#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/scene/light_rules.h"

static bool check_lights(const struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node lights = json_node_child(document, "lights");

    for (size_t i = 0; i < job->scene.light_count; i++) {
        struct json_node light = json_node_element(&lights, i), kind = json_node_child(&light, "kind");

        if (light_rules_of(job->scene.lights[i].kind)->has_size)
            return json_fail(&kind, error, "not rendered yet: only point, sun and spot are");
    }
    return true;
}

bool scattering_check(const struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node scene = json_node_child(document, "scene"), scattering = json_node_child(&scene, "scattering");
    struct json_node orders = json_node_child(&scattering, "orders"), quality = json_node_child(document, "quality");
    struct json_node method = json_node_child(&quality, "method"), grid = json_node_child(&quality, "scatter_grid");

    if (job->scene.orders != 1 && job->quality.method != JOB_METHOD_PATHS && job->quality.scatter_grid == 0)
        return json_fail(&orders, error, "not rendered yet by this method: above 1 only paths and scatter_grid are");
    if (job->quality.method == JOB_METHOD_PATHS && job->scene.object_count > 0)
        return json_fail(&method, error, "not rendered yet: paths in scenes with objects");
    if (job->quality.scatter_grid > 0 && job->scene.object_count > 0)
        return json_fail(&grid, error, "not rendered yet: a grid in scenes with objects");
    return check_lights(job, document, error);
}
