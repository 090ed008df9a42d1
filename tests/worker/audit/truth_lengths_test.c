// How far rays go through media, where that follows from formulas.
// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/truth_lengths.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// The camera looks along -z from 100 m away, its rays being nearly parallel: the picture is 2 m high at the origin.
static struct truth_lengths find(const char *media, const char *objects, const char *light)
{
    struct truth_lengths lengths;
    struct error error = {{0}};
    struct job job;
    char text[2048];
    int length = snprintf(
        text, sizeof text,
        "{\"version\":1,\"name\":\"lengths\",\"frames\":\"0\",\"fps\":24,\"resolution\":[16,9],"
        "\"camera\":{\"position\":[0,0,100],\"target\":[0,0,0],\"up\":[0,1,0],\"fov\":1.145877,\"clip\":[0,103]},"
        "\"lights\":[{\"kind\":\"sun\",\"direction\":%s,\"intensity\":1}],"
        "\"scene\":{\"media\":[%s],\"objects\":[%s]},\"quality\":{\"tolerance\":0.05},"
        "\"output\":{\"path\":\"s.####.exr\"}}",
        light, media, objects);

    if (!job_parse(&job, text, (size_t)length, NULL, &error)) fail_msg("%s", error.message);
    lengths = truth_lengths_find(&job, (const int32_t[]){0}, 1);
    job_finish(&job);
    return lengths;
}

#define NOISE(bounds) "{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":" bounds "},\"sigma_s\":1}"
#define EVEN(bounds) "{\"density\":{\"kind\":\"homogeneous\",\"bounds\":" bounds "},\"sigma_s\":1}"
#define BALL "{\"kind\":\"sphere\",\"radius\":1}"
#define WALL "{\"kind\":\"slab\",\"center\":[0,0,0],\"thickness\":2,\"normal\":[0,0,1]}"
#define WIDE "{\"kind\":\"slab\",\"center\":[0,0,0],\"thickness\":40,\"normal\":[0,0,1]}"

static const char ALONG[] = "[0,0,-1]", ACROSS[] = "[0,0.6,-0.8]";

static void a_ball_has_chords(void **state)
{
    struct truth_lengths lengths = find(NOISE(BALL), "", ALONG);

    (void)state;
    assert_float_equal(lengths.camera, 4.0 / 3.0, 0.1);
    // Half of each chord; longer ones count more: the mean of their squares over their mean, halved.
    assert_float_equal(lengths.light, 0.75, 0.1);
}

static void a_wall_is_as_thick_as_the_light_is_slanted(void **state)
{
    struct truth_lengths lengths = find(NOISE(WALL), "", ACROSS);

    (void)state;
    assert_float_equal(lengths.camera, 2.0, 1e-3);
    assert_float_equal(lengths.light, 1.0 / 0.8, 1e-3);
}

static void light_is_marched_where_the_density_varies(void **state)
{
    struct truth_lengths lengths = find(EVEN(WALL), "", ALONG);

    (void)state;
    assert_float_equal(lengths.camera, 2.0, 1e-3);
    assert_float_equal(lengths.light, 0.0, 0.0);
}

static void media_that_overlap_count_once(void **state)
{
    struct truth_lengths lengths = find(NOISE(WALL) "," NOISE(WALL) "," EVEN(WALL), "", ALONG);

    (void)state;
    assert_float_equal(lengths.camera, 2.0, 1e-3);
    assert_float_equal(lengths.light, 1.0, 1e-3);
}

static void paths_end_at_what_is_opaque_and_at_the_clip_distance(void **state)
{
    static const char GLASS[] = "{\"kind\":\"box\",\"size\":[100,100,1],\"center\":[0,0,10],"
                                "\"material\":{\"kind\":\"dielectric\",\"ior\":1.5}}";
    static const char MATT[] = "{\"kind\":\"box\",\"size\":[100,100,1],\"center\":[0,0,4.5],"
                               "\"material\":{\"kind\":\"diffuse\",\"albedo\":0.5}}";
    char both[512];

    (void)state;
    snprintf(both, sizeof both, "%s,%s", GLASS, MATT);
    // From z = 20 to -3; the glass is empty.
    assert_float_equal(find(EVEN(WIDE), "", ALONG).camera, 23.0, 1e-2);
    assert_float_equal(find(EVEN(WIDE), GLASS, ALONG).camera, 22.0, 1e-2);
    assert_float_equal(find(EVEN(WIDE), both, ALONG).camera, 14.0, 1e-2);
}

static void rays_that_miss_do_not_count(void **state)
{
    struct truth_lengths lengths = find(NOISE("{\"kind\":\"sphere\",\"radius\":1,\"center\":[50,0,0]}"), "", ALONG);

    (void)state;
    assert_float_equal(lengths.camera, 0.0, 0.0);
    assert_float_equal(lengths.light, 0.0, 0.0);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_has_chords),
        cmocka_unit_test(a_wall_is_as_thick_as_the_light_is_slanted),
        cmocka_unit_test(light_is_marched_where_the_density_varies),
        cmocka_unit_test(media_that_overlap_count_once),
        cmocka_unit_test(paths_end_at_what_is_opaque_and_at_the_clip_distance),
        cmocka_unit_test(rays_that_miss_do_not_count),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
