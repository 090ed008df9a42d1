// exr-truth FILE [JOB]: prints what a frame's header says of its error, and what the error is.
// SPDX-License-Identifier: Apache-2.0
// Prints the plan's number, the error, its bound, the tolerance and, where the job is given, the error in all pixels by
// reference/. The job states size, samples and input files of the frame, whose surfaces are smooth. The exit status is
// 1 where a file cannot be read.
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/example_job.h"
#include "tests/support/true_error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

static double measure(const char *path, const struct image *image, int32_t frame)
{
    struct job job;
    double error;

    example_job_load_file(&job, path);
    error = true_error_measure(&job, frame, image);
    job_finish(&job);
    return error;
}

int main(int argc, char *argv[])
{
    struct image_exr_facts facts;
    struct image image = {0};
    struct error error = {{0}};
    int fd;

    if (argc < 2 || argc > 3) {
        fputs("usage: exr-truth FILE [JOB]\n", stderr);
        return 2;
    }
    fd = open(argv[1], O_RDONLY | O_CLOEXEC);
    if (fd < 0 || !image_exr_read(fd, &image, &facts, 1, &error)) {
        fprintf(stderr, "%s: %s\n", argv[1], fd < 0 ? "cannot be opened" : error.message);
        return 1;
    }
    close(fd);
    printf("%d %g %g %g", (int)facts.plan_number, facts.audit.error, facts.audit.error95, facts.audit.tolerance);
    if (argc == 3) printf(" %g", measure(argv[2], &image, facts.frame));
    putchar('\n');
    image_finish(&image);
    return 0;
}
