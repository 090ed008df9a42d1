// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_counts.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { TEXT_SIZE = 64 };

static int open_file(const char *folder, int flags)
{
    char *path = xasprintf("%s/counts", folder);
    int fd = open(path, flags | O_CLOEXEC | O_NOFOLLOW, 0600);

    free(path);
    return fd;
}

bool store_counts_read(const char *folder, struct store_counts *counts)
{
    int fd = open_file(folder, O_RDONLY);
    char text[TEXT_SIZE] = "";
    ssize_t length = fd >= 0 ? read(fd, text, sizeof text - 1) : -1;
    int end = 0;

    *counts = (struct store_counts){0};
    if (fd >= 0) close(fd);
    if (length <= 0) return false;
    if (sscanf(text, "job %" SCNd64 " epoch %" SCNd64 "\n%n", &counts->last_job_id, &counts->epoch, &end) == 2 &&
        end == length && counts->last_job_id >= 0 && counts->epoch >= 0)
        return true;
    *counts = (struct store_counts){0};
    return false;
}

// Numbers of a fixed width are written in place: a full disk does not keep them from growing.
bool store_counts_raise(const char *folder, const struct store_counts *counts, struct error *error)
{
    struct store_counts raised;
    char text[TEXT_SIZE];
    int fd, length;
    bool ok = false;

    store_counts_read(folder, &raised);
    if (counts->last_job_id <= raised.last_job_id && counts->epoch <= raised.epoch) return true;
    if (counts->last_job_id > raised.last_job_id) raised.last_job_id = counts->last_job_id;
    if (counts->epoch > raised.epoch) raised.epoch = counts->epoch;
    fd = open_file(folder, O_WRONLY | O_CREAT);
    if (fd >= 0) {
        length =
            snprintf(text, sizeof text, "job %019" PRId64 " epoch %019" PRId64 "\n", raised.last_job_id, raised.epoch);
        errno = ENOSPC; // of a write of a part
        ok = pwrite(fd, text, (size_t)length, 0) == length && fdatasync(fd) == 0;
    }
    if (!ok) error_set_errno(error, errno, "store: cannot count ids in %s/counts", folder);
    if (!ok && fd >= 0) ftruncate(fd, 0);
    if (fd >= 0) close(fd);
    return ok;
}
