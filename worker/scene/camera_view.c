// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/camera_view.h"

#include "core/base/error.h"
#include "core/scene/scene.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

// Returns false for a vector without a direction.
static bool normalize(double vector[3])
{
    double largest = fmax(fabs(vector[0]), fmax(fabs(vector[1]), fabs(vector[2])));
    double length;

    if (!(largest > 0) || !isfinite(largest)) return false;
    for (int i = 0; i < 3; ++i)
        vector[i] /= largest;
    length = sqrt(dot(vector, vector));
    for (int i = 0; i < 3; ++i)
        vector[i] /= length;
    return true;
}

static void find_right(double right[3], const double forward[3], double up[3])
{
    double axis[3] = {0};
    int smallest = 0;

    cross(right, forward, up);
    if (normalize(up)) {
        cross(right, forward, up);
        if (dot(right, right) > 1e-20 && normalize(right)) return;
    }
    for (int i = 1; i < 3; ++i)
        if (fabs(forward[i]) < fabs(forward[smallest])) smallest = i;
    axis[smallest] = 1;
    cross(right, forward, axis);
    normalize(right);
}

bool camera_view_init(struct camera_view *view, const struct scene_camera *camera, double time, int width_px,
                      int height_px, struct error *error)
{
    double target[3], up[3], fov_deg[3] = {0};

    timeline_evaluate(&camera->position, time, view->position);
    timeline_evaluate(&camera->target, time, target);
    timeline_evaluate(&camera->up, time, up);
    timeline_evaluate(&camera->fov, time, fov_deg);
    if (!(fov_deg[0] > 0 && fov_deg[0] < 180)) {
        error_set(error, "camera.fov: expected more than 0 and less than 180 degrees, got %g at t = %g s", fov_deg[0],
                  time);
        return false;
    }
    for (int i = 0; i < 3; ++i)
        view->forward[i] = target[i] - view->position[i];
    if (!normalize(view->forward)) {
        error_set(error, "camera.target: expected a place away from camera.position, they are the same at t = %g s",
                  time);
        return false;
    }
    find_right(view->right, view->forward, up);
    cross(view->up, view->right, view->forward);
    view->half_height = tan(0.5 * fov_deg[0] * pi / 180);
    view->half_width = view->half_height * width_px / height_px;
    for (int i = 0; camera->mirror && i < 3; ++i)
        view->right[i] = -view->right[i];
    return true;
}

void camera_view_matrices(const struct camera_view *view, double world_to_camera[static 16],
                          double world_to_ndc[static 16])
{
    const double *axes[3] = {view->right, view->up, view->forward};
    double projection[16] = {
        0.5 / view->half_width, 0, 0, 0, 0, -0.5 / view->half_height, 0, 0, 0.5, 0.5, 1, 1, 0, 0, -1, 0};

    memset(world_to_camera, 0, 16 * sizeof *world_to_camera);
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row)
            world_to_camera[4 * row + column] = axes[column][row];
        world_to_camera[12 + column] = -dot(axes[column], view->position);
    }
    world_to_camera[15] = 1;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
            world_to_ndc[4 * row + column] = 0;
            for (int k = 0; k < 4; ++k)
                world_to_ndc[4 * row + column] += world_to_camera[4 * row + k] * projection[4 * k + column];
        }
}
