// SPDX-License-Identifier: Apache-2.0
#include "core/job/input_roots.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/path_list.h"
#include "core/job/job.h"
#include "tests/support/temp_folder.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <sys/stat.h>

#include <cmocka.h>

// A job with a grid, a texture and code that has a file's name.
static void make_job(struct job *job, const char *grid, const char *texture)
{
    struct scene *scene = &job->scene;

    *job = (struct job){0};
    scene->media[0].density.kind = SCENE_DENSITY_GLSL;
    scene->media[0].density.glsl.file = (char *)"/anywhere/else.glsl";
    scene->media[1].density.kind = SCENE_DENSITY_GRID;
    scene->media[1].density.grid.file = (char *)grid;
    scene->medium_count = 2;
    scene->objects[0].material.texture.file = (char *)texture;
    scene->object_count = 1;
}

static struct path_list make_roots(const char *first, const char *second)
{
    struct path_list roots = {0};

    path_list_add(&roots, xstrdup(first));
    if (second) path_list_add(&roots, xstrdup(second));
    return roots;
}

static void assert_found(const char *first, const char *second, const char *grid, const char *root, const char *folder)
{
    struct path_list roots = make_roots(first, second);
    struct job job;
    struct job_inputs inputs;
    struct job_paths paths;
    struct error error = {0};

    make_job(&job, grid, NULL);
    job_paths_list(&paths, &job);
    if (!input_roots_find(&inputs, &paths, &roots, &error)) fail_msg("%s", error.message);
    job_paths_finish(&paths);
    assert_int_equal(inputs.count, 1);
    assert_string_equal(inputs.inputs[0].root, root);
    assert_string_equal(inputs.inputs[0].folder, folder);
    assert_string_equal(inputs.inputs[0].path, grid);
    assert_string_equal(inputs.inputs[0].place, "scene.media[1].density.file");
    job_inputs_finish(&inputs);
    path_list_finish(&roots);
}

static void a_file_has_a_root_and_a_folder_below_it(void **state)
{
    assert_found("/in", NULL, "/in/ann/v1/smoke.####.nvdb", "/in", "ann/v1");
    assert_found("/in", NULL, "/in/head.nii", "/in", "");
    assert_found("/", NULL, "/data/head.nii", "/", "data");
    assert_found("/", NULL, "/head.nii", "/", "");
    assert_found("/in", "/usr/share", "/usr/share/a/..b/.c", "/usr/share", "a/..b");
}

static void assert_refused(const char *grid, const char *texture, const char *message)
{
    struct path_list roots = make_roots("/in", "/usr/share");
    struct job job;
    struct job_inputs inputs;
    struct job_paths paths;
    struct error error = {0};

    make_job(&job, grid, texture);
    job_paths_list(&paths, &job);
    if (input_roots_find(&inputs, &paths, &roots, &error)) fail_msg("accepted: %s %s", grid, texture);
    job_paths_finish(&paths);
    assert_string_equal(error.message, message);
    assert_int_equal(inputs.count, 0);
    path_list_finish(&roots);
}

#define WHO "; marchd's --input-root says where jobs may read"

static void what_is_below_no_root_is_refused_with_its_place(void **state)
{
    assert_refused("/etc/shadow", NULL,
                   "scene.media[1].density.file: expected a file below /in or /usr/share, got \"/etc/shadow\"" WHO);
    assert_refused("/input/a", NULL,
                   "scene.media[1].density.file: expected a file below /in or /usr/share, got \"/input/a\"" WHO);
    assert_refused("/in", NULL,
                   "scene.media[1].density.file: expected a file below /in or /usr/share, got \"/in\"" WHO);
    assert_refused(
        "/in/a", "/home/b.png",
        "scene.objects[0].material.texture.file: expected a file below /in or /usr/share, got \"/home/b.png\"" WHO);
}

static void a_dome_is_read_below_a_root(void **state)
{
    struct path_list roots = make_roots("/in", "/usr/share");
    struct job_inputs inputs;
    struct job_paths paths;
    struct error error = {0};
    struct job job = {0};

    job.scene.light_count = 2;
    job.scene.lights[1].dome.image.file = (char *)"/in/skies/noon.exr";
    job_paths_list(&paths, &job);
    if (!input_roots_find(&inputs, &paths, &roots, &error)) fail_msg("%s", error.message);
    assert_int_equal(inputs.count, 1);
    assert_string_equal(inputs.inputs[0].place, "lights[1].file");
    assert_string_equal(inputs.inputs[0].folder, "skies");
    job_inputs_finish(&inputs);
    job_paths_finish(&paths);
    job.scene.lights[1].dome.image.file = (char *)"/etc/noon.exr";
    job_paths_list(&paths, &job);
    assert_false(input_roots_find(&inputs, &paths, &roots, &error));
    assert_string_equal(error.message,
                        "lights[1].file: expected a file below /in or /usr/share, got \"/etc/noon.exr\"" WHO);
    job_paths_finish(&paths);
    path_list_finish(&roots);
}

static void paths_with_tricks_are_refused(void **state)
{
    static const char *const paths[] = {"/in/../etc/shadow", "/in/./a", "/in//a", "//in/a", "in/a",
                                        "/in/a/..",          "/in/a/",  ""};
    char message[200];

    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        snprintf(message, sizeof message,
                 "scene.media[1].density.file: expected an absolute path without \".\", \"..\" and doubled slashes, "
                 "got \"%s\"",
                 paths[i]);
        assert_refused(paths[i], NULL, message);
    }
}

static void make_links(void **state)
{
    assert_int_equal(mkdir(temp_folder_path(state, "in"), 0755), 0);
    assert_int_equal(mkdir(temp_folder_path(state, "in/ann"), 0755), 0);
    assert_int_equal(mkdir(temp_folder_path(state, "secret"), 0755), 0);
    assert_int_equal(symlink("ann", temp_folder_path(state, "in/inside")), 0);
    assert_int_equal(symlink("../secret", temp_folder_path(state, "in/outside")), 0);
    assert_int_equal(symlink(temp_folder_path(state, "in/ann"), temp_folder_path(state, "in/absolute")), 0);
    assert_int_equal(symlink("/proc/self/cwd", temp_folder_path(state, "in/magic")), 0);
    assert_int_equal(symlink("../../secret/key", temp_folder_path(state, "in/ann/key")), 0);
    assert_int_equal(symlink("b", temp_folder_path(state, "in/ann/a")), 0);
}

static bool opens(void **state, const char *root, const char *folder, const char *cause)
{
    struct error error = {0};
    int fd = input_roots_open_folder(temp_folder_path(state, root), folder, &error);

    if (fd >= 0) close(fd);
    if (fd < 0 && !strstr(error.message, cause)) fail_msg("%s", error.message);
    return fd >= 0;
}

static void a_folder_is_opened_below_its_root(void **state)
{
    make_links(state);
    assert_true(opens(state, "in", "", ""));
    assert_true(opens(state, "in", "ann", ""));
    assert_true(opens(state, "in", "inside", ""));
    assert_false(opens(state, "in", "outside", "leads out of"));
    assert_false(opens(state, "in", "absolute", "leads out of"));
    assert_false(opens(state, "in", "magic", "leads out of"));
    assert_false(opens(state, "in", "..", "leads out of"));
    assert_false(opens(state, "in", "none", "No such file"));
    assert_false(opens(state, "none", "", "cannot open input root"));
}

static bool checks(void **state, const char *name, const char *cause)
{
    char *path = xasprintf("/in/ann/%s", name);
    struct job_input input = {.path = path, .folder = (char *)"ann", .place = "here"};
    struct error error = {0};
    char root[256];
    bool ok;

    snprintf(root, sizeof root, "%s", temp_folder_path(state, "in"));
    input.root = root;
    ok = input_roots_check_opening(&input, &error) == 0;
    if (!ok && (!strstr(error.message, cause) || strncmp(error.message, "here: ", 6) != 0))
        fail_msg("%s", error.message);
    free(path);
    return ok;
}

static void a_file_that_is_a_link_out_of_its_root_is_refused(void **state)
{
    make_links(state);
    assert_true(checks(state, "a", ""));
    assert_true(checks(state, "not_there_yet", ""));
    assert_false(checks(state, "key", "\"ann/key\" leads out of"));
}

static void below_everything_links_lead_anywhere(void **state)
{
    struct error error = {0};
    int fd;

    make_links(state);
    fd = input_roots_open_folder("/", temp_folder_path(state, "in/absolute") + 1, &error);
    assert_true(fd >= 0);
    close(fd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_has_a_root_and_a_folder_below_it),
        cmocka_unit_test(what_is_below_no_root_is_refused_with_its_place),
        cmocka_unit_test(a_dome_is_read_below_a_root),
        cmocka_unit_test(paths_with_tricks_are_refused),
        cmocka_unit_test_setup_teardown(a_folder_is_opened_below_its_root, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_file_that_is_a_link_out_of_its_root_is_refused, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(below_everything_links_lead_anywhere, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
