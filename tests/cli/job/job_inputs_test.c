// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_inputs.h"

#include "cli/job/job_document.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

static void write_file(void **state, const char *name, const char *bytes, size_t size)
{
    assert_true(file_write_atomic(temp_folder_path(state, name), bytes, size, NULL));
}

static void write_job(void **state, const char *text)
{
    write_file(state, "job.json", text, strlen(text));
}

static struct job load(void **state, const char *const sets[], size_t set_count)
{
    const char *path = temp_folder_path(state, "job.json");
    struct error error = {0};
    struct job job = {0};
    char *document = job_document_load(path, sets, set_count, &error);

    if (!document || !job_document_check(path, document, "/", &job, &error)) fail_msg("%s", error.message);
    free(document);
    return job;
}

// `expected` follows the name of the job file; "%s" in it is the test's folder.
static void assert_refused(void **state, const char *expected)
{
    const char *path = temp_folder_path(state, "job.json"), *at = strstr(expected, "%s");
    char *whole = at ? xasprintf("%s: %.*s%s%s", path, (int)(at - expected), expected, (const char *)*state, at + 2)
                     : xasprintf("%s: %s", path, expected);
    struct error error = {0};
    struct job job;
    char *document = job_document_load(path, NULL, 0, &error);

    if (document && job_document_check(path, document, "/", &job, &error)) fail_msg("taken, not \"%s\"", whole);
    assert_string_equal(error.message, whole);
    free(document);
    free(whole);
}

static char *one_medium(const char *density)
{
    char *scene = xasprintf("{\"media\":[{\"sigma_a\":1,\"density\":%s}]}", density);
    char *text = json_edit_set(job_text_glsl, "scene", scene);

    free(scene);
    return text;
}

static void paths_are_relative_to_the_job_file(void **state)
{
    static const char *const sets[] = {"scene.media[0].density.file=other.nii"};
    char *text = one_medium("{\"kind\":\"grid\",\"file\":\"in/head.nii\"}");
    struct job job;

    assert_int_equal(mkdir(temp_folder_path(state, "in"), 0700), 0);
    write_file(state, "in/head.nii", "x", 1);
    write_file(state, "other.nii", "x", 1);
    write_job(state, text);
    job = load(state, NULL, 0);
    assert_string_equal(job.scene.media[0].density.grid.file, temp_folder_path(state, "in/head.nii"));
    job_finish(&job);
    job = load(state, sets, 1);
    assert_string_equal(job.scene.media[0].density.grid.file, temp_folder_path(state, "other.nii"));
    job_finish(&job);
    free(text);
}

static void absolute_paths_stay(void **state)
{
    char *density = xasprintf("{\"kind\":\"grid\",\"file\":\"%s\"}", temp_folder_path(state, "head.nii"));
    char *text = one_medium(density);
    struct job job;

    write_file(state, "head.nii", "x", 1);
    write_job(state, text);
    job = load(state, NULL, 0);
    assert_string_equal(job.scene.media[0].density.grid.file, temp_folder_path(state, "head.nii"));
    job_finish(&job);
    free(text);
    free(density);
}

// ".." behind a link is relative to the target of the link, as for the system.
static void ways_up_are_gone(void **state)
{
    static const char *const sets[] = {"scene.media[0].density.file=link/.././/head.nii"};
    char *text = one_medium("{\"kind\":\"grid\",\"file\":\"in/../head.nii\"}");
    struct job job;

    assert_int_equal(mkdir(temp_folder_path(state, "in"), 0700), 0);
    assert_int_equal(mkdir(temp_folder_path(state, "in/deep"), 0700), 0);
    assert_int_equal(symlink("in/deep", temp_folder_path(state, "link")), 0);
    write_file(state, "head.nii", "x", 1);
    write_file(state, "in/head.nii", "x", 1);
    write_job(state, text);
    job = load(state, NULL, 0);
    assert_string_equal(job.scene.media[0].density.grid.file, temp_folder_path(state, "head.nii"));
    job_finish(&job);
    job = load(state, sets, 1);
    assert_string_equal(job.scene.media[0].density.grid.file, temp_folder_path(state, "in/head.nii"));
    job_finish(&job);
    free(text);
}

static void glsl_becomes_part_of_the_job(void **state)
{
    static const char source[] = "// \"quoted\" \\ \xc3\xa9\nfloat density(vec3 p, float t) { return 1.0; }\n";
    char *text = one_medium("{\"kind\":\"glsl\",\"file\":\"a.glsl\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}");
    struct job job;

    write_file(state, "a.glsl", source, strlen(source));
    write_job(state, text);
    job = load(state, NULL, 0);
    assert_string_equal(job.scene.media[0].density.glsl.source, source);
    assert_string_equal(job.scene.media[0].density.glsl.file, temp_folder_path(state, "a.glsl"));
    job_finish(&job);
    free(text);
}

static void glsl_may_begin_with_a_byte_order_mark(void **state)
{
    char *text = one_medium("{\"kind\":\"glsl\",\"file\":\"a.glsl\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}");
    struct job job;

    write_file(state, "a.glsl",
               "\xef\xbb\xbf"
               "float",
               8);
    write_job(state, text);
    job = load(state, NULL, 0);
    assert_string_equal(job.scene.media[0].density.glsl.source, "float");
    job_finish(&job);
    free(text);
}

// The text in the job counts, whether or not the file exists.
static void a_source_that_is_there_stays(void **state)
{
    char *text = one_medium("{\"kind\":\"glsl\",\"file\":\"none.glsl\",\"source\":\"float\",\"bounds\":"
                            "{\"kind\":\"sphere\",\"radius\":1}}");
    struct job job;

    write_job(state, text);
    job = load(state, NULL, 0);
    assert_string_equal(job.scene.media[0].density.glsl.source, "float");
    job_finish(&job);
    free(text);
}

static void glsl_that_is_no_text_is_refused(void **state)
{
    char *text = one_medium("{\"kind\":\"glsl\",\"file\":\"a.glsl\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}");
    char *large = xcalloc(1, SCENE_GLSL_SIZE_LIMIT + 1);

    write_job(state, text);
    assert_refused(state, "scene.media[0].density.file: %s/a.glsl: cannot open: No such file or directory");
    write_file(state, "a.glsl", "ab\0c", 4);
    assert_refused(state, "scene.media[0].density.file: %s/a.glsl: expected text, got a NUL byte at offset 2");
    write_file(state, "a.glsl", "abc\xe9 d", 6);
    assert_refused(state, "scene.media[0].density.file: %s/a.glsl: expected UTF-8 text, got the byte 0xe9 at offset 3");
    write_file(state, "a.glsl", "\n#version 450\n", 14);
    assert_refused(state, "scene.media[0].density.source: a.glsl:2: #version is not for densities");
    memset(large, ' ', SCENE_GLSL_SIZE_LIMIT + 1);
    write_file(state, "a.glsl", large, SCENE_GLSL_SIZE_LIMIT + 1);
    assert_refused(state, "scene.media[0].density.file: %s/a.glsl: 65537 bytes are more than the 65536 allowed");
    free(large);
    free(text);
}

static void a_missing_file_is_named(void **state)
{
    char *text = one_medium("{\"kind\":\"grid\",\"file\":\"head.nii\"}");

    write_job(state, text);
    assert_refused(state, "scene.media[0].density.file: %s/head.nii: No such file or directory");
    assert_int_equal(mkdir(temp_folder_path(state, "head.nii"), 0700), 0);
    assert_refused(state, "scene.media[0].density.file: %s/head.nii: expected a file, got a folder or a device");
    free(text);
}

static void the_first_missing_of_a_sequence_is_named(void **state)
{
    char *text = one_medium("{\"kind\":\"grid\",\"file\":\"s.##.nvdb\"}"); // frames 1-9x2
    struct job job;

    write_job(state, text);
    write_file(state, "s.01.nvdb", "x", 1);
    write_file(state, "s.03.nvdb", "x", 1);
    write_file(state, "s.07.nvdb", "x", 1);
    assert_refused(state, "scene.media[0].density.file: %s/s.05.nvdb: No such file or directory");
    write_file(state, "s.05.nvdb", "x", 1);
    write_file(state, "s.09.nvdb", "x", 1);
    job = load(state, NULL, 0);
    job_finish(&job);
    free(text);
}

static void what_is_no_job_is_left_for_the_parser(void **state)
{
    static const char *const edits[][2] = {
        {"scene", "{\"media\":{\"density\":{\"kind\":\"grid\",\"file\":\"a\"}}}"},
        {"scene.media[0].density", "{\"kind\":7,\"file\":\"a\"}"},
        {"scene.media[0].density", "{\"kind\":\"grid\",\"file\":[\"a\"]}"},
        {"scene.media[0].density", "{\"kind\":\"glsl\",\"file\":\"\"}"},
        {"scene.media[0].density", "[1]"},
        {"scene.objects", "{\"material\":{\"texture\":{\"file\":\"a\"}}}"},
        {"scene.objects", "[{\"material\":[{\"file\":\"a\"}]}]"},
        {"scene.objects", "[{\"material\":{\"texture\":{\"file\":[\"a.png\"]}}}]"},
        {"scene.objects", "[{\"material\":{\"texture\":{\"file\":\"\"}}}]"},
    };

    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        char *text = json_edit_set(job_text_glsl, edits[i][0], edits[i][1]), *document;
        struct job job;

        if (i > 0) {
            document = json_edit_set(text, "scene.media[1]", NULL);
            free(text);
            text = document;
        }
        write_job(state, text);
        document = job_document_load(temp_folder_path(state, "job.json"), NULL, 0, NULL);
        assert_non_null(document);
        assert_false(job_document_check("job.json", document, "/", &job, NULL));
        free(document);
        free(text);
    }
}

// The job with every key of objects, with files of the test's folder.
static char *objects_in_folder(void)
{
    char *floor = json_edit_set(job_text_objects, "scene.objects[0].material.texture.file", "\"tiles.png\"");
    char *text =
        json_edit_set(floor, "scene.objects[5].material.interior.density", "{\"kind\":\"grid\",\"file\":\"head.nii\"}");

    free(floor);
    return text;
}

static void files_of_objects_are_relative_to_the_job_file(void **state)
{
    char *text = objects_in_folder();
    struct job job;

    write_file(state, "tiles.png", "x", 1);
    write_file(state, "globe.png", "x", 1);
    write_file(state, "wood.exr", "x", 1);
    write_file(state, "head.nii", "x", 1);
    write_job(state, text);
    job = load(state, NULL, 0);
    assert_string_equal(job.scene.objects[0].material.texture.file, temp_folder_path(state, "tiles.png"));
    assert_string_equal(job.scene.objects[3].material.texture.file, temp_folder_path(state, "globe.png"));
    assert_string_equal(job.scene.objects[4].material.texture.file, temp_folder_path(state, "wood.exr"));
    assert_string_equal(job.scene.media[2].density.grid.file, temp_folder_path(state, "head.nii"));
    job_finish(&job);
    free(text);
}

static void absolute_paths_of_textures_stay(void **state)
{
    char *file = xasprintf("scene.objects[0].material.texture.file=\"%s\"", temp_folder_path(state, "moved/a.png"));
    const char *const sets[] = {file};
    char *text = objects_in_folder();
    struct job job;

    assert_int_equal(mkdir(temp_folder_path(state, "moved"), 0700), 0);
    write_file(state, "moved/a.png", "x", 1);
    write_file(state, "globe.png", "x", 1);
    write_file(state, "wood.exr", "x", 1);
    write_file(state, "head.nii", "x", 1);
    write_job(state, text);
    job = load(state, sets, 1);
    assert_string_equal(job.scene.objects[0].material.texture.file, temp_folder_path(state, "moved/a.png"));
    job_finish(&job);
    free(text);
    free(file);
}

static void missing_files_of_objects_are_named(void **state)
{
    char *text = objects_in_folder();

    write_job(state, text);
    assert_refused(state, "scene.objects[5].material.interior.density.file: %s/head.nii: No such file or directory");
    write_file(state, "head.nii", "x", 1);
    write_file(state, "tiles.png", "x", 1);
    assert_refused(state, "scene.objects[3].material.texture.file: %s/globe.png: No such file or directory");
    assert_int_equal(mkdir(temp_folder_path(state, "globe.png"), 0700), 0);
    assert_refused(state, "scene.objects[3].material.texture.file: %s/globe.png: expected a file, got a folder or a "
                          "device");
    free(text);
}

static void file_of_a_dome_is_relative_to_the_job_file(void **state)
{
    char *text = json_edit_set(job_text_fog, "lights", "[{\"kind\":\"dome\",\"file\":\"../skies/noon.exr\"}]");
    char *expected = xasprintf("\"file\":\"%s\"", temp_folder_path(state, "skies/noon.exr")), *document;

    assert_int_equal(mkdir(temp_folder_path(state, "jobs"), 0700), 0);
    assert_int_equal(mkdir(temp_folder_path(state, "skies"), 0700), 0);
    write_file(state, "jobs/job.json", text, strlen(text));
    document = job_document_load(temp_folder_path(state, "jobs/job.json"), NULL, 0, NULL);
    assert_non_null(document);
    if (!strstr(document, expected)) fail_msg("%s", document);
    free(document);
    free(expected);
    free(text);
}

static void missing_file_of_a_dome_is_named(void **state)
{
    char *path = xstrdup(temp_folder_path(state, "noon.exr")),
         *expected = xasprintf("lights[1].file: %s: No such", path);
    struct error error = {0};
    struct job job = {0};

    job.scene.light_count = 2;
    job.scene.lights[1].dome.image.file = path;
    assert_false(job_inputs_check(&job, &error));
    if (strncmp(error.message, expected, strlen(expected)) != 0) fail_msg("%s", error.message);
    write_file(state, "noon.exr", "x", 1);
    assert_true(job_inputs_check(&job, &error));
    free(expected);
    free(path);
}

static void glsl_of_an_interior_becomes_part_of_the_job(void **state)
{
    char *text = json_edit_set(job_text_glsl, "scene",
                               "{\"objects\":[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{"
                               "\"kind\":\"dielectric\",\"ior\":1.5,\"interior\":{\"sigma_a\":1,\"density\":{\"kind\":"
                               "\"glsl\",\"file\":\"a.glsl\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}}}}]}");
    struct job job;

    write_job(state, text);
    assert_refused(state, "scene.objects[0].material.interior.density.file: %s/a.glsl: cannot open: No such file or "
                          "directory");
    write_file(state, "a.glsl", "float", 5);
    job = load(state, NULL, 0);
    assert_string_equal(job.scene.media[0].density.glsl.source, "float");
    job_finish(&job);
    free(text);
}

int main(void)
{
#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        WITH_FOLDER(paths_are_relative_to_the_job_file),
        WITH_FOLDER(absolute_paths_stay),
        WITH_FOLDER(ways_up_are_gone),
        WITH_FOLDER(glsl_becomes_part_of_the_job),
        WITH_FOLDER(glsl_may_begin_with_a_byte_order_mark),
        WITH_FOLDER(a_source_that_is_there_stays),
        WITH_FOLDER(glsl_that_is_no_text_is_refused),
        WITH_FOLDER(a_missing_file_is_named),
        WITH_FOLDER(the_first_missing_of_a_sequence_is_named),
        WITH_FOLDER(what_is_no_job_is_left_for_the_parser),
        WITH_FOLDER(files_of_objects_are_relative_to_the_job_file),
        WITH_FOLDER(absolute_paths_of_textures_stay),
        WITH_FOLDER(missing_files_of_objects_are_named),
        WITH_FOLDER(file_of_a_dome_is_relative_to_the_job_file),
        WITH_FOLDER(missing_file_of_a_dome_is_named),
        WITH_FOLDER(glsl_of_an_interior_becomes_part_of_the_job),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
