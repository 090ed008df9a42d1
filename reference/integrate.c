// SPDX-License-Identifier: Apache-2.0
#include "reference/integrate.h"

#include "core/scene/light_rules.h"
#include "reference/in_scattering.h"
#include "reference/profile.h"
#include "reference/shadow_edges.h"
#include "reference/spot_edges.h"
#include "reference/transmittance.h"

#include <math.h>

static const double DEFAULT_RELATIVE = 1e-4;
enum { DEFAULT_HALVING_LIMIT = 30 };

// Parts of the allowed error: of densities along the ray, and of stretches that are not looked at.
static const double PROFILE_PART = 0.2, ROUGH_PART = 0.05;

// Cuts spans around the foot of a light near the ray. There its irradiance has a peak that is as narrow as the light is
// near, too narrow for the nodes of a long cell, which would agree on the tails. The cuts' distances from the foot grow
// by a constant factor, from the light's own distance on.
static void cut_at_light(struct span_list *spans, const struct ray *ray, struct vec3 light)
{
    const double growth = 8.0;
    struct vec3 to_light = vec3_subtract(light, ray->origin);
    double foot = vec3_dot(to_light, ray->direction);
    double height = vec3_length(vec3_subtract(light, ray_at(ray, foot)));
    double farthest, side;

    if (spans->count == 0) return;
    farthest = fmax(fabs(foot - spans->spans[0].begin), fabs(spans->spans[spans->count - 1].end - foot));
    span_list_split(spans, foot);
    side = fmax(height, 1e-12 * farthest);
    while (side < farthest) {
        span_list_split(spans, foot - side);
        span_list_split(spans, foot + side);
        side *= growth;
    }
}

// The column of a medium that may be missed.
static double find_tolerance(const struct medium *medium, double relative, double floor)
{
    double most = 0.0;

    // Its light is not known beforehand.
    if (medium->glow.at) return 0.0;
    for (int c = 0; c < 3; c++) {
        most = fmax(most, medium->sigma_s[c] + medium->sigma_a[c]);
        most = fmax(most, medium->emission[c] / floor);
    }
    return ROUGH_PART * relative / most;
}

static bool is_scattering(const struct still_media *media)
{
    for (size_t m = 0; m < media->count; m++) {
        const double *sigma_s = media->list[m].sigma_s;

        if (sigma_s[0] > 0.0 || sigma_s[1] > 0.0 || sigma_s[2] > 0.0) return true;
    }
    return false;
}

// Finds spans whose ends lie where a medium's density, its glow, a light's distance, a spot's cones or an object's
// shadow are not smooth.
static void find_spans(const struct still *still, const struct integrate_stretch *stretch, double far,
                       const struct integrate_accuracy *accuracy, struct span_list *spans)
{
    struct still_media media = still_media(still, stretch->region);
    const struct ray *ray = &stretch->ray;

    for (size_t m = 0; m < media.count; m++) {
        const struct medium *medium = &media.list[m];
        struct span_list own = {0};

        density_rough_spans(&medium->density, ray, stretch->near, far,
                            find_tolerance(medium, accuracy->relative, accuracy->floor), &own);
        if (medium->glow.split) medium->glow.split(medium->glow.field, ray, &own);
        span_list_merge(spans, &own);
        span_list_finish(&own);
    }
    for (size_t i = 0; i < still->light_count; i++) {
        if (light_rules_of(still->lights[i].kind)->has_position) cut_at_light(spans, ray, still->lights[i].position);
        spot_edges_split(&still->lights[i], ray, spans);
        shadow_edges_split(&still->objects, &still->lights[i], ray, spans);
    }
}

static struct integrate_accuracy with_defaults(const struct integrate_accuracy *accuracy)
{
    struct integrate_accuracy complete = accuracy ? *accuracy : (struct integrate_accuracy){0};

    if (!(complete.relative > 0.0)) complete.relative = DEFAULT_RELATIVE;
    if (!(complete.floor > 0.0)) complete.floor = INTEGRATE_FLOOR;
    if (complete.halving_limit <= 0) complete.halving_limit = DEFAULT_HALVING_LIMIT;
    return complete;
}

struct integrate_result integrate_stretch(const struct still *still, const struct integrate_stretch *stretch,
                                          const struct integrate_accuracy *asked)
{
    struct integrate_accuracy accuracy = with_defaults(asked);
    struct still_media media = still_media(still, stretch->region);
    struct integrate_result result = {.transmittance = {1.0, 1.0, 1.0}, .is_converged = true};
    double far = transmittance_reach(media.list, media.count, &stretch->ray, stretch->near, stretch->far);
    struct span_list spans = {0};
    struct profile profile;

    find_spans(still, stretch, far, &accuracy, &spans);
    if (spans.count == 0) return result;
    profile_init(&profile, &stretch->ray, media, &spans,
                 &(struct profile_accuracy){PROFILE_PART * accuracy.relative, accuracy.floor, accuracy.halving_limit});
    result.is_converged = !profile.hit_limit;
    for (int c = 0; c < 3; c++) {
        result.radiance[c] = profile.emitted[c];
        result.transmittance[c] = exp(-profile.optical_depth[c]);
    }
    if (still->light_count > 0 && is_scattering(&media)) {
        const struct in_scattering_params params = {.still = still,
                                                    .profile = &profile,
                                                    .spans = &spans,
                                                    .relative = accuracy.relative,
                                                    .floor = accuracy.floor,
                                                    .halving_limit = accuracy.halving_limit};

        result.is_converged = in_scattering_add(&params, result.radiance) && result.is_converged;
    }
    profile_finish(&profile);
    span_list_finish(&spans);
    return result;
}

struct integrate_result integrate_ray(const struct still *still, const struct ray *ray, double near, double far,
                                      const struct integrate_accuracy *accuracy)
{
    return integrate_stretch(still, &(struct integrate_stretch){.ray = *ray, .near = near, .far = far}, accuracy);
}
