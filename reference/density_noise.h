// Density from sums of Perlin's improved noise. Perlin, Improving Noise, SIGGRAPH 2002.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "reference/density.h"
#include "reference/vec3.h"

struct density_noise {
    int octaves;
    enum scene_noise_mode mode;
    double frequency; // lattice cells per metre
    double lacunarity;
    double gain;                     // of an octave relative to the one before it: lacunarity^-hurst
    double exponent;                 // (1 - bias) / (1 + bias)
    struct vec3 offset;              // lattice cells
    struct vec3 center;              // m
    struct vec3 row_x, row_y, row_z; // of the rotation
    double scale;
};

struct density_noise_params {
    int octaves;
    enum scene_noise_mode mode;
    double frequency, lacunarity, hurst, bias;
    struct vec3 offset; // lattice cells
    struct vec3 center; // in metres: the centre of the rotation
    struct vec3 axis;   // of any length but 0
    double angle_deg;
    double scale;
};

void density_noise_init(struct density_noise *noise, const struct density_noise_params *params);
// The formula is in core/scene/scene.h at struct scene_noise.
double density_noise(const struct density_noise *noise, struct vec3 position);
// One octave at `q`, in lattice cells. It is 0 where all three coordinates are integers, and has period 256 in each.
double density_noise_octave(struct vec3 q);
// The density for the integrators; borrows the noise.
struct density density_noise_field(const struct density_noise *noise);
