// Which shader modules integrate along camera rays and towards lights, and how they are called: a row a method.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scene_model;

struct integrator_part {
    const char *module; // below shaders/
    const char *call;   // its function, and its struct of parameters up to where their closing bracket goes
    void (*write_parameters)(FILE *out, const struct scene_model *model); // that `call` lacks; NULL: none
};

// A new method is a row in integrators.c and its modules; shaders/README.md says what these find.
struct integrator {
    bool (*applies)(const struct scene_model *model);
    struct integrator_part along_rays; // of the camera, and from surface to surface
    struct integrator_part to_lights;  // where media are marched through; of tracking without parameters
};

// The first row that applies. The model has media.
const struct integrator *integrator_of(const struct scene_model *model);
// The module that gives what media leave of light towards a light, and how it is called; media extinguish.
const struct integrator_part *integrator_to_lights(const struct scene_model *model);
// "integrator_midpoint(IntegratorMidpoint(quality_step)": what is integrated over follows.
void integrator_write_call(FILE *out, const struct integrator_part *part, const struct scene_model *model);
