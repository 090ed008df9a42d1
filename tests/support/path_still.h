// Stills of media and lamps for random paths, filled by hand, and comparisons by what chance explains.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/still.h"

// Media are added to a still that solid_still_init began; each is returned. Colours are alike, phases isotropic.
struct medium *path_still_add_ball(struct still *still, struct vec3 center, double radius, double sigma_s,
                                   double sigma_a);
struct medium *path_still_add_box(struct still *still, struct vec3 half, double sigma_s, double sigma_a); // about 0
// Of thickness `thickness` about z = 0.
struct medium *path_still_add_slab(struct still *still, double thickness, double sigma_s, double sigma_a);
// A folded cloud of radius about 1; noise in a ball of radius 1 whose rim fades; a turned and sheared grid of random
// voxels with empty ones among them, about the origin.
struct medium *path_still_add_fold(struct still *still, double sigma_s, double sigma_a);
struct medium *path_still_add_noise(struct still *still, enum scene_noise_mode mode, double sigma_s, double sigma_a);
struct medium *path_still_add_grid(struct still *still, double sigma_s, double sigma_a);
void path_still_set_g(struct medium *medium, double g); // one lobe, Henyey-Greenstein
// A lamp of the same intensity in all colours.
void path_still_add_point(struct still *still, struct vec3 position, double intensity);
void path_still_add_sun(struct still *still, struct vec3 direction, double irradiance);
void path_still_set_dome(struct still *still, double radiance);

// Fails the test unless |mean - truth| <= 5 standard errors plus `rounding`, which chance explains but once in a
// million, and unless the error itself is at most `error_most` of the truth: else the test claims nothing.
#define assert_by_chance(mean, error, truth, error_most, rounding)                                                     \
    path_still_check(mean, error, truth, error_most, rounding, __FILE__, __LINE__)
void path_still_check(double mean, double error, double truth, double error_most, double rounding, const char *file,
                      int line);
