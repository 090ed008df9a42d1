// SPDX-License-Identifier: Apache-2.0
#include "tests/support/lattice_picture.h"

#include "core/base/alloc.h"
#include "worker/pixels/pixel_lattice.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void show(const struct lattice_case *of, const struct pixel_lattice *lattice, struct pixel_planes *planes)
{
    for (size_t i = 0; i < lattice->wanted_count; i++) {
        struct lattice_point point = of->picture(of->user, lattice->wanted[i].x, lattice->wanted[i].y);

        memcpy(planes->rgba + 4 * i, point.rgba, sizeof point.rgba);
        planes->signatures[i] = point.signature;
        if (of->is_colour_only) continue;
        memcpy(planes->transmittance + 4 * i, point.transmittance, sizeof point.transmittance);
        memcpy(planes->paths + 4 * i, point.paths, sizeof point.paths);
        planes->depth[i] = point.depth;
    }
}

static void check_wanted(const struct lattice_case *of, const struct pixel_lattice *lattice)
{
    struct pixel before = {-1, 0};

    for (size_t i = 0; i < lattice->wanted_count; i++) {
        struct pixel pixel = lattice->wanted[i];

        assert_true(pixel.y > before.y || (pixel.y == before.y && pixel.x > before.x));
        assert_int_equal(pixel.x % lattice->stride, 0);
        assert_int_equal(pixel.y % lattice->stride, 0);
        assert_true(pixel.x < of->width_px - 1 + lattice->stride && pixel.y < of->height_px - 1 + lattice->stride);
        before = pixel;
    }
}

static void give(const struct lattice_case *of, struct pixel_lattice *lattice)
{
    const struct pixel_channels channels = {!of->is_colour_only, !of->is_colour_only, !of->is_colour_only};
    struct pixel_planes planes;

    check_wanted(of, lattice);
    if (lattice->wanted_count == 0) return;
    pixel_planes_init(&planes, channels, lattice->wanted_count);
    show(of, lattice, &planes);
    pixel_lattice_give(lattice, &planes);
    pixel_planes_finish(&planes);
}

struct lattice_made lattice_make(const struct lattice_case *of)
{
    size_t count = (size_t)of->width_px * (size_t)of->height_px;
    struct lattice_made made = {0};
    struct pixel_lattice lattice;
    int levels = 0;

    assert_true(image_init(&made.image, of->width_px, of->height_px, !of->is_colour_only, !of->is_colour_only, NULL));
    pixel_lattice_init(&lattice, &(struct pixel_lattice_params){.image = &made.image,
                                                                .stride = of->stride,
                                                                .threshold = of->threshold,
                                                                .has_paths = !of->is_colour_only,
                                                                .has_edges = true,
                                                                .guards = of->guards,
                                                                .guard_count = of->guard_count});
    do {
        give(of, &lattice);
        if (levels++ == 1) made.first_wanted = lattice.wanted_count;
    } while (pixel_lattice_refine(&lattice));
    assert_int_equal(1 << (levels - 1), of->stride);
    made.traced = lattice.traced;
    made.signatures = xmalloc(count * sizeof *made.signatures);
    memcpy(made.signatures, lattice.planes.signatures, count * sizeof *made.signatures);
    if (!of->is_colour_only) {
        made.paths = xmalloc(4 * count * sizeof *made.paths);
        memcpy(made.paths, lattice.planes.paths, 4 * count * sizeof *made.paths);
    }
    pixel_lattice_finish(&lattice);
    return made;
}

void lattice_made_finish(struct lattice_made *made)
{
    image_finish(&made->image);
    free(made->paths);
    free(made->signatures);
    *made = (struct lattice_made){0};
}

void lattice_check_traced(const struct lattice_case *of, const struct lattice_made *made)
{
    size_t traced = 0;

    assert_non_null(made->image.doubts);
    for (size_t i = 0; i < (size_t)of->width_px * (size_t)of->height_px; i++) {
        struct lattice_point point = of->picture(of->user, (int)i % of->width_px, (int)i / of->width_px);

        if (made->image.doubts[i] != 0) continue;
        traced++;
        assert_memory_equal(made->image.rgba + 4 * i, point.rgba, sizeof point.rgba);
        assert_int_equal(made->signatures[i], point.signature);
        if (of->is_colour_only) continue;
        assert_memory_equal(made->image.transmittance + 4 * i, point.transmittance, sizeof point.transmittance);
        assert_memory_equal(made->paths + 4 * i, point.paths, sizeof point.paths);
        assert_memory_equal(made->image.depth + i, &point.depth, sizeof point.depth);
    }
    assert_int_equal(traced, made->traced);
}

double lattice_find_error(const struct lattice_case *of, const struct lattice_made *made)
{
    double most = 0.0;

    for (size_t i = 0; i < (size_t)of->width_px * (size_t)of->height_px; i++) {
        struct lattice_point point = of->picture(of->user, (int)i % of->width_px, (int)i / of->width_px);

        for (size_t c = 0; c < 4; c++)
            most = fmax(most, fabs((double)made->image.rgba[4 * i + c] - (double)point.rgba[c]));
    }
    return most;
}
