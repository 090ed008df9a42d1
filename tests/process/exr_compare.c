// exr-compare A B: prints how far two pictures are apart.
// SPDX-License-Identifier: Apache-2.0
// Two relative RMSEs are printed: of colour, alpha and transmittance, and of depth. The exit status is 1 when the
// pictures differ in size or channels, or one cannot be read.
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <unistd.h>

static bool load(const char *path, struct image *image)
{
    struct error error = {{0}};
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    bool ok = fd >= 0 && image_exr_read(fd, image, NULL, 1, &error);

    if (fd >= 0) close(fd);
    if (!ok) fprintf(stderr, "%s: %s\n", path, fd < 0 ? "cannot be opened" : error.message);
    return ok;
}

struct sums {
    double difference, square;
};

// Both may be NULL.
static void add(struct sums *sums, const float *a, const float *b, size_t count)
{
    for (size_t i = 0; a && b && i < count; i++) {
        sums->difference += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
        sums->square += 0.5 * ((double)a[i] * a[i] + (double)b[i] * b[i]);
    }
}

static double relative(const struct sums *sums)
{
    return sums->difference > 0 ? sqrt(sums->difference / sums->square) : 0.0;
}

int main(int argc, char *argv[])
{
    struct image a = {0}, b = {0};
    struct sums light = {0}, depth = {0};
    size_t count;
    int status = 1;

    if (argc != 3) {
        fputs("usage: exr-compare A B\n", stderr);
        return 2;
    }
    if (!load(argv[1], &a) || !load(argv[2], &b)) goto out;
    if (a.width_px != b.width_px || a.height_px != b.height_px || !a.depth != !b.depth ||
        !a.transmittance != !b.transmittance) {
        fprintf(stderr, "%s and %s differ in size or channels\n", argv[1], argv[2]);
        goto out;
    }
    count = (size_t)a.width_px * (size_t)a.height_px;
    add(&light, a.rgba, b.rgba, 4 * count);
    for (size_t i = 0; a.transmittance && i < count; i++)
        add(&light, &a.transmittance[4 * i], &b.transmittance[4 * i], 3);
    add(&depth, a.depth, b.depth, count);
    printf("%.3g %.3g\n", relative(&light), relative(&depth));
    status = 0;
out:
    image_finish(&a);
    image_finish(&b);
    return status;
}
