// SPDX-License-Identifier: Apache-2.0
#include "tests/support/example_job.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/job/job_hash.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "tests/support/folders.h"
#include "tests/support/json_edit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static char *find_file(char *owned_path, const char *job_path)
{
    const char *slash = strrchr(job_path, '/');
    char *path;

    if (!owned_path || *owned_path == '/' || !slash) return owned_path;
    path = xasprintf("%.*s/%s", (int)(slash - job_path), job_path, owned_path);
    free(owned_path);
    return path;
}

// As the command line does it.
static void find_inputs(struct scene_density *density, const char *job_path)
{
    struct error error = {{0}};
    struct scene_glsl *glsl = &density->glsl;

    if (density->kind == SCENE_DENSITY_GRID) density->grid.file = find_file(density->grid.file, job_path);
    if (density->kind != SCENE_DENSITY_GLSL) return;
    glsl->file = find_file(glsl->file, job_path);
    if (!glsl->source && !file_read_text(glsl->file, SCENE_GLSL_SIZE_LIMIT, &glsl->source, NULL, &error))
        fail_msg("%s", error.message);
}

static char *read_text(const char *path)
{
    struct error error = {{0}};
    char *text = NULL;

    if (!file_read_text(path, JOB_DOCUMENT_LIMIT, &text, NULL, &error)) fail_msg("%s: %s", path, error.message);
    return text;
}

static void parse(struct job *job, const char *text, const char *path)
{
    struct error error = {{0}};

    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s: %s", path, error.message);
    for (size_t i = 0; i < job->scene.medium_count; i++)
        find_inputs(&job->scene.media[i].density, path);
    for (size_t i = 0; i < job->scene.object_count; i++) {
        struct scene_texture *texture = &job->scene.objects[i].material.texture;

        texture->file = find_file(texture->file, path);
    }
    job_hash_picture(job, job->hash);
}

// NULL: the document states its method itself. The caller frees it.
static char *find_stated_quality(const char *name)
{
    char *text = read_text(PROJECT_ROOT "/tests/support/stated_quality.json"), *quality = NULL;
    struct json_node root, node;
    struct cJSON *tree = NULL;

    assert_true(json_parse(&tree, text, strlen(text), NULL));
    root = json_node_root(tree);
    node = json_node_child(&root, name);
    if (!json_node_is_absent(&node)) quality = json_node_format(&node);
    json_delete(tree);
    free(text);
    return quality;
}

void example_job_load(struct job *job, const char *name)
{
    const char *folder = getenv("MARCHD_TEST_JOBS");
    char *path = xasprintf("%s/%s.json", folder ? folder : PROJECT_ROOT "/jobs", name);
    char *text = read_text(path), *quality = find_stated_quality(name);

    if (quality) {
        char *document = text;

        text = json_edit_set(document, "quality", quality);
        free(document);
    }
    parse(job, text, path);
    free(quality);
    free(text);
    free(path);
}

void example_job_load_file(struct job *job, const char *path)
{
    char *text = read_text(path);

    parse(job, text, path);
    free(text);
}

void example_job_shrink(struct job *job, int width_px, int height_px, double time)
{
    job->width_px = width_px;
    job->height_px = height_px;
    job->time_offset = time;
}
