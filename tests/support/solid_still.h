// Stills with objects, filled by hand.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/still.h"

// No media, no lights, no background; rays go on to the 32nd reflection or refraction. The camera at z = 4 looks at the
// origin; 5 pixels a side.
void solid_still_init(struct still *still);
// Another object after those there are; its region is returned.
size_t solid_still_add(struct still *still, const struct material *material, const struct shape *shapes, size_t count);
void solid_still_set_background(struct still *still, double radiance);
// Homogeneous and everywhere in the region, after all media of the regions before it. The medium is returned.
struct medium *solid_still_fill(struct still *still, size_t region, double sigma_s, double sigma_a);

struct shape solid_sphere(double x, double y, double z, double radius);
struct shape solid_box(struct vec3 center, struct vec3 half);
struct shape solid_plane(struct vec3 position, struct vec3 normal); // the normal of any length but 0

struct material solid_glass(enum scene_fresnel fresnel, double ior); // Schlick's f0 by the iors, f90 1
struct material solid_mirror(double reflectance);
struct material solid_diffuse(double albedo);
