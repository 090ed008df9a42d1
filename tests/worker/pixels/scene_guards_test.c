// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/scene_guards.h"

#include "core/job/job.h"
#include "reference/still.h"
#include "tests/support/assert_near.h"
#include "tests/support/object_job.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define QUALITY(samples)                                                                                               \
    "\"quality\": {\"method\": \"equiangular\", \"points\": 1, \"samples\": " samples                                  \
    ", \"pixels\": {\"threshold\": 0.01}}"
#define SPHERE(center, radius)                                                                                         \
    "{\"kind\": \"sphere\", \"center\": " center ", \"radius\": " radius ", \"material\": {" OBJECT_JOB_GREY "}}"
#define BOX(center, size)                                                                                              \
    "{\"kind\": \"box\", \"center\": " center ", \"size\": " size ", \"material\": {" OBJECT_JOB_GREY "}}"
#define OBJECTS(list) "\"objects\": [" list "]"
#define MEDIUM(density) "\"media\": [{\"sigma_s\": 1, \"density\": {" density "}}]"

// A scene of 960 x 640 pixels and its guards in frame 0.
struct stage {
    struct job job;
    struct scene_guards guards;
};

static void open_stage(struct stage *stage, const char *scene, const char *rest)
{
    object_job_parse(&stage->job, scene, rest);
    stage->job.width_px = 960;
    stage->job.height_px = 640;
    scene_guards_init(&stage->guards, &stage->job, NULL, 0);
}

static void close_stage(struct stage *stage)
{
    scene_guards_finish(&stage->guards);
    job_finish(&stage->job);
}

static size_t count(const char *scene, const char *rest)
{
    struct stage stage;
    size_t found;

    open_stage(&stage, scene, rest);
    found = stage.guards.count;
    close_stage(&stage);
    return found;
}

// How far the ray through a place in the picture passes from a point, m.
static double find_distance(const struct job *job, double time, const double pixel[2], struct vec3 point)
{
    struct still still;
    struct ray ray;
    struct vec3 away;

    still_init(&still, job, time);
    ray = camera_pinhole_ray(&still.camera, pixel[0] + 0.5, pixel[1] + 0.5);
    away = vec3_subtract(point, ray.origin);
    return vec3_length(vec3_subtract(away, vec3_scale(ray.direction, vec3_dot(away, ray.direction))));
}

static void lamps_in_front_of_the_camera_are_points(void **state)
{
    const struct vec3 lamp = {0.5, 0.3, -1};
    struct stage stage;

    (void)state;
    open_stage(&stage, OBJECTS(""),
               "\"lights\": [{\"kind\": \"sun\", \"intensity\": 1, \"direction\": [0, 0, -1]},"
               " {\"kind\": \"point\", \"intensity\": 1, \"position\": [0, 0, 9]},"
               " {\"kind\": \"point\", \"intensity\": 1, \"position\": [0, 0, 4]},"
               " {\"kind\": \"point\", \"intensity\": 1, \"position\": [0.5, 0.3, -1]}], " QUALITY("1"));
    assert_int_equal(stage.guards.count, 1);
    assert_int_equal(stage.guards.list[0].reach, 3);
    assert_near(find_distance(&stage.job, 0, stage.guards.list[0].from, lamp), 0, 1e-9);
    assert_near(find_distance(&stage.job, 0, stage.guards.list[0].to, lamp), 0, 1e-9);
    close_stage(&stage);
}

// All ends lie on the outline, one after the other, and the lines between leave it by less than a pixel.
static void assert_outline(const struct job *job, const struct pixel_guard *list, size_t size, double time,
                           struct vec3 center, double radius)
{
    const double PIXEL = 5 * 2 * tan(0.5 * 40 * 0.017453292519943295) / 640; // m, at most, at the distance of 5 m

    assert_true(size >= 16);
    for (size_t i = 0; i < size; i++) {
        const struct pixel_guard *guard = &list[i], *next = &list[(i + 1) % size];
        const double middle[2] = {0.5 * (guard->from[0] + guard->to[0]), 0.5 * (guard->from[1] + guard->to[1])};

        assert_int_equal(guard->reach, 1);
        assert_near(find_distance(job, time, guard->from, center), radius, 1e-9);
        assert_near(guard->to[0], next->from[0], 1e-6);
        assert_near(guard->to[1], next->from[1], 1e-6);
        assert_near(find_distance(job, time, middle, center), radius, PIXEL);
    }
}

static void spheres_have_their_outline(void **state)
{
    struct stage stage;

    (void)state;
    open_stage(&stage, OBJECTS(SPHERE("[0.7, 0.4, -1]", "0.6")), QUALITY("1"));
    assert_outline(&stage.job, stage.guards.list, stage.guards.count, 0, (struct vec3){0.7, 0.4, -1}, 0.6);
    close_stage(&stage);
    open_stage(&stage, OBJECTS(SPHERE("[0.31, 0.4, 0]", "0.005")), QUALITY("1")); // of about 2 px
    assert_outline(&stage.job, stage.guards.list, stage.guards.count, 0, (struct vec3){0.31, 0.4, 0}, 0.005);
    close_stage(&stage);
}

static void boxes_have_their_edges(void **state)
{
    struct stage stage;

    (void)state;
    open_stage(&stage, OBJECTS(BOX("[0.1, 0.2, -1]", "[2, 1, 0.5]")), QUALITY("1"));
    assert_int_equal(stage.guards.count, 12);
    for (size_t i = 0; i < 24; i++) {
        const struct pixel_guard *guard = &stage.guards.list[i / 2];
        double nearest = INFINITY;

        for (int corner = 0; corner < 8; corner++) {
            const struct vec3 at = {0.1 + (corner & 1 ? 1 : -1), 0.2 + (corner & 2 ? 0.5 : -0.5),
                                    -1 + (corner & 4 ? 0.25 : -0.25)};

            nearest = fmin(nearest, find_distance(&stage.job, 0, i % 2 == 0 ? guard->from : guard->to, at));
        }
        assert_near(nearest, 0, 1e-9);
        assert_true(hypot(guard->from[0] - guard->to[0], guard->from[1] - guard->to[1]) > 1);
    }
    close_stage(&stage);
}

// Four edges are ahead, four pass beside the camera, and four are behind it.
static void edges_end_at_the_camera(void **state)
{
    struct stage stage;

    (void)state;
    open_stage(&stage, OBJECTS(BOX("[0, 0, 4]", "[2, 1, 4]")), QUALITY("1"));
    assert_int_equal(stage.guards.count, 8);
    for (size_t i = 0; i < 8; i++)
        for (int k = 0; k < 2; k++) {
            const struct pixel_guard *guard = &stage.guards.list[i];
            // Away from the middle of the picture, which all of these lines leave or pass.
            double from = guard->from[k] - (k == 0 ? 479.5 : 319.5), to = guard->to[k] - (k == 0 ? 479.5 : 319.5);

            assert_true(isfinite(from) && isfinite(to));
            assert_true(fmax(fabs(from), fabs(to)) > 100);
        }
    close_stage(&stage);
}

static void what_is_no_outline_has_no_guards(void **state)
{
    (void)state;
    assert_int_equal(count(OBJECTS(SPHERE("[0, 0, 4.5]", "1")), QUALITY("1")), 0); // the camera is inside
    assert_int_equal(count(OBJECTS(SPHERE("[0, 0, 9]", "1")), QUALITY("1")), 0);
    assert_int_equal(count(OBJECTS(BOX("[0, 0, 9]", "[1, 1, 1]")), QUALITY("1")), 0);
    assert_int_equal(count(OBJECTS(OBJECT_JOB_FLOOR(OBJECT_JOB_GREY)), QUALITY("1")), 0);
}

// Media that end softly show it, unless they are only a few steps wide: 64 px here, of 640 for 2.9 m.
static void media_have_guards_where_they_are_sharp_or_narrow(void **state)
{
#define NOISE "\"kind\": \"noise\", \"frequency\": 1, "
#define EVEN "\"kind\": \"homogeneous\", "
#define QUALITY_STEPS                                                                                                  \
    "\"quality\": {\"method\": \"midpoint\", \"step\": 0.1, \"light_step\": 0.1, \"pixels\": {\"threshold\": 0.01}}"
    static const struct {
        const char *scene;
        bool is_guarded;
    } cases[] = {
        {MEDIUM(EVEN "\"bounds\": {\"kind\": \"sphere\", \"radius\": 1}"), true},
        {MEDIUM(EVEN "\"bounds\": {\"kind\": \"box\", \"size\": [1, 1, 1]}"), true},
        {MEDIUM(EVEN "\"bounds\": {\"kind\": \"slab\", \"thickness\": 1}"), false},
        {MEDIUM(NOISE "\"bounds\": {\"kind\": \"sphere\", \"radius\": 1}"), false},
        {MEDIUM(NOISE "\"bounds\": {\"kind\": \"sphere\", \"radius\": 0.2}"), false},
        {MEDIUM(NOISE "\"bounds\": {\"kind\": \"sphere\", \"radius\": 0.1}"), true},
        {MEDIUM(NOISE "\"bounds\": {\"kind\": \"box\", \"size\": [1, 1, 1]}"), false},
        {MEDIUM(NOISE "\"bounds\": {\"kind\": \"box\", \"size\": [0.2, 1, 1]}"), true},
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size_t found = count(cases[i].scene, QUALITY_STEPS);

        if ((found > 0) != cases[i].is_guarded) fail_msg("%s: %zu guards", cases[i].scene, found);
    }
}

// From the first to the last moment of the samples.
static void an_open_shutter_is_guarded_throughout(void **state)
{
    struct stage stage;
    size_t each;

    (void)state;
    open_stage(&stage, OBJECTS(SPHERE("{\"start\": [-1, 0, 0], \"rate\": [24, 0, 0]}", "0.05")), QUALITY("16"));
    stage.job.scene.camera.shutter = 2;
    scene_guards_finish(&stage.guards);
    scene_guards_init(&stage.guards, &stage.job, NULL, 0);
    each = stage.guards.count / SCENE_GUARD_MOMENTS;
    assert_int_equal(each * SCENE_GUARD_MOMENTS, stage.guards.count);
    for (int i = 0; i < 2; i++) {
        double time = pixel_samples_time(&stage.job, 0, i * 15);

        assert_outline(&stage.job, stage.guards.list + (i == 0 ? 0 : stage.guards.count - each), each, time,
                       (struct vec3){-1 + 24 * time, 0, 0}, 0.05);
    }
    close_stage(&stage);
}

// The same of a camera that moves.
static void the_camera_s_way_is_guarded(void **state)
{
    const struct vec3 center = {0, 0, 0};
    struct stage stage;
    size_t each;

    (void)state;
    open_stage(&stage, OBJECTS(SPHERE("[0, 0, 0]", "0.1")), QUALITY("4"));
    each = stage.guards.count;
    stage.job.scene.camera.shutter = 1;
    stage.job.scene.camera.position =
        (struct timeline){.kind = TIMELINE_LINEAR, .component_count = 3, .linear = {{0, 0, 4}, {12, 0, 0}}};
    scene_guards_finish(&stage.guards);
    scene_guards_init(&stage.guards, &stage.job, NULL, 0);
    assert_true(stage.guards.count >= 4 * each);
    assert_near(find_distance(&stage.job, pixel_samples_time(&stage.job, 0, 0), stage.guards.list[0].from, center), 0.1,
                1e-9);
    assert_near(find_distance(&stage.job, pixel_samples_time(&stage.job, 0, 3),
                              stage.guards.list[stage.guards.count - 1].from, center),
                0.1, 1e-9);
    close_stage(&stage);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lamps_in_front_of_the_camera_are_points),
        cmocka_unit_test(spheres_have_their_outline),
        cmocka_unit_test(boxes_have_their_edges),
        cmocka_unit_test(edges_end_at_the_camera),
        cmocka_unit_test(what_is_no_outline_has_no_guards),
        cmocka_unit_test(media_have_guards_where_they_are_sharp_or_narrow),
        cmocka_unit_test(an_open_shutter_is_guarded_throughout),
        cmocka_unit_test(the_camera_s_way_is_guarded),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
