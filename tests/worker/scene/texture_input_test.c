// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/texture_input.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/exr_maker.h"
#include "tests/support/png_maker.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"
#include "worker/picture/image.h"
#include "worker/scene/scene_inputs.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const unsigned char black[] = {0, 0, 0, 0, 0, 0}, white[] = {255, 255, 255, 255, 255, 255};

static char *write_texture(void **state, const char *name, const unsigned char *rgb)
{
    char *path = strdup(temp_folder_path(state, name));

    png_maker_write_rgb(path, 2, 1, rgb);
    return path;
}

// Two objects, of which the second has a texture.
static struct job make_job(char *file)
{
    struct job job = {.hash = "0123456789abcdef0123456789abcdef"};

    job.scene.object_count = 2;
    job.scene.objects[1].material.texture = (struct scene_texture){.file = file, .size = {3}};
    return job;
}

static void read_hash(const struct job *job, struct file_hashes *hashes, char hash[static HASH_TEXT_SIZE])
{
    struct scene_inputs inputs;
    struct error error = {{0}};

    if (!scene_inputs_open(&inputs, job, 0, &(struct scene_files){.hashes = hashes}, NULL, &error))
        fail_msg("%s", error.message);
    memcpy(hash, inputs.picture_hash, HASH_TEXT_SIZE);
    assert_string_not_equal(inputs.files_hash, "");
    scene_inputs_finish(&inputs);
}

static void picture_depends_on_what_a_texture_holds(void **state)
{
    char *file = write_texture(state, "a.png", black), *copy = write_texture(state, "copy.png", black);
    struct file_hashes *hashes = file_hashes_create();
    char first[HASH_TEXT_SIZE], again[HASH_TEXT_SIZE];
    struct job job = make_job(file);

    read_hash(&job, hashes, first);
    assert_string_not_equal(first, job.hash);
    job.scene.objects[1].material.texture.file = copy;
    read_hash(&job, hashes, again);
    assert_string_equal(again, first);
    job.scene.objects[1].material.texture.is_linear = true;
    read_hash(&job, hashes, again);
    assert_string_not_equal(again, first);
    job.scene.objects[1].material.texture = (struct scene_texture){.file = file, .size = {3}};
    png_maker_write_rgb(file, 2, 1, white);
    read_hash(&job, hashes, again);
    assert_string_not_equal(again, first);
    // The same file on another object.
    png_maker_write_rgb(file, 2, 1, black);
    job.scene.objects[0].material.texture = job.scene.objects[1].material.texture;
    job.scene.objects[1].material.texture = (struct scene_texture){0};
    read_hash(&job, hashes, again);
    assert_string_not_equal(again, first);
    file_hashes_destroy(hashes);
    free(file);
    free(copy);
}

static void changed_texture_is_noticed(void **state)
{
    char *file = write_texture(state, "a.png", black);
    struct file_hashes *hashes = file_hashes_create();
    struct job job = make_job(file);
    struct error error = {{0}};
    struct scene_inputs inputs;
    struct image image;

    assert_true(scene_inputs_open(&inputs, &job, 0, &(struct scene_files){.hashes = hashes}, NULL, NULL));
    assert_true(texture_input_load(&inputs.textures[1], &image, NULL));
    image_finish(&image);
    png_maker_write_rgb(file, 2, 1, white);
    assert_false(texture_input_load(&inputs.textures[1], &image, &error));
    assert_non_null(strstr(error.message, "a.png: it changed while the frame was made"));
    assert_null(image.rgba);
    assert_false(scene_inputs_are_lasting(&inputs)); // the next attempt may meet another file
    scene_inputs_finish(&inputs);
    file_hashes_destroy(hashes);
    free(file);
}

static void missing_or_damaged_texture_is_named(void **state)
{
    char *file = write_texture(state, "a.png", black);
    struct job job = make_job(file);
    struct error error = {{0}};
    struct scene_inputs inputs;
    bool is_lasting;

    // It may just be being written.
    volume_maker_write(file, "\x89PNG\r\n\x1a\n", 8);
    assert_false(scene_inputs_open(&inputs, &job, 0, NULL, &is_lasting, &error));
    assert_non_null(strstr(error.message, "scene.objects[1].material.texture.file: "));
    assert_non_null(strstr(error.message, "a.png: PNG: the file ends too soon"));
    assert_false(is_lasting);
    assert_int_equal(unlink(file), 0);
    assert_false(scene_inputs_open(&inputs, &job, 0, NULL, &is_lasting, &error));
    assert_non_null(strstr(error.message, "a.png: No such file"));
    assert_true(is_lasting);
    free(file);
}

// A scene whose second light is a dome that shows an image.
static struct job make_dome_job(char *file)
{
    struct job job = {.hash = "0123456789abcdef0123456789abcdef"};

    job.scene.light_count = 2;
    job.scene.lights[1] = (struct scene_light){
        .kind = SCENE_LIGHT_DOME,
        .dome = {.kind = SCENE_DOME_FILE, .image = {.file = file, .is_linear = true, .is_radiance = true}}};
    return job;
}

static void picture_depends_on_what_a_dome_shows(void **state)
{
    static const float dim[] = {1, 2, 3, 4, 5, 6}, bright[] = {1, 2, 3e5f, 4, 5, 6};
    char *file = strdup(temp_folder_path(state, "sky.exr"));
    struct file_hashes *hashes = file_hashes_create();
    char first[HASH_TEXT_SIZE], again[HASH_TEXT_SIZE];
    struct job job = make_dome_job(file);

    exr_maker_write(file, 2, 1, JOB_PIXEL_FLOAT, dim);
    read_hash(&job, hashes, first);
    assert_string_not_equal(first, job.hash);
    read_hash(&job, hashes, again);
    assert_string_equal(again, first);
    exr_maker_write(file, 2, 1, JOB_PIXEL_FLOAT, bright);
    read_hash(&job, hashes, again);
    assert_string_not_equal(again, first);
    file_hashes_destroy(hashes);
    free(file);
}

static void dome_is_read_and_its_faults_name_it(void **state)
{
    static const float dim[] = {1, 2, 3, 4, 5, 6};
    char *file = strdup(temp_folder_path(state, "sky.exr"));
    struct file_hashes *hashes = file_hashes_create();
    struct job job = make_dome_job(file);
    struct error error = {{0}};
    struct scene_inputs inputs;
    struct image image;
    bool is_lasting;

    exr_maker_write(file, 2, 1, JOB_PIXEL_FLOAT, dim);
    assert_true(scene_inputs_open(&inputs, &job, 0, &(struct scene_files){.hashes = hashes}, NULL, NULL));
    assert_true(inputs.dome.width_px == 2 && inputs.dome.height_px == 1);
    assert_true(texture_input_load(&inputs.dome, &image, NULL));
    assert_near(image.rgba[4 + 2], 6, 0);
    image_finish(&image);
    assert_false(scene_inputs_are_lasting(&inputs)); // just written
    scene_inputs_finish(&inputs);
    assert_int_equal(unlink(file), 0);
    assert_false(scene_inputs_open(&inputs, &job, 0, NULL, &is_lasting, &error));
    assert_non_null(strstr(error.message, "lights[1].file: "));
    assert_non_null(strstr(error.message, "sky.exr: No such file"));
    assert_true(is_lasting);
    file_hashes_destroy(hashes);
    free(file);
}

static void tile_has_the_shape_of_its_image(void **state)
{
    char *file = write_texture(state, "a.png", black);
    struct job job = make_job(file);
    struct scene_inputs inputs;
    double size[2];

    assert_true(scene_inputs_open(&inputs, &job, 0, NULL, NULL, NULL));
    assert_true(inputs.textures[1].width_px == 2 && inputs.textures[1].height_px == 1);
    assert_null(inputs.textures[0].source);
    texture_input_find_tile(&inputs.textures[1], size);
    assert_near(size[0], 3, 0);
    assert_near(size[1], 1.5, 0);
    scene_inputs_finish(&inputs);
    job.scene.objects[1].material.texture.size[1] = 7;
    assert_true(scene_inputs_open(&inputs, &job, 0, NULL, NULL, NULL));
    texture_input_find_tile(&inputs.textures[1], size);
    assert_near(size[1], 7, 0);
    scene_inputs_finish(&inputs);
    free(file);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(picture_depends_on_what_a_texture_holds), TEST(changed_texture_is_noticed),
        TEST(missing_or_damaged_texture_is_named),     TEST(picture_depends_on_what_a_dome_shows),
        TEST(dome_is_read_and_its_faults_name_it),     TEST(tile_has_the_shape_of_its_image),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
