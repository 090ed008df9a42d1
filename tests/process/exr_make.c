// exr-make FILE [KEY=VALUE...]: writes a frame of 16 x 9 pixels with a header of ours.
// SPDX-License-Identifier: Apache-2.0
// Keys: frame, width, hash (of the job; "" is foreign), picture (its hash), error, error95 (1.5 error), tolerance (0:
// no audit), scope, beyond (what the modelled orders leave out; absent: not said), value (of channel G of pixel
// (3, 2)).
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *find_value(char *arguments[], const char *key, const char *otherwise)
{
    size_t length = strlen(key);

    for (; *arguments; arguments++)
        if (!strncmp(*arguments, key, length) && (*arguments)[length] == '=') return *arguments + length + 1;
    return otherwise;
}

static double find_number(char *arguments[], const char *key, double otherwise)
{
    const char *text = find_value(arguments, key, NULL);

    return text ? strtod(text, NULL) : otherwise;
}

static struct audit_result find_audit(char *arguments[])
{
    struct audit_result audit = {.tolerance = find_number(arguments, "tolerance", 0.01), .ray_count = 64};

    if (audit.tolerance <= 0.0) return audit;
    audit.kind = AUDIT_REFERENCE;
    audit.error = find_number(arguments, "error", 0.005);
    audit.error95 = find_number(arguments, "error95", 1.5 * audit.error);
    audit.is_missed = find_number(arguments, "missed", 0) != 0;
    audit.is_pooled = !strcmp(find_value(arguments, "scope", "frame"), "segment");
    return audit;
}

int main(int argc, char *argv[])
{
    struct image_exr_header header = {.compression = JOB_COMPRESSION_ZIPS, .fps_numerator = 24, .fps_denominator = 1};
    struct error error = {0};
    struct image image;
    int fd;
    bool ok;

    if (argc < 2) return 2;
    header.frame = (int32_t)find_number(argv + 2, "frame", 0);
    header.sequence_hash = find_value(argv + 2, "hash", "00000000000000000000000000000001");
    header.job_hash = find_value(argv + 2, "picture", header.sequence_hash);
    header.method = *header.job_hash ? "cached" : NULL;
    header.audit = find_audit(argv + 2);
    header.beyond.error = find_number(argv + 2, "beyond", -1.0);
    header.beyond.is_known = header.beyond.error >= 0.0;
    header.beyond.error95 = fmin(1.25 * header.beyond.error, 1.0);
    if (!image_init(&image, (int)find_number(argv + 2, "width", 16), 9, false, false, NULL)) return 1;
    for (int i = 0; i < image.width_px * image.height_px * 4; i++)
        image.rgba[i] = (float)(i % 7) * 0.125f;
    image.rgba[(2 * image.width_px + 3) * 4 + 1] = (float)find_number(argv + 2, "value", 0.5);
    fd = open(argv[1], O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    ok = fd >= 0 && image_exr_write(fd, &image, &header, 1, &error);
    if (fd >= 0) close(fd);
    image_finish(&image);
    if (!ok) fprintf(stderr, "%s: %s\n", argv[1], fd < 0 ? "cannot be made" : error.message);
    return ok ? 0 : 1;
}
