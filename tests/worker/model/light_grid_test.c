// A light's grid, node by node, against the columns of reference/.
// SPDX-License-Identifier: Apache-2.0
#include "worker/model/light_grid.h"

#include "core/base/error.h"
#include "core/job/job_json.h"
#include "reference/still.h"
#include "reference/transmittance.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_programs.h"
#include "worker/shader/light_grid_glue.h"
#include "worker/shader/scene_program.h"
#include "worker/textures/gl_caches.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SUN "{ \"kind\": \"sun\", \"intensity\": 1, \"direction\": [1, -2, 0.5] }"
#define POINT_AT(PLACE) "{ \"kind\": \"point\", \"intensity\": 1, \"position\": " PLACE " }"
// Two media: one is smooth, and falls off; one has folds, and ends where it is dense.
#define MEDIA                                                                                                          \
    "{ \"density\": { \"kind\": \"homogeneous\", \"scale\": 2,"                                                        \
    " \"bounds\": { \"kind\": \"box\", \"center\": [0.2, 0, 0.1], \"size\": [1, 0.8, 1.2], \"falloff\": 0.4 } },"      \
    " \"sigma_s\": 1 }, { \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 2, \"offset\": 0.05,"             \
    " \"radius\": 0.4, \"rotate_x_rad\": 0.3, \"exponent\": 1.5, \"scale\": 10, \"bounds\": { \"kind\": "              \
    "\"sphere\",\"center\": [0.1, 0, 0], \"radius\": 0.35 } }, \"sigma_s\": 1 }"

struct grid_check {
    struct job job;
    struct still still;
    struct scene_program program;
    float *texels; // two a node
    int cells;
};

static void fill(struct grid_check *check)
{
    struct error error = {{0}};
    struct gl_context *context = gl_stage_open_context(GL_BACKEND_SOFTWARE);
    struct gl_functions gl;
    struct gl_programs programs;
    struct scene_cache *cache = &check->program.caches[0];
    unsigned char block[512];
    const unsigned char *blocks[] = {block};
    PFNGLGETTEXIMAGEPROC get_image;
    PFNGLACTIVETEXTUREPROC activate;
    struct gl_caches *caches;

    assert_true(gl_functions_load(&gl, context, NULL));
    gl_programs_init(&programs, &gl);
    get_image = (PFNGLGETTEXIMAGEPROC)gl_context_function(context, "glGetTexImage");
    activate = (PFNGLACTIVETEXTUREPROC)gl_context_function(context, "glActiveTexture");
    cache->is_step = false; // so that it stays when it is filled
    caches = gl_caches_create(&gl, &programs);
    assert_true(cache->uniforms.size_bytes <= sizeof block);
    assert_true(frame_uniforms_pack(&cache->uniforms, &(struct frame_moment){0}, block, NULL));
    if (gl_caches_bind(caches,
                       &(struct gl_caches_request){.caches = cache, .count = 1, .blocks = blocks, .files_hash = ""},
                       &error) != GL_CACHES_BOUND)
        fail_msg("%s", error.message);
    activate(GL_TEXTURE0 + cache->unit);
    get_image(GL_TEXTURE_3D, 0, GL_RG, GL_FLOAT, check->texels);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
    gl_caches_destroy(caches);
    gl_programs_finish(&programs);
    gl_context_destroy(context);
}

static void open_check(struct grid_check *check, const char *light, int cells)
{
    struct error error = {{0}};
    char text[2048];
    size_t nodes = (size_t)cells + 1;

    *check = (struct grid_check){.cells = cells};
    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"grid\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [16, 16],"
             " \"camera\": { \"position\": [0, 0, 4], \"target\": [0, 0, 0], \"fov\": 40 }, \"lights\": [ %s ],"
             " \"scene\": { \"media\": [ " MEDIA " ] },"
             " \"quality\": { \"method\": \"cached\", \"step\": 0.1, \"light_grid\": %d },"
             " \"output\": { \"path\": \"grid.####.exr\" } }",
             light, cells);
    if (!job_parse(&check->job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    if (!scene_program_init(&check->program, &check->job, NULL, test_shader_dir(), &error))
        fail_msg("%s", error.message);
    assert_int_equal(check->program.cache_count, LIGHT_GRID_CACHES);
    assert_int_equal(check->program.caches[0].format, SCENE_CACHE_RG32F);
    still_init(&check->still, &check->job, 0);
    check->texels = malloc(nodes * nodes * nodes * 2 * sizeof *check->texels);
    fill(check);
}

static void close_check(struct grid_check *check)
{
    free(check->texels);
    scene_program_finish(&check->program);
    job_finish(&check->job);
}

// Where a node is, by the placement's own words.
static struct vec3 beam_node(const struct light_grid_placement *place, const double at[3])
{
    double depth = at[2] - place->origin[2], wider = 1 + place->taper * depth;
    double unit[3] = {(at[0] - place->origin[0]) * wider, (at[1] - place->origin[1]) * wider, depth};
    double p[3];

    for (int row = 0; row < 3; row++) {
        p[row] = place->center[row];
        for (int column = 0; column < 3; column++)
            p[row] += place->from_unit[3 * column + row] * unit[column];
    }
    return vec3_from(p);
}

// The octahedron |x| + |y| + |z| = 1, its lower half folded out to the square's corners.
static struct vec3 round_node(const struct light_grid_placement *place, struct vec3 light, const double at[3])
{
    double x = 2 * at[0] - 1, y = 2 * at[1] - 1, z = 1 - fabs(x) - fabs(y);
    struct vec3 way = {x, y, z};

    if (z < 0) way = (struct vec3){copysign(1 - fabs(y), x), copysign(1 - fabs(x), y), z};
    return vec3_add(light, vec3_scale(vec3_normalize(way), place->near + at[2] * (place->far - place->near)));
}

static struct vec3 find_node(const struct grid_check *check, const int node[3])
{
    const struct light_grid *grid = &check->program.light_grids[0];
    struct light_grid_placement place;
    double at[3], light[9] = {0};

    for (int i = 0; i < 3; i++)
        at[i] = (double)node[i] / check->cells;
    light_grid_place(grid, 0, &place);
    if (grid->kind == LIGHT_GRID_BEAM) return beam_node(&place, at);
    timeline_evaluate(&check->job.scene.lights[0].position, 0, light);
    return round_node(&place, vec3_from(light), at);
}

// Integrates the medium's density from the light to the point.
static double true_column(const struct grid_check *check, struct vec3 place, size_t medium)
{
    const struct scene_light *light = &check->job.scene.lights[0];
    double value[9] = {0};
    struct ray ray = {.origin = place};
    double length = 100;

    timeline_evaluate(light->kind == SCENE_LIGHT_SUN ? &light->direction : &light->position, 0, value);
    ray.direction =
        light->kind == SCENE_LIGHT_SUN ? vec3_scale(vec3_from(value), -1) : vec3_subtract(vec3_from(value), place);
    if (light->kind == SCENE_LIGHT_POINT) length = vec3_length(ray.direction);
    if (length == 0) return 0;
    ray.direction = vec3_normalize(ray.direction);
    return transmittance_density_column(&check->still.media[medium].density, &ray, 0, length, 1e-7);
}

struct spread {
    double rmse, mean;
};

static struct spread find_spread(const struct grid_check *check, size_t medium)
{
    double square = 0, sum = 0;
    int nodes = check->cells + 1, count = 0;

    for (int i = 0; i < nodes; i += 5)
        for (int j = 1; j < nodes; j += 6)
            for (int k = 0; k < nodes; k += 4) {
                double expected = true_column(check, find_node(check, (int[]){i, j, k}), medium);
                size_t at = ((size_t)k * (size_t)nodes + (size_t)j) * (size_t)nodes + (size_t)i;
                double error = check->texels[2 * at + medium] - expected;

                square += error * error;
                sum += expected;
                count++;
            }
    return (struct spread){.rmse = sqrt(square / count), .mean = sum / count};
}

// Nodes are where the twin says, and their columns are off by what the midpoint rule leaves of cells.
static void assert_columns(const char *light, enum light_grid_kind kind, double smooth_tolerance,
                           double folded_tolerance)
{
    const double tolerances[] = {smooth_tolerance, folded_tolerance};
    struct grid_check check;

    for (int cells = 30; cells <= 60; cells *= 2) {
        open_check(&check, light, cells);
        assert_int_equal(check.program.light_grids[0].kind, kind);
        for (size_t medium = 0; medium < 2; medium++) {
            struct spread spread = find_spread(&check, medium);
            double finer = cells / 30.0;

            print_message("%d cells, medium %zu: %.2e of a mean column of %.2e m\n", cells, medium,
                          spread.rmse / spread.mean, spread.mean);
            assert_true(spread.mean > 1e-3);
            assert_true(spread.rmse <= tolerances[medium] * spread.mean / (finer * finer));
        }
        close_check(&check);
    }
}

static void a_sun_has_the_columns_along_its_direction(void **state)
{
    (void)state;
    assert_columns(SUN, LIGHT_GRID_BEAM, 8e-3, 2e-2);
}

static void a_lamp_outside_has_the_columns_of_its_beam(void **state)
{
    (void)state;
    assert_columns(POINT_AT("[1.5, 1, -1.2]"), LIGHT_GRID_BEAM, 8e-3, 2e-2);
}

// There a float's last digit is 32 m.
static void a_lamp_far_away_keeps_its_digits(void **state)
{
    (void)state;
    assert_columns(POINT_AT("[3e8, 2e8, -4e8]"), LIGHT_GRID_BEAM, 8e-3, 2e-2);
}

static void a_lamp_inside_has_columns_all_round(void **state)
{
    (void)state;
    assert_columns(POINT_AT("[0.15, -0.05, 0.3]"), LIGHT_GRID_ROUND, 2e-3, 4e-3);
}

static void a_lamp_close_by_has_columns_all_round(void **state)
{
    (void)state;
    assert_columns(POINT_AT("[0.75, 0.3, 0.5]"), LIGHT_GRID_ROUND, 1e-2, 2e-2);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sun_has_the_columns_along_its_direction),
        cmocka_unit_test(a_lamp_outside_has_the_columns_of_its_beam),
        cmocka_unit_test(a_lamp_far_away_keeps_its_digits),
        cmocka_unit_test(a_lamp_inside_has_columns_all_round),
        cmocka_unit_test(a_lamp_close_by_has_columns_all_round),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
