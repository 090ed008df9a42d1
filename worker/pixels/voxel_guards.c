// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/voxel_guards.h"

#include "core/base/alloc.h"
#include "core/job/job.h"
#include "worker/pixels/scene_guards.h"
#include "worker/scene/camera_view.h"
#include "worker/scene/scene_inputs.h"
#include "worker/sparse/brick_atlas.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/sparse/transfer_function.h"
#include "worker/volume/grid_bricks.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double NEAR = 1e-6;      // m ahead of the camera: what is nearer has no place in the picture
static const double CELL_SHARE = 0.7; // of the edge, where a voxel is no larger than its cell
static const double RIM = 0.5;        // voxels: bricks are larger by so much, as the outer voxels of a grid are

// Pixels right, pixels down and 1, each times the distance ahead: a plane of an image as numbers of a voxel's place.
struct projection {
    double rows[3][4];
};

// The bricks of a medium.
struct bricks {
    const struct scene_input *input;
    const struct grid_bricks *dense; // NULL: the input's are sparse
    const int *count;
    int first[3]; // the first voxel
};

// What one brick of a projection covers.
struct cover {
    double low[2], high[2]; // px
    double far;             // m
};

static bool has_density(const struct bricks *bricks, size_t index)
{
    const struct scene_input *input = bricks->input;
    double a, b;

    if (!bricks->dense) return input->bricks->atlas->index[index][3] == 0;
    a = input->header.slope * (double)bricks->dense->bounds[index].min + input->header.intercept;
    b = input->header.slope * (double)bricks->dense->bounds[index].max + input->header.intercept;
    return !transfer_function_is_empty(input->source->points, input->source->point_count, fmin(a, b), fmax(a, b));
}

static void find_projection(struct projection *projection, const struct job *job, const struct camera_view *view,
                            const double to_world[12])
{
    const double *axes[3] = {view->right, view->up, view->forward};
    double scale[2] = {0.5 * job->width_px / view->half_width, -0.5 * job->height_px / view->half_height};
    double middle[2] = {0.5 * job->width_px - 0.5, 0.5 * job->height_px - 0.5};

    for (int column = 0; column < 4; column++) {
        double seen[3] = {0};

        for (int axis = 0; axis < 3; axis++)
            for (int i = 0; i < 3; i++)
                seen[axis] += axes[axis][i] * (to_world[4 * i + column] - (column == 3 ? view->position[i] : 0.0));
        for (int i = 0; i < 2; i++)
            projection->rows[i][column] = scale[i] * seen[i] + middle[i] * seen[2];
        projection->rows[2][column] = seen[2];
    }
}

// Returns false for a brick behind the camera. One that reaches behind it may be anywhere in the picture.
static bool find_cover(const struct projection *projection, const int voxel[3], struct cover *cover)
{
    double corner[3], near = INFINITY;

    *cover = (struct cover){{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, 0.0};
    for (int n = 0; n < 8; n++) {
        for (int i = 0; i < 3; i++) {
            const double *row = projection->rows[i];

            corner[i] = row[3];
            for (int axis = 0; axis < 3; axis++)
                corner[i] += row[axis] * (voxel[axis] + ((n >> axis & 1) == 1 ? GRID_BRICK_CELLS + RIM : -RIM));
        }
        near = fmin(near, corner[2]);
        cover->far = fmax(cover->far, corner[2]);
        for (int i = 0; i < 2; i++) {
            cover->low[i] = fmin(cover->low[i], corner[i] / corner[2]);
            cover->high[i] = fmax(cover->high[i], corner[i] / corner[2]);
        }
    }
    if (near >= NEAR) return true;
    for (int i = 0; i < 2; i++) {
        cover->low[i] = -INFINITY;
        cover->high[i] = INFINITY;
    }
    return cover->far >= NEAR;
}

static int find_cell(double px, int size_px, int count)
{
    double cell = floor(px / size_px);

    return cell < 0.0 ? 0 : cell >= count ? count - 1 : (int)cell;
}

static void mark_cover(struct voxel_guards *guards, const struct cover *cover, int stride)
{
    int size = guards->size_px, left, right, top, bottom;

    if (!(cover->low[0] < guards->columns * size && cover->low[1] < guards->rows * size)) return;
    if (!(cover->high[0] >= 0.0 && cover->high[1] >= 0.0)) return;
    left = find_cell(cover->low[0], size, guards->columns);
    right = find_cell(cover->high[0], size, guards->columns);
    top = find_cell(cover->low[1], size, guards->rows);
    bottom = find_cell(cover->high[1], size, guards->rows);
    for (int row = top; row <= bottom; row++) {
        uint8_t *strides = guards->strides + (size_t)row * (size_t)guards->columns;

        for (int column = left; column <= right; column++)
            if (strides[column] == 0 || strides[column] > stride) strides[column] = (uint8_t)stride;
    }
}

static double find_edge(const struct scene_input *input, const double to_world[12])
{
    double edge = INFINITY;
    for (int axis = 0; axis < 3; axis++)
        edge = fmin(edge, hypot(hypot(to_world[axis], to_world[4 + axis]), to_world[8 + axis]));
    return input->source->is_nearest ? CELL_SHARE * edge : edge;
}

static void mark_bricks(struct voxel_guards *guards, const struct bricks *bricks, const struct projection *projection,
                        double edge_px)
{
    size_t index = 0;
    int voxel[3];

    for (int k = 0; k < bricks->count[2]; k++)
        for (int j = 0; j < bricks->count[1]; j++)
            for (int i = 0; i < bricks->count[0]; i++) {
                struct cover cover;
                int stride = guards->size_px / 2;

                if (!has_density(bricks, index++)) continue;
                voxel[0] = bricks->first[0] + GRID_BRICK_CELLS * i;
                voxel[1] = bricks->first[1] + GRID_BRICK_CELLS * j;
                voxel[2] = bricks->first[2] + GRID_BRICK_CELLS * k;
                if (!find_cover(projection, voxel, &cover) || edge_px >= guards->size_px * cover.far) continue;
                while (stride > 1 && stride * cover.far > edge_px)
                    stride /= 2;
                mark_cover(guards, &cover, stride);
            }
}

static void mark_medium(struct voxel_guards *guards, const struct voxel_guards_params *params, size_t medium,
                        const struct camera_view *view, double time)
{
    const struct scene_input *input = &params->inputs->media[medium];
    struct bricks bricks = {.input = input, .dense = params->bricks[medium]};
    struct projection projection;
    double to_world[12];

    if (!input->source || params->inputs->is_unneeded[medium] || (!input->bricks && !bricks.dense)) return;
    bricks.count = input->bricks ? input->bricks->atlas->brick_count : bricks.dense->count;
    for (int axis = 0; input->bricks && axis < 3; axis++)
        bricks.first[axis] = SPARSE_BRICK_SIDE * input->bricks->atlas->brick_min[axis];
    scene_input_find_matrix(input, time, to_world);
    find_projection(&projection, params->job, view, to_world);
    mark_bricks(guards, &bricks, &projection,
                find_edge(input, to_world) * 0.5 * params->job->height_px / view->half_height);
}

void voxel_guards_init(struct voxel_guards *guards, const struct voxel_guards_params *params)
{
    const struct job *job = params->job;
    double times[SCENE_GUARD_MOMENTS];
    int count = scene_guards_find_moments(job, params->frame, times), size_px = job->quality.pixels.stride;
    bool has_grid = false;

    *guards = (struct voxel_guards){.size_px = size_px};
    for (size_t i = 0; params->inputs && i < job->scene.medium_count; i++)
        has_grid |= params->inputs->media[i].source != NULL;
    if (!has_grid) return;
    guards->columns = job->width_px / size_px + 2; // with what the lattice has beyond the picture
    guards->rows = job->height_px / size_px + 2;
    guards->strides = xcalloc((size_t)guards->columns * (size_t)guards->rows, 1);
    for (int n = 0; n < count; n++) {
        struct camera_view view;

        if (!camera_view_init(&view, &job->scene.camera, times[n], job->width_px, job->height_px, NULL)) continue;
        for (size_t i = 0; i < job->scene.medium_count; i++)
            mark_medium(guards, params, i, &view, times[n]);
    }
}

void voxel_guards_finish(struct voxel_guards *guards)
{
    free(guards->strides);
    *guards = (struct voxel_guards){0};
}

static void mark_points(uint8_t *points, int count, uint8_t mark)
{
    for (int i = 0; i < count; i++)
        if (points[i] == 0) points[i] = mark;
}

void voxel_guards_mark(const struct voxel_guards *guards, int stride, int columns, int rows, uint8_t *forced)
{
    int size = guards->size_px / stride; // of a cell, in points

    for (int row = 0; row < rows; row++) {
        const uint8_t *strides = guards->strides + (size_t)(row / size) * (size_t)guards->columns;
        uint8_t *points = forced + (size_t)row * (size_t)columns;

        for (int column = 0, first = 0; first < columns; column++, first += size)
            if (strides[column] > 0 && strides[column] <= stride)
                mark_points(points + first, columns - first < size ? columns - first : size,
                            stride < VOXEL_GUARD_EVER ? VOXEL_GUARD_IN_THE_CLEAR : 1);
    }
}
