// SPDX-License-Identifier: Apache-2.0
#include "daemon/slurm/slurm_lease.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { TEXT_SIZE = 24 };

struct slurm_lease {
    uv_loop_t *loop;
    char *folder, *name, *path; // owned
    uv_work_t work;
    struct error error;   // of the try that runs
    struct error trouble; // of the latest; empty: none
    int64_t count;        // 0: not read yet
    bool is_moving, is_held, is_closing;
};

struct slurm_lease *slurm_lease_create(uv_loop_t *loop, const char *folder, const char *name)
{
    struct slurm_lease *lease = xcalloc(1, sizeof *lease);

    lease->loop = loop;
    lease->folder = xstrdup(folder);
    lease->name = xstrdup(name);
    lease->path = xasprintf("%s/%s", folder, name);
    lease->work.data = lease;
    return lease;
}

static void destroy(struct slurm_lease *lease)
{
    free(lease->folder);
    free(lease->name);
    free(lease->path);
    free(lease);
}

// Whoever may write where the pictures are is not to say how long allocations stay.
static int open_folder(const char *path, struct error *error)
{
    int fd = -1;
    struct stat facts;

    if (mkdir(path, 0700) != 0 && errno != EEXIST) {
        error_set_errno(error, errno, "%s", path);
        return -1;
    }
    fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0) {
        error_set_errno(error, errno, "%s", path);
    } else if (fstat(fd, &facts) != 0 || facts.st_uid != geteuid() || (facts.st_mode & 022)) {
        error_set(error, "%s: expected a folder that only the daemon's user may write", path);
        close(fd);
        fd = -1;
    }
    return fd;
}

static bool write_count(int folder_fd, struct slurm_lease *lease, struct error *error)
{
    char text[TEXT_SIZE] = "";
    int fd = openat(folder_fd, lease->name, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600), length;
    bool ok = false;

    if (fd < 0) {
        error_set_errno(error, errno, "%s", lease->path);
        return false;
    }
    if (lease->count == 0 && pread(fd, text, sizeof text - 1, 0) > 0) lease->count = strtoll(text, NULL, 10);
    if (lease->count < 0 || lease->count > INT64_MAX / 2) lease->count = 0;
    length = snprintf(text, sizeof text, "%020" PRId64 "\n", ++lease->count);
    ok = pwrite(fd, text, (size_t)length, 0) == length && ftruncate(fd, length) == 0;
    // Others see it once it is closed.
    if (close(fd) != 0) ok = false;
    if (!ok) error_set_errno(error, errno, "%s", lease->path);
    return ok;
}

static void on_work(uv_work_t *work)
{
    struct slurm_lease *lease = work->data;
    int fd;

    lease->error = (struct error){0};
    fd = open_folder(lease->folder, &lease->error);
    if (fd < 0) return;
    (void)write_count(fd, lease, &lease->error);
    close(fd);
}

static void on_done(uv_work_t *work, int status)
{
    struct slurm_lease *lease = work->data;

    lease->is_moving = false;
    lease->trouble = lease->error;
    if (lease->trouble.message[0] == '\0') lease->is_held = true;
    if (lease->is_closing) destroy(lease);
}

void slurm_lease_move(struct slurm_lease *lease)
{
    if (lease->is_moving) return;
    lease->is_moving = uv_queue_work(lease->loop, &lease->work, on_work, on_done) == 0;
}

const char *slurm_lease_path(const struct slurm_lease *lease)
{
    return lease->path;
}

bool slurm_lease_is_held(const struct slurm_lease *lease)
{
    return lease->is_held;
}

const char *slurm_lease_trouble(const struct slurm_lease *lease)
{
    return lease->trouble.message[0] ? lease->trouble.message : NULL;
}

void slurm_lease_close(struct slurm_lease *lease)
{
    if (!lease) return;
    lease->is_closing = true;
    if (!lease->is_moving) destroy(lease);
}
