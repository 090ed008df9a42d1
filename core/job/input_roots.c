// SPDX-License-Identifier: Apache-2.0
#include "core/job/input_roots.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/path_list.h"
#include "core/job/job.h"
#include "core/scene/file_format.h"
#include "core/scene/input_path.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static bool fail_outside(const char *place, const char *path, const struct path_list *roots, struct error *error)
{
    char list[512];

    path_list_format(roots, list, sizeof list);
    error_set(error, "%s: expected a file below %s, got \"%.300s\"; marchd's --input-root says where jobs may read",
              place, list, path);
    return false;
}

static char *folder_below(const char *root, const char *path)
{
    size_t skipped = strlen(root);
    const char *slash;

    while (skipped > 0 && root[skipped - 1] == '/')
        skipped--;
    slash = strrchr(path + skipped, '/');
    return slash == path + skipped ? xstrdup("") : xstrndup(path + skipped + 1, (size_t)(slash - path) - skipped - 1);
}

static bool add_input(struct job_inputs *inputs, const char *place, const char *path, const struct path_list *roots,
                      struct error *error)
{
    struct job_input *input;
    const char *root;

    if (!input_path_is_plain(path)) {
        error_set(error, "%s: expected an absolute path without \".\", \"..\" and doubled slashes, got \"%.300s\"",
                  place, path);
        return false;
    }
    root = path_list_find_root(roots, path);
    if (!root) return fail_outside(place, path, roots, error);
    inputs->inputs = xgrow(inputs->inputs, &inputs->capacity, inputs->count + 1, sizeof inputs->inputs[0]);
    input = &inputs->inputs[inputs->count++];
    *input = (struct job_input){.path = xstrdup(path), .root = xstrdup(root), .folder = folder_below(root, path)};
    snprintf(input->place, sizeof input->place, "%s", place);
    return true;
}

static void add_path(struct job_paths *paths, const char *place, const char *path)
{
    struct job_path *added;

    paths->paths = xgrow(paths->paths, &paths->capacity, paths->count + 1, sizeof paths->paths[0]);
    added = &paths->paths[paths->count++];
    *added = (struct job_path){.path = xstrdup(path)};
    snprintf(added->place, sizeof added->place, "%s", place);
}

void job_paths_list(struct job_paths *paths, const struct job *job)
{
    const struct scene *scene = &job->scene;
    char owner[INPUT_PLACE_SIZE / 2], place[INPUT_PLACE_SIZE];

    *paths = (struct job_paths){0};
    for (size_t i = 0; i < scene->medium_count; i++) {
        if (scene->media[i].density.kind != SCENE_DENSITY_GRID) continue;
        scene_format_medium_place(scene, i, owner, sizeof owner);
        snprintf(place, sizeof place, "%s.density.file", owner);
        add_path(paths, place, scene->media[i].density.grid.file);
    }
    for (size_t i = 0; i < scene->object_count; i++) {
        if (!scene->objects[i].material.texture.file) continue;
        snprintf(place, sizeof place, "scene.objects[%zu].material.texture.file", i);
        add_path(paths, place, scene->objects[i].material.texture.file);
    }
    for (size_t i = 0; i < scene->light_count; i++) {
        if (!scene->lights[i].dome.image.file) continue;
        snprintf(place, sizeof place, "lights[%zu].file", i);
        add_path(paths, place, scene->lights[i].dome.image.file);
    }
}

void job_paths_finish(struct job_paths *paths)
{
    for (size_t i = 0; i < paths->count; i++)
        free(paths->paths[i].path);
    free(paths->paths);
    *paths = (struct job_paths){0};
}

bool input_roots_find(struct job_inputs *inputs, const struct job_paths *paths, const struct path_list *roots,
                      struct error *error)
{
    bool ok = true;

    *inputs = (struct job_inputs){0};
    for (size_t i = 0; i < paths->count && ok; i++)
        ok = add_input(inputs, paths->paths[i].place, paths->paths[i].path, roots, error);
    if (!ok) job_inputs_finish(inputs);
    return ok;
}

bool job_inputs_need_converter(const struct job_inputs *inputs)
{
    for (size_t i = 0; i < inputs->count; i++) {
        const struct file_format *format = file_format_find(inputs->inputs[i].path);

        if (format && format->needs_converter) return true;
    }
    return false;
}

void job_inputs_finish(struct job_inputs *inputs)
{
    for (size_t i = 0; i < inputs->count; i++) {
        free(inputs->inputs[i].path);
        free(inputs->inputs[i].root);
        free(inputs->inputs[i].folder);
    }
    free(inputs->inputs);
    *inputs = (struct job_inputs){0};
}

static int open_beneath(int root_fd, const char *path, uint64_t flags)
{
    struct open_how how = {.flags = O_PATH | O_CLOEXEC | flags, .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};

    return (int)syscall(SYS_openat2, root_fd, path, &how, sizeof how);
}

// Below "/" links may lead anywhere.
static bool is_everything(const char *root)
{
    return strspn(root, "/") == strlen(root);
}

static void set_cause(struct error *error, int reason, const char *root, const char *path)
{
    if (reason == EXDEV)
        error_set(error, "\"%.300s\" leads out of %.200s: links in it must be relative and stay below it", path, root);
    else
        error_set_errno(error, reason, "cannot open \"%.300s\" below %.200s", path, root);
}

int input_roots_open_folder(const char *root, const char *folder, struct error *error)
{
    int root_fd = open(root, O_PATH | O_DIRECTORY | O_CLOEXEC), fd, reason;

    if (root_fd < 0) {
        reason = errno;
        error_set_errno(error, reason, "cannot open input root %.200s", root);
        errno = reason;
        return -1;
    }
    if (!*folder) return root_fd;
    fd = is_everything(root) ? openat(root_fd, folder, O_PATH | O_DIRECTORY | O_CLOEXEC)
                             : open_beneath(root_fd, folder, O_DIRECTORY);
    reason = errno;
    close(root_fd);
    if (fd < 0) set_cause(error, reason, root, folder);
    errno = reason;
    return fd;
}

// A missing file is an error of its frame only, and so is any file of a sequence.
static int check_file(const struct job_input *input, struct error *error)
{
    int root_fd, fd, reason;
    char *below;

    if (is_everything(input->root) || input_path_is_sequence(input->path)) return 0;
    root_fd = open(input->root, O_PATH | O_DIRECTORY | O_CLOEXEC);
    below = xasprintf("%s%s%s", input->folder, *input->folder ? "/" : "", strrchr(input->path, '/') + 1);
    fd = root_fd < 0 ? -1 : open_beneath(root_fd, below, 0);
    reason = fd < 0 ? errno : 0;
    if (reason != EXDEV && reason != ELOOP) reason = 0;
    if (reason) set_cause(error, reason, input->root, below);
    free(below);
    if (fd >= 0) close(fd);
    if (root_fd >= 0) close(root_fd);
    return reason;
}

int input_roots_check_opening(const struct job_input *input, struct error *error)
{
    int fd = input_roots_open_folder(input->root, input->folder, error);
    int reason = fd < 0 ? errno : check_file(input, error);

    if (fd >= 0) close(fd);
    if (reason) error_prefix(error, "%s", input->place);
    return reason;
}
