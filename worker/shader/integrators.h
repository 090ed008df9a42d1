// The shader modules that integrate along camera rays and towards lights, and their calls: a row a method.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scene_model;

struct integrator_part {
    const char *module; // below shaders/
    const char *call;   // the function and its struct, up to the bracket that closes the struct
    void (*write_parameters)(FILE *out,
                             const struct scene_model *model); // the parameters that `call` lacks; NULL: none
};

// A new method is a row in integrators.c and its modules. shaders/README.md says what modules may call.
struct integrator {
    // Where features.marches is false, modules that march have no march_resume and must not apply.
    bool (*applies)(const struct scene_model *model);
    struct integrator_part along_rays; // of the camera, and of reflected and refracted rays
    struct integrator_part to_lights;  // for media that vary; of tracking without parameters
};

// Returns the first row that applies. The model has media.
const struct integrator *integrator_of(const struct scene_model *model);
// Returns the module for the transmittance of media towards a light. Some medium has an extinction.
const struct integrator_part *integrator_to_lights(const struct scene_model *model);
// Writes the call as in "integrator_midpoint(IntegratorMidpoint(quality_step)", without the other arguments.
void integrator_write_call(FILE *out, const struct integrator_part *part, const struct scene_model *model);
