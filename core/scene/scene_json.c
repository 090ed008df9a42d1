// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene_json.h"

#include "core/base/error.h"
#include "core/scene/light_json.h"
#include "core/scene/medium_json.h"
#include "core/scene/object_json.h"
#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

#include <math.h>
#include <string.h>

static const double DISTANCE_MAX = 1e9; // m

static const double SHUTTER_MAX = 1000.0; // frames
static const struct timeline_limits FOV = {
    .components = 1, .min = 0.0, .max = 180.0, .excludes_min = true, .excludes_max = true};

static bool read_clip(const struct scene_reader *reader, struct scene_camera *camera)
{
    struct json_node clip = json_node_child(reader->object, "clip");
    struct json_node near = json_node_element(&clip, 0), far = json_node_element(&clip, 1);

    camera->clip_near = 0.0;
    camera->clip_far = INFINITY;
    if (json_node_is_absent(&clip)) return true;
    if (json_node_type(&clip) != JSON_ARRAY || json_node_count(&clip) != 2)
        return json_fail_expected(&clip, reader->error, "[near, far] in metres");
    if (!json_read_number(&near, 0.0, DISTANCE_MAX, &camera->clip_near, reader->error) ||
        !json_read_number(&far, 0.0, DISTANCE_MAX, &camera->clip_far, reader->error))
        return false;
    if (camera->clip_near < camera->clip_far) return true;
    return json_fail(&clip, reader->error, "expected near < far, got %.10g and %.10g", camera->clip_near,
                     camera->clip_far);
}

static bool read_camera(const struct scene_reader *job, struct scene_camera *camera)
{
    static const char *const keys[] = {"position", "target", "up", "fov", "clip", "mirror", "shutter", NULL};
    struct json_node object = json_node_child(job->object, "camera");
    struct scene_reader reader = {&object, job->span, job->error};
    struct json_node mirror = json_node_child(&object, "mirror");

    if (!json_check_object(&object, job->error) || !json_check_keys(&object, keys, job->error)) return false;
    return scene_reader_read_direction(&reader, "up", &camera->up) &&
           scene_reader_read(&reader, "position", &SCENE_POSITION, &camera->position) &&
           scene_reader_read(&reader, "target", &SCENE_POSITION, &camera->target) &&
           scene_reader_read(&reader, "fov", &FOV, &camera->fov) && read_clip(&reader, camera) &&
           (json_node_is_absent(&mirror) || json_read_bool(&mirror, &camera->mirror, job->error));
}

static bool read_media(const struct scene_reader *scene_reader, struct scene *scene)
{
    struct json_node media = json_node_child(scene_reader->object, "media"), medium = {0};
    struct scene_reader reader = {&medium, scene_reader->span, scene_reader->error};

    if (json_node_is_absent(&media)) return true;
    if (!json_check_array(&media, 0, SCENE_MEDIUM_LIMIT, reader.error)) return false;
    while (json_node_next(&media, &medium))
        if (!medium_from_json(&scene->media[scene->medium_count++], &reader)) return false;
    return true;
}

static bool read_scattering(const struct scene_reader *scene_reader, struct scene *scene)
{
    static const char *const keys[] = {"orders", NULL};
    struct json_node object = json_node_child(scene_reader->object, "scattering");
    struct json_node orders = json_node_child(&object, "orders");
    int64_t count;
    const char *word;

    if (json_node_is_absent(&object)) return true;
    if (!json_check_object(&object, scene_reader->error) || !json_check_keys(&object, keys, scene_reader->error))
        return false;
    if (json_read_string(&orders, &word, NULL)) {
        scene->orders = SCENE_ORDERS_ALL;
        return strcmp(word, "all") == 0 ||
               json_fail_expected(&orders, scene_reader->error, "an integer from 1 to 1000 or \"all\"");
    }
    if (!json_read_integer(&orders, 1, SCENE_ORDER_LIMIT, &count, scene_reader->error)) return false;
    scene->orders = (int)count;
    return true;
}

static bool read_contents(const struct scene_reader *job, struct scene *scene)
{
    static const char *const keys[] = {"media", "objects", "scattering", NULL};
    struct json_node object = json_node_child(job->object, "scene");
    struct scene_reader reader = {&object, job->span, job->error};

    if (json_node_is_absent(&object)) return true;
    return json_check_object(&object, job->error) && json_check_keys(&object, keys, job->error) &&
           read_scattering(&reader, scene) && read_media(&reader, scene) && objects_from_json(scene, &reader);
}

// Read first: the shutter extends the times at which every other value is checked.
static bool read_shutter(const struct scene_reader *job, struct scene_camera *camera)
{
    struct json_node object = json_node_child(job->object, "camera");
    struct json_node shutter = json_node_child(&object, "shutter");

    return json_node_is_absent(&shutter) || json_read_number(&shutter, 0.0, SHUTTER_MAX, &camera->shutter, job->error);
}

bool scene_from_json(struct scene *scene, const struct json_node *job, const struct scene_times *times,
                     struct error *error)
{
    struct scene_reader reader = {job, times->frames, error};

    *scene = (struct scene){.orders = 1};
    if (!read_shutter(&reader, &scene->camera)) return false;
    reader.span.last += scene->camera.shutter * times->frame_s;
    scene->has_background = scene_reader_has_key(&reader, "background");
    return read_camera(&reader, &scene->camera) && lights_from_json(scene, &reader) &&
           scene_reader_read_or(&reader, "background", &SCENE_RADIANCE, 0.0, &scene->background) &&
           read_contents(&reader, scene);
}
