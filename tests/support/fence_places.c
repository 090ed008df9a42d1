// SPDX-License-Identifier: Apache-2.0
#include "tests/support/fence_places.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"
#include "worker/sandbox/sandbox_landlock.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { NOT_ENTERED = 99 };

static const char *base; // the test's folder

const char *fence_places_at(const char *name)
{
    void *const state[] = {(void *)base};

    return temp_folder_path(state, name);
}

void fence_places_write_file(const char *path)
{
    int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);

    assert_true(fd >= 0);
    assert_int_equal(write(fd, "text", 4), 4);
    close(fd);
}

int fence_places_make(void **state)
{
    static const char *const folders[] = {"in", "in/ann", "in/bob", "out", "out/ann", "out/bob", "state"};
    static const char *const files[] = {"in/ann/a.raw", "in/ann/b.raw",  "in/bob/b.raw",
                                        "in/top.raw",   "out/bob/b.exr", "state/store"};

    if (temp_folder_create(state) != 0) return -1;
    base = *state;
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++)
        assert_int_equal(mkdir(fence_places_at(folders[i]), 0700), 0);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        fence_places_write_file(fence_places_at(files[i]));
    return 0;
}

static struct fence_job make_job(const char *folder, const char *name, const char *output)
{
    struct fence_job job = {.output_root = strdup(fence_places_at("out")), .output_folder = strdup(output)};

    job.inputs = calloc(1, sizeof job.inputs[0]);
    job.input_count = 1;
    job.inputs[0] = (struct fence_input){strdup("the file"), strdup(fence_places_at("in")), strdup(folder), NULL};
    assert_true(asprintf(&job.inputs[0].path, "%s/%s%s%s", fence_places_at("in"), folder, *folder ? "/" : "", name) >
                0);
    return job;
}

struct fence fence_places_job(const char *folder, const char *name, const char *output)
{
    struct fence fence = {.job = make_job(folder, name, output)};

    path_list_add(&fence.closed, strdup(fence_places_at("state")));
    return fence;
}

void fence_places_add_job(struct fence *fence, const char *folder, const char *name, const char *output)
{
    fence->others = realloc(fence->others, (fence->other_count + 1) * sizeof fence->others[0]);
    assert_non_null(fence->others);
    fence->others[fence->other_count++] = make_job(folder, name, output);
}

bool fence_places_has_landlock(void)
{
    struct sandbox_landlock landlock;

    assert_true(sandbox_landlock_open(&landlock, NULL));
    sandbox_landlock_close(&landlock);
    return landlock.abi > 0;
}

bool fence_places_enter(struct fence *fence, enum sandbox_fault *fault, struct error *error)
{
    const struct sandbox_job job = {.fence = fence};
    char holds[SANDBOX_TEXT_SIZE];
    bool ok = sandbox_enter_job(&job, holds, fault, error);

    fence_finish(fence);
    return ok;
}

void fence_places_run(struct fence fence, int (*probe)(void))
{
    pid_t child = fork();
    int status;

    if (child == 0) {
        enum sandbox_fault fault;
        struct error error = {0};
        bool is_in = fence_places_enter(&fence, &fault, &error);

        if (!is_in) fprintf(stderr, "%s\n", error.message);
        _exit(is_in ? probe() : NOT_ENTERED);
    }
    fence_finish(&fence);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status)) fail_msg("probe %d was not as expected", WEXITSTATUS(status));
}

void fence_places_skip_without_landlock(void)
{
    if (fence_places_has_landlock()) return;
    print_message("this kernel has no Landlock: files are not fenced\n");
    skip();
}

bool fence_places_can_open(const char *path, int flags)
{
    int fd = open(path, flags, 0600);

    if (fd >= 0) close(fd);
    return fd >= 0;
}

bool fence_places_is_refused(long result)
{
    return result < 0 && (errno == ENOSYS || errno == EPERM || errno == EACCES);
}
