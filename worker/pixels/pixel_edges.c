// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_edges.h"

#include "worker/picture/four.h"
#include "worker/picture/image.h"
#include "worker/pixels/pixel_lattice.h"
#include "worker/pixels/voxel_guards.h"

#include <math.h>
#include <stdbool.h>

enum { MOST_DOUBT = 255 };

static const float BENT = 2.0f; // thresholds: the second difference above which a centre does not stand for its pixel

// The weights of a plane's four values, in thresholds.
struct bend {
    const float *values;
    four scale;
};

// The largest weighted second difference of four values between two neighbours.
static float find_bend(const struct bend *bend, size_t before, size_t at, size_t after)
{
    four second = (four_load(bend->values + 4 * before) - 2.0f * four_load(bend->values + 4 * at) +
                   four_load(bend->values + 4 * after)) *
                  bend->scale;

    return four_largest(four_most(second, -second));
}

// A pixel of the picture and its four neighbours; at the picture's edge, itself.
struct cross {
    size_t at, left, right, above, below;
};

static struct cross find_cross(const struct image *image, int x, int y)
{
    size_t width = (size_t)image->width_px, at = (size_t)y * width + (size_t)x;

    return (struct cross){.at = at,
                          .left = x > 0 ? at - 1 : at,
                          .right = x + 1 < image->width_px ? at + 1 : at,
                          .above = y > 0 ? at - width : at,
                          .below = y + 1 < image->height_px ? at + width : at};
}

static bool is_alike(const uint32_t *signatures, const struct cross *cross)
{
    uint32_t own = signatures[cross->at];

    return signatures[cross->left] == own && signatures[cross->right] == own && signatures[cross->above] == own &&
           signatures[cross->below] == own;
}

static float find_bends(const struct bend *bend, const struct cross *cross)
{
    return fmaxf(find_bend(bend, cross->left, cross->at, cross->right),
                 find_bend(bend, cross->above, cross->at, cross->below));
}

static bool is_forced(const struct pixel_lattice *lattice, size_t at)
{
    if (!lattice->forced || lattice->forced[at] == 0) return false;
    return lattice->forced[at] != VOXEL_GUARD_IN_THE_CLEAR || (lattice->planes.signatures[at] & 1) == 0;
}

static float find_doubt(const struct pixel_lattice *lattice, const struct bend *colour,
                        const struct bend *transmittance, const struct cross *cross)
{
    float doubt = find_bends(colour, cross);

    if (!is_alike(lattice->planes.signatures, cross) || is_forced(lattice, cross->at)) return INFINITY;
    return transmittance->values ? fmaxf(doubt, find_bends(transmittance, cross)) : doubt;
}

size_t pixel_edges_find(struct pixel_lattice *lattice)
{
    const struct image *image = lattice->params.image;
    float whole = (float)(1.0 / (BENT * lattice->params.threshold)), own = whole / (float)lattice->rms;
    const struct bend colour = {lattice->planes.rgba, {own, own, own, whole}};
    const struct bend transmittance = {lattice->planes.transmittance, {whole, whole, whole, 0.0f}};
    size_t count = 0, centres = lattice->traced;

    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++) {
            struct cross cross = find_cross(image, x, y);
            float doubt = find_doubt(lattice, &colour, &transmittance, &cross);
            uint8_t *kept = &lattice->doubts[cross.at];

            if (!(doubt <= 1.0f)) {
                pixel_lattice_want(lattice, (struct pixel){x, y}, cross.at);
                *kept = 0;
                count++;
                continue;
            }
            if (*kept == 0) *kept = (uint8_t)(1.0f + doubt * (MOST_DOUBT - 1));
        }
    lattice->traced = centres;
    return count;
}
