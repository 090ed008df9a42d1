// Small pictures of scenes with objects, compared pixel by pixel with closed forms.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <stdbool.h>
#include <stdint.h>

struct job;

struct studio_camera {
    struct vec3 position, target, up; // up of length 0: y
    double fov;                       // degrees
    double near, far;                 // the camera's clip, m; a far of 0: none
};

// Texts are JSON; NULL where there is none.
struct studio_scene {
    int width_px, height_px;
    struct studio_camera camera;
    const char *moving_camera;            // members of the camera that stand in place of position and target
    const char *lights, *media, *objects; // elements of the lists
    const char *quality;                  // members; NULL: "equiangular" with 16 points
    const char *background;               // a value; NULL: none
    const char *frames;                   // NULL: 0. There are 24 in a second.
};

// The values of a pixel. NAN: unknown.
struct studio_light {
    double radiance[3], transmittance[3], alpha, depth;
};

struct studio_picture {
    struct image image;
    struct renderer_result result;
};

// A failure of any of these fails the test.
void studio_parse(struct job *job, const struct studio_scene *scene); // free with job_finish
// Renders on a context and a renderer that are kept from call to call; values that are not finite fail the test.
void studio_render(const struct job *job, int32_t frame, struct studio_picture *picture);
void studio_shoot(const struct studio_scene *scene, struct studio_picture *picture); // both, of frame 0
void studio_finish(struct studio_picture *picture);
// The same for all that is rendered from then on; a backend that is not there skips the test. At first it is software.
void studio_use(enum gl_backend backend);
int studio_close(void **state); // a group's teardown

// Through the centre of a pixel.
struct ray studio_ray(const struct studio_scene *scene, int x_px, int y_px);

// Computes the light along a ray; `light` is all NAN before.
typedef void studio_truth(const struct ray *ray, struct studio_light *light, const void *user);
// Every known value must equal that of the picture to within `tolerance`, absolute up to 1 and relative above. The test
// also fails if less than `share` of all pixels have a known value.
void studio_expect(const struct studio_scene *scene, const struct studio_picture *picture, studio_truth *truth,
                   const void *user, double tolerance, double share);
// Renders a scene and compares it.
void studio_check(const struct studio_scene *scene, studio_truth *truth, const void *user, double tolerance,
                  double share);

void studio_set_color(double color[3], double value); // all three
