// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_inputs.h"

#include "cli/job/json_set.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/utf8.h"
#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/scene/input_path.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const int64_t FRAMES_CHECKED = 10 * 1000;

// The folder of relative paths, owned by the caller; NULL on failure.
static char *find_folder(const char *job_path, struct error *error)
{
    const char *slash = strrchr(job_path, '/');
    char *folder = slash ? xstrndup(job_path, (size_t)(slash - job_path) + 1) : xstrdup(".");
    char *absolute = realpath(folder, NULL);

    if (!absolute) error_set_errno(error, errno, "%s", folder);
    free(folder);
    return absolute;
}

// Removes the byte order mark that some editors put before UTF-8 text: it is not allowed within JSON.
static void skip_byte_order_mark(char *text, size_t *length)
{
    static const char mark[] = "\xef\xbb\xbf";

    if (strncmp(text, mark, strlen(mark)) != 0) return;
    *length -= strlen(mark);
    memmove(text, text + strlen(mark), *length + 1);
}

static char *read_glsl(const char *path, struct error *error)
{
    size_t length, size;
    char *text;

    if (!file_read_text(path, SCENE_GLSL_SIZE_LIMIT, &text, &length, error)) goto fail;
    if (strlen(text) != length) {
        error_set(error, "expected text, got a NUL byte at offset %zu", strlen(text));
        goto fail;
    }
    skip_byte_order_mark(text, &length);
    for (size_t i = 0; i < length; i += size) {
        size = utf8_character_length(text + i, length - i);
        if (size > 0) continue;
        error_set(error, "expected UTF-8 text, got the byte 0x%02x at offset %zu", (unsigned char)text[i], i);
        goto fail;
    }
    return text;
fail:
    error_prefix(error, "%s", path);
    free(text);
    return NULL;
}

static bool set_member(char **document, const char *place, const char *key, const char *text, struct error *error)
{
    char *path = xasprintf("%s.%s", place, key);
    bool ok = json_set_text(document, path, text, error);

    free(path);
    return ok;
}

// The absolute path, owned by the caller. Resolves ".." ("../volumes/a.nvdb"), which daemons refuse because it could
// lead out of their roots.
static char *make_absolute(const char *path, const char *folder)
{
    char *joined = *path == '/' ? xstrdup(path) : xasprintf("%s/%s", strcmp(folder, "/") == 0 ? "" : folder, path);
    char *slash = strrchr(joined, '/');
    char *real, *plain = NULL;

    if (input_path_is_plain(joined)) return joined;
    *slash = '\0';
    real = realpath(joined, NULL);
    *slash = '/';
    if (real) plain = xasprintf("%s/%s", strcmp(real, "/") == 0 ? "" : real, slash + 1);
    free(real);
    if (!plain) return joined;
    free(joined);
    return plain;
}

// A JSON object whose file is resolved.
struct site {
    char **document;
    const char *folder; // of relative paths
    const char *place;
};

static bool resolve_density(const struct site *site, const struct json_node *density, struct error *error)
{
    struct json_node kind = json_node_child(density, "kind"), file = json_node_child(density, "file");
    struct json_node source = json_node_child(density, "source");
    const char *kind_name, *path;
    char *absolute, *text = NULL;
    bool is_glsl, ok = true;

    if (!json_read_string(&kind, &kind_name, NULL) || !json_read_string(&file, &path, NULL)) return true;
    is_glsl = strcmp(kind_name, "glsl") == 0;
    if ((!is_glsl && strcmp(kind_name, "grid") != 0) || !input_path_check(path, NULL)) return true;
    absolute = make_absolute(path, site->folder);
    if (is_glsl && json_node_is_absent(&source)) {
        text = read_glsl(absolute, error);
        if (!text) error_prefix(error, "%s.file", site->place);
        ok = text && set_member(site->document, site->place, "source", text, error);
    }
    ok = ok && set_member(site->document, site->place, "file", absolute, error);
    free(absolute);
    free(text);
    return ok;
}

// An image: a texture, or a dome.
static bool resolve_image(const struct site *site, const struct json_node *image, struct error *error)
{
    struct json_node file = json_node_child(image, "file");
    const char *path;
    char *absolute;
    bool ok;

    if (!json_read_string(&file, &path, NULL) || !input_path_check(path, NULL)) return true;
    absolute = make_absolute(path, site->folder);
    ok = set_member(site->document, site->place, "file", absolute, error);
    free(absolute);
    return ok;
}

static bool resolve_media(char **document, const struct json_node *scene, const char *folder, struct error *error)
{
    struct json_node media = json_node_child(scene, "media"), medium = {0};
    bool ok = true;

    while (ok && json_node_type(&media) == JSON_ARRAY && json_node_next(&media, &medium)) {
        struct json_node density = json_node_child(&medium, "density");
        char *place = xasprintf("scene.media[%zu].density", medium.index);

        ok = resolve_density(&(struct site){document, folder, place}, &density, error);
        free(place);
    }
    return ok;
}

static bool resolve_objects(char **document, const struct json_node *scene, const char *folder, struct error *error)
{
    struct json_node objects = json_node_child(scene, "objects"), object = {0};
    bool ok = true;

    while (ok && json_node_type(&objects) == JSON_ARRAY && json_node_next(&objects, &object)) {
        struct json_node material = json_node_child(&object, "material");
        struct json_node texture = json_node_child(&material, "texture");
        struct json_node interior = json_node_child(&material, "interior");
        struct json_node density = json_node_child(&interior, "density");
        char *texture_place = xasprintf("scene.objects[%zu].material.texture", object.index);
        char *density_place = xasprintf("scene.objects[%zu].material.interior.density", object.index);

        ok = resolve_image(&(struct site){document, folder, texture_place}, &texture, error) &&
             resolve_density(&(struct site){document, folder, density_place}, &density, error);
        free(density_place);
        free(texture_place);
    }
    return ok;
}

static bool resolve_lights(char **document, const struct json_node *job, const char *folder, struct error *error)
{
    struct json_node lights = json_node_child(job, "lights"), light = {0};
    bool ok = true;

    while (ok && json_node_type(&lights) == JSON_ARRAY && json_node_next(&lights, &light)) {
        char *place = xasprintf("lights[%zu]", light.index);

        ok = resolve_image(&(struct site){document, folder, place}, &light, error);
        free(place);
    }
    return ok;
}

bool job_inputs_resolve(char **document, const char *job_path, struct error *error)
{
    char *folder = find_folder(job_path, error);
    struct cJSON *root = NULL;
    struct json_node node, scene;
    bool ok = false;

    if (!folder) return false;
    if (!json_parse(&root, *document, strlen(*document), error)) goto out;
    node = json_node_root(root);
    scene = json_node_child(&node, "scene");
    ok = resolve_media(document, &scene, folder, error) && resolve_objects(document, &scene, folder, error) &&
         resolve_lights(document, &node, folder, error);
out:
    json_delete(root);
    free(folder);
    return ok;
}

static bool check_file(const char *path, struct error *error)
{
    struct stat status;

    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode)) {
        error_set(error, "%s: expected a file, got a folder or a device", path);
        return false;
    }
    if (access(path, R_OK) == 0) return true;
    error_set_errno(error, errno, "%s", path);
    return false;
}

static bool check_grid(const struct job *job, const struct scene_grid *grid, struct error *error)
{
    int64_t count = input_path_is_sequence(grid->file) ? frame_range_count(&job->frames) : 1;

    if (count > FRAMES_CHECKED) count = FRAMES_CHECKED;
    for (int64_t i = 0; i < count; i++) {
        char *path = input_path_format(grid->file, frame_range_at(&job->frames, i));
        bool ok = check_file(path, error);

        free(path);
        if (!ok) return false;
    }
    return true;
}

bool job_inputs_check(const struct job *job, struct error *error)
{
    const struct scene *scene = &job->scene;
    char place[64];

    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_density *density = &scene->media[i].density;

        if (density->kind != SCENE_DENSITY_GRID || check_grid(job, &density->grid, error)) continue;
        scene_format_medium_place(scene, i, place, sizeof place);
        error_prefix(error, "%s.density.file", place);
        return false;
    }
    for (size_t i = 0; i < scene->object_count; i++) {
        const char *file = scene->objects[i].material.texture.file;

        if (!file || check_file(file, error)) continue;
        error_prefix(error, "scene.objects[%zu].material.texture.file", i);
        return false;
    }
    for (size_t i = 0; i < scene->light_count; i++) {
        const char *file = scene->lights[i].dome.image.file;

        if (!file || check_file(file, error)) continue;
        error_prefix(error, "lights[%zu].file", i);
        return false;
    }
    return true;
}
