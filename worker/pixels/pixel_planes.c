// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_planes.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

static float *make(bool is_wanted, size_t floats)
{
    return is_wanted ? xmalloc(floats * sizeof(float)) : NULL;
}

void pixel_planes_init(struct pixel_planes *planes, struct pixel_channels channels, size_t count)
{
    *planes = (struct pixel_planes){.rgba = make(true, 4 * count),
                                    .transmittance = make(channels.has_transmittance, 4 * count),
                                    .paths = make(channels.has_paths, 4 * count),
                                    .depth = make(channels.has_depth, count),
                                    .signatures = xmalloc(count * sizeof *planes->signatures)};
}

void pixel_planes_finish(struct pixel_planes *planes)
{
    free(planes->rgba);
    free(planes->transmittance);
    free(planes->paths);
    free(planes->depth);
    free(planes->signatures);
    *planes = (struct pixel_planes){0};
}

static void copy(float *plane, size_t to, const float *other, size_t from, size_t size)
{
    if (plane) memcpy(plane + size * to, other + size * from, size * sizeof *plane);
}

void pixel_planes_copy(const struct pixel_planes *planes, size_t to, const struct pixel_planes *other, size_t from)
{
    copy(planes->rgba, to, other->rgba, from, 4);
    copy(planes->transmittance, to, other->transmittance, from, 4);
    copy(planes->paths, to, other->paths, from, 4);
    copy(planes->depth, to, other->depth, from, 1);
    if (planes->signatures) planes->signatures[to] = other->signatures[from];
}
