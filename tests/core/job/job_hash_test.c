// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_hash.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/job/quality_json.h"
#include "core/json/json_read.h"
#include "core/scene/scene_json.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct hash {
    char text[HASH_TEXT_SIZE];
};

static bool find_hash(const char *text, struct hash *hash)
{
    struct job job;
    bool ok = job_parse(&job, text, strlen(text), NULL, NULL);

    if (ok) memcpy(hash->text, job.hash, sizeof hash->text);
    job_finish(&job);
    return ok;
}

static struct hash hash_of(const char *text)
{
    struct hash hash = {0};

    if (!find_hash(text, &hash)) fail_msg("refused: %s", text);
    return hash;
}

static struct hash hash_with(const char *path, const char *value)
{
    char *text = json_edit_set(job_text_full, path, value);
    struct hash hash = hash_of(text);

    free(text);
    return hash;
}

static void layout_and_order_of_keys_do_not_count(void **state)
{
    char *cloud = job_text_load("cloud.json");
    char *compact = json_edit_set(cloud, "priority", "50"); // written anew, with other spaces and digits
    char *moved = json_edit_set(compact, "version", NULL);
    char *reordered = json_edit_set(moved, "version", "1");

    assert_string_equal(hash_of(compact).text, hash_of(cloud).text);
    assert_string_equal(hash_of(reordered).text, hash_of(cloud).text);
    assert_string_not_equal(reordered, compact);
    free(reordered);
    free(moved);
    free(compact);
    free(cloud);
}

static void spelled_out_defaults_do_not_count(void **state)
{
    struct hash hash = hash_of(job_text_full);

    assert_string_equal(hash_with("scene.media[1].sigma_s", "0").text, hash.text);
    assert_string_equal(hash_with("scene.media[1].phase[0].weight", "1").text, hash.text);
    assert_string_equal(hash_with("scene.media[1].density.rotate_x_rad", "-0.0").text, hash.text);
    assert_string_equal(hash_with("lights[2].falloff", "\"inverse_square\"").text, hash.text);
    assert_string_equal(hash_with("fps", "[48000, 2002]").text, hash.text);
}

static void what_no_picture_depends_on_does_not_count(void **state)
{
    static const char *const edits[][2] = {{"name", "\"other\""},
                                           {"frames", "\"5\""},
                                           {"priority", "99"},
                                           {"order", "[3]"},
                                           {"frame_limit", "5"},
                                           {"pool", "\"other\""},
                                           {"after", "[7]"},
                                           {"comment", "\"other\""},
                                           {"tags", "[]"},
                                           {"notify", "[]"},
                                           {"output.path", "\"other.#.exr\""},
                                           {"output.compression", "\"none\""},
                                           {"output.existing", "\"overwrite\""}};
    struct hash hash = hash_of(job_text_full);

    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++)
        assert_string_equal(hash_with(edits[i][0], edits[i][1]).text, hash.text);
}

// max_cut is not hashed: a file states its cut share, and each job compares it with its own limit.
static void how_much_may_be_cut_does_not_count(void **state)
{
    char *text = json_edit_set(job_text_objects, "quality.max_cut", "0.75");

    assert_string_equal(hash_of(text).text, hash_of(job_text_objects).text);
    free(text);
}

static void what_becomes_of_a_miss_does_not_count(void **state)
{
    char *fails = json_edit_set(job_text_objects, "quality", "{\"tolerance\":0.02}");
    char *publishes = json_edit_set(job_text_objects, "quality", "{\"tolerance\":0.02,\"on_miss\":\"publish\"}");

    assert_string_equal(hash_of(publishes).text, hash_of(fails).text);
    free(publishes);
    free(fails);
}

// Values that have only one choice, that no picture depends on, or that change together with another.
static bool is_left_out(const char *path)
{
    static const char *const paths[] = {"version",
                                        "name",
                                        "frames",
                                        "priority",
                                        "frame_limit",
                                        "pool",
                                        "comment",
                                        "output.path",
                                        "output.compression",
                                        "output.existing",
                                        "quality.method",
                                        "quality.max_cut",
                                        "quality.on_miss",
                                        "scene.objects[0].material.fresnel",
                                        "scene.objects[1].material.fresnel",
                                        "scene.media[0].phase[0].weight",
                                        "scene.media[0].phase[1].weight"};

    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++)
        if (strcmp(paths[i], path) == 0) return true;
    if (strncmp(path, "order[", 6) == 0 || strncmp(path, "tags[", 5) == 0) return true;
    if (strncmp(path, "notify[", 7) == 0) return true;
    return strlen(path) > 5 && strcmp(path + strlen(path) - 5, ".kind") == 0;
}

static bool some_value_changes_the_hash(const char *document, const char *path, const struct hash *hash)
{
    static const char *const values[] = {
        "0.4",        "1",           "2",         "3",           "7",          "-0.4",      "50",
        "true",       "false",       "\"hold\"",  "\"linear\"",  "\"none\"",   "\"half\"",  "\"transmittance\"",
        "\"linear\"", "[1,1,1]",     "\"remap\"", "\"uint8\"",   "\"little\"", "\"a.raw\"", "\"a.nvdb\"",
        "1500",       "\"schlick\"", "\"srgb\"",  "\"nearest\"", "\"a.png\""};

    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        char *text = json_edit_set(document, path, values[i]);
        struct hash changed;
        bool differs = find_hash(text, &changed) && strcmp(changed.text, hash->text) != 0;

        free(text);
        if (differs) return true;
    }
    return false;
}

// The file of the text only appears in messages.
static bool is_glsl_file(const char *document, const char *path)
{
    return document == job_text_glsl && strlen(path) > 5 && strcmp(path + strlen(path) - 5, ".file") == 0;
}

static void check_places(const char *document, const char *prefix, size_t expected)
{
    struct hash hash = hash_of(document);
    size_t count, checked = 0;
    struct json_place *places = json_edit_places(document, &count);

    for (size_t i = 0; i < count; i++) {
        size_t length = strlen(places[i].path);
        bool is_leaf = i + 1 == count || strncmp(places[i + 1].path, places[i].path, length) != 0;

        if (!is_leaf || is_left_out(places[i].path) || is_glsl_file(document, places[i].path) ||
            strncmp(places[i].path, prefix, strlen(prefix)) != 0)
            continue;
        if (!some_value_changes_the_hash(document, places[i].path, &hash))
            fail_msg("%s does not count", places[i].path);
        checked++;
    }
    if (checked < expected) fail_msg("%s: only %zu places", prefix, checked);
    json_edit_free_places(places, count);
}

static void every_value_that_a_picture_depends_on_counts(void **state)
{
    // Here a falloff is allowed.
    char *fog = json_edit_set(job_text_fog, "quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1}");

    check_places(job_text_full, "", 100);
    check_places(job_text_noise, "camera.shutter", 1);
    check_places(job_text_noise, "scene", 30);
    check_places(job_text_noise, "quality", 5);
    check_places(fog, "scene", 10);
    check_places(job_text_fog, "quality", 2);
    check_places(job_text_grid, "scene", 45);
    check_places(job_text_grid, "quality", 2);
    check_places(job_text_glsl, "scene", 7);
    check_places(job_text_objects, "scene", 70);
    check_places(job_text_objects, "quality", 4);
    free(fog);
}

static void what_changes_along_with_another_counts(void **state)
{
    static const char *const edits[][2] = {
        {"scene.media[0].phase", "[{\"g\":{\"lissajous\":{\"center\":0.2,\"amplitude\":0.5,\"frequency_rad\":1}},"
                                 "\"weight\":0.5},{\"g\":-0.5,\"weight\":0.5}]"},
        {"scene.media[1].phase", NULL},
        {"quality", "{\"method\":\"riemann\",\"step\":0.05,\"light_steps\":4,\"min_transmittance\":0.001}"},
        {"quality", "{\"method\":\"riemann\",\"step\":0.05,\"light_steps\":5,\"min_transmittance\":0.001}"},
        {"quality", "{\"method\":\"midpoint\",\"step\":0.05,\"light_step\":0.1,\"roulette\":{\"below\":0.1,\"survive\":"
                    "0.5}}"},
        {"scene.media[1].phase", "[{\"kind\":\"rayleigh\"}]"},
        {"scene.media[1].density", "{\"kind\":\"homogeneous\"}"},
        {"scene.media[1].density", "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}"},
        {"scene.media[1].density", "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"box\",\"size\":[1,1,1]}}"},
        {"scene.media[1].density", "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"slab\",\"thickness\":1}}"},
        {"scene.media[1].density.bounds", "{\"kind\":\"sphere\",\"radius\":1}"},
        {"lights[0]", NULL},
        {"background", NULL},
        {"scene.media[0].emission", NULL},
        {"scene.media[1]", NULL},
        {"output.aovs", "[]"},
        {"output.aovs", "[\"Z\",\"transmittance\"]"},
        {"camera.clip", NULL},
        {"camera.up", "{\"start\":[0.5,1,0],\"rate\":[0,0,0]}"},
    };
    enum { COUNT = sizeof edits / sizeof edits[0] };
    struct hash hashes[COUNT + 1];

    hashes[COUNT] = hash_of(job_text_full);
    for (size_t i = 0; i < COUNT; i++)
        hashes[i] = hash_with(edits[i][0], edits[i][1]);
    for (size_t i = 0; i <= COUNT; i++)
        for (size_t k = 0; k < i; k++)
            if (strcmp(hashes[i].text, hashes[k].text) == 0) fail_msg("edits %zu and %zu hash alike", i, k);
}

// The hashes of jobs without objects must stay, so that existing frames remain valid.
static void jobs_without_objects_keep_their_hashes(void **state)
{
    assert_string_equal(hash_of(job_text_full).text, "62016974e9a40394de25ffb01fe08c43");
    assert_string_equal(hash_of(job_text_grid).text, "8cf8cc745577b4a885cfdee46f7f8fbe");
}

static void what_objects_are_counts(void **state)
{
    static const char *const edits[][2] = {
        {"priority", "1"}, // no change
        {"scene.objects[3].material.texture", NULL},
        {"scene.objects[3].material.texture.file", "\"globe.exr\""},
        {"scene.objects[3].material.texture.color_space", "\"linear\""},
        {"scene.objects[3].material.texture.filter", "\"nearest\""},
        {"scene.objects[1].material.f0", "0"},
        {"scene.objects[1].material.interior", NULL},
        {"scene.objects[2]", "{\"kind\":\"sphere\",\"center\":[2,0,0],\"radius\":1,\"material\":{\"kind\":"
                             "\"mirror\",\"reflectance\":[1,0.5,0.25],\"roughness\":0.5}}"},
        {"scene.objects[2]", NULL},
        {"scene.objects[4].of[2]", NULL},
    };
    enum { COUNT = sizeof edits / sizeof edits[0] };
    struct hash hashes[COUNT];
    char *text = json_edit_set(job_text_objects, "scene.objects[3].material.albedo", "1");

    for (size_t i = 0; i < COUNT; i++) {
        char *edited = json_edit_set(text, edits[i][0], edits[i][1]);

        hashes[i] = hash_of(edited);
        free(edited);
    }
    for (size_t i = 0; i < COUNT; i++)
        for (size_t k = 0; k < i; k++)
            if (strcmp(hashes[i].text, hashes[k].text) == 0) fail_msg("edits %zu and %zu hash alike", i, k);
    free(text);
}

// An interior belongs to one object, even if two are equal.
static void whose_interior_it_is_counts(void **state)
{
    static const char sphere[] = "{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{\"kind\":"
                                 "\"dielectric\",\"ior\":1.5}}";
    char *list = xasprintf("[%s,%s]", sphere, sphere);
    char *plain = json_edit_set(job_text_objects, "scene.objects", list);
    char *first = json_edit_set(plain, "scene.objects[0].material.interior", "{\"sigma_a\":1}");
    char *second = json_edit_set(plain, "scene.objects[1].material.interior", "{\"sigma_a\":1}");

    assert_string_not_equal(hash_of(first).text, hash_of(second).text);
    free(second);
    free(first);
    free(plain);
    free(list);
}

// The hash of what is read, whether or not it is rendered.
static struct hash hash_of_parts(const char *text)
{
    const struct scene_times times = {{0.0, 1.0}, 0.04};
    struct job job = {.width_px = 64, .height_px = 48, .fps_numerator = 25, .fps_denominator = 1};
    struct cJSON *root = NULL;
    struct json_node document;
    struct error error = {0};
    struct hash hash;

    assert_true(json_parse(&root, text, strlen(text), NULL));
    document = json_node_root(root);
    if (!scene_from_json(&job.scene, &document, &times, &error) || !quality_from_json(&job.quality, &document, &error))
        fail_msg("%s", error.message);
    job_hash_picture(&job, hash.text);
    scene_finish(&job.scene);
    json_delete(root);
    return hash;
}

static void orders_lights_and_random_paths_count(void **state)
{
    static const char *const edits[][2] = {
        {"priority", "1"}, // no change
        {"scene.scattering.orders", "9"},
        {"scene.scattering.orders", "\"all\""},
        {"scene.scattering", NULL},
        {"quality.paths", "65"},
        {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":16,\"paths\":64}"},
        {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":17,\"paths\":64}"},
        {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":16,\"paths\":63}"},
        {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":16,\"paths\":64,"
                    "\"scatter_from\":\"lights\"}"},
        {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":16,\"paths\":64,"
                    "\"scatter_from\":\"nodes\"}"},
        {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":16,\"paths\":64,"
                    "\"scatter_from\":\"nodes\",\"similar_after\":4}"},
        {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1}"},
        {"lights[0].inner.start", "11"},
        {"lights[0].outer.keys[1][1]", "41"},
        {"lights[0].direction", "[0,-1,0]"},
        {"lights[1].radius.rate", "0.25"},
        {"lights[2].file", "\"/data/dusk.exr\""},
        {"lights[2].scale", "[1,0.5,0.125]"},
        {"lights[2].rotate.axis", "[0,1,0]"},
        {"lights[2].rotate.angle.rate", "6"},
        {"lights[2].visible", "false"},
        {"lights[2]", "{\"kind\":\"dome\",\"radiance\":1}"},
        {"lights[2]", "{\"kind\":\"dome\",\"gradient\":{\"along\":1,\"against\":0}}"},
        {"lights[2]", "{\"kind\":\"dome\",\"gradient\":{\"along\":1,\"against\":2}}"},
        {"lights[2]", "{\"kind\":\"dome\",\"gradient\":{\"along\":1,\"against\":0,\"axis\":[1,0,0]}}"},
    };
    enum { COUNT = sizeof edits / sizeof edits[0] };
    struct hash hashes[COUNT];

    for (size_t i = 0; i < COUNT; i++) {
        char *edited = json_edit_set(job_text_paths, edits[i][0], edits[i][1]);

        hashes[i] = hash_of_parts(edited);
        free(edited);
    }
    for (size_t i = 0; i < COUNT; i++)
        for (size_t k = 0; k < i; k++)
            if (strcmp(hashes[i].text, hashes[k].text) == 0) fail_msg("edits %zu and %zu hash alike", i, k);
}

static void one_order_that_is_stated_does_not_count(void **state)
{
    char *text = json_edit_set(job_text_full, "scene.scattering", "{\"orders\":1}");

    assert_string_equal(hash_of(text).text, hash_of(job_text_full).text);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layout_and_order_of_keys_do_not_count),
        cmocka_unit_test(spelled_out_defaults_do_not_count),
        cmocka_unit_test(what_no_picture_depends_on_does_not_count),
        cmocka_unit_test(how_much_may_be_cut_does_not_count),
        cmocka_unit_test(what_becomes_of_a_miss_does_not_count),
        cmocka_unit_test(every_value_that_a_picture_depends_on_counts),
        cmocka_unit_test(what_changes_along_with_another_counts),
        cmocka_unit_test(jobs_without_objects_keep_their_hashes),
        cmocka_unit_test(what_objects_are_counts),
        cmocka_unit_test(whose_interior_it_is_counts),
        cmocka_unit_test(orders_lights_and_random_paths_count),
        cmocka_unit_test(one_order_that_is_stated_does_not_count),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
