// SPDX-License-Identifier: Apache-2.0
#include "reference/trace.h"

#include "reference/light_walk.h"
#include "reference/rough.h"
#include "reference/surface.h"

#include <math.h>

static const double DEFAULT_RELATIVE = 1e-4;
// The error of light on a surface, relative to the accuracy.
static const double SHADOW_SHARE = 0.1;

struct tracer {
    const struct still *still;
    const struct integrate_accuracy *accuracy;
    struct rough_random random;
    struct trace_result *result;
};

struct light_ray {
    struct ray ray;
    double throughput[3];
    double length;     // m from the camera to its origin
    int depth;         // reflections and refractions so far
    size_t region;     // into which it was sent
    bool is_reflected; // at least once
};

// The intersection of a ray with a boundary.
struct hit {
    struct vec3 position, normal; // of length 1, towards the ray's origin
    struct vec3 rough;            // the random normal of this hit
    size_t region_before, region_behind;
    size_t shape; // whose boundary it is
};

static void trace(struct tracer *tracer, const struct light_ray *ray);

static double relative_of(const struct tracer *tracer)
{
    const struct integrate_accuracy *accuracy = tracer->accuracy;

    return accuracy && accuracy->relative > 0.0 ? accuracy->relative : DEFAULT_RELATIVE;
}

// The radiance to which errors are relative: what the rays before have brought, at least the floor.
static double brightness_of(const struct tracer *tracer)
{
    const struct integrate_accuracy *accuracy = tracer->accuracy;
    const double *radiance = tracer->result->radiance;

    return fmax(accuracy && accuracy->floor > 0.0 ? accuracy->floor : INTEGRATE_FLOOR,
                fmin(fmin(radiance[0], radiance[1]), radiance[2]));
}

static double greatest(const double value[static 3])
{
    return fmax(fmax(value[0], value[1]), value[2]);
}

static double clamp_cosine(double cosine)
{
    return fmin(fmax(cosine, 0.0), 1.0);
}

// Follows a ray that leaves a hit, or counts it as cut.
static void send(struct tracer *tracer, const struct light_ray *from, const struct hit *hit, struct vec3 direction,
                 const double factor[static 3], bool is_reflection)
{
    const struct still *still = tracer->still;
    struct light_ray ray = *from;
    double strongest = 0.0, sum = 0.0;

    for (int c = 0; c < 3; c++) {
        ray.throughput[c] *= factor[c];
        strongest = fmax(strongest, ray.throughput[c]);
        sum += ray.throughput[c];
    }
    if (strongest == 0.0) return;
    ray.ray = (struct ray){hit->position, vec3_normalize(direction)};
    ray.depth++;
    ray.region = is_reflection ? hit->region_before : hit->region_behind;
    ray.is_reflected = from->is_reflected || is_reflection;
    if (ray.depth > still->max_depth || strongest < still->min_throughput) {
        tracer->result->cut_count += 1.0;
        tracer->result->cut_throughput += sum / 3.0;
        if (strongest >= still->min_throughput) tracer->result->cut_by_depth += sum / 3.0;
        return;
    }
    trace(tracer, &ray);
}

static void reflect(struct tracer *tracer, const struct light_ray *ray, const struct hit *hit,
                    const double factor[static 3])
{
    struct vec3 direction = fresnel_reflect(ray->ray.direction, hit->rough);

    send(tracer, ray, hit, rough_keep_side(direction, hit->normal, 1.0), factor, true);
}

static void answer_dielectric(struct tracer *tracer, const struct light_ray *ray, const struct hit *hit)
{
    const struct objects *objects = &tracer->still->objects;
    size_t later = hit->region_before > hit->region_behind ? hit->region_before : hit->region_behind;
    double before = objects_ior(objects, hit->region_before), behind = objects_ior(objects, hit->region_behind);
    double cosine = clamp_cosine(-vec3_dot(ray->ray.direction, hit->rough));
    double share = fresnel_share(&objects->list[later - 1].material.fresnel, cosine, before, behind);
    const double reflected[3] = {share, share, share}, refracted[3] = {1.0 - share, 1.0 - share, 1.0 - share};

    if (share > 0.0) reflect(tracer, ray, hit, reflected);
    if (share < 1.0) {
        struct vec3 direction = fresnel_refract(ray->ray.direction, hit->rough, before / behind);

        send(tracer, ray, hit, rough_keep_side(direction, hit->normal, -1.0), refracted, false);
    }
}

static void add_lights(struct tracer *tracer, const struct light_ray *ray, const struct hit *hit, double rest)
{
    const struct still *still = tracer->still;
    double tolerance = SHADOW_SHARE * relative_of(tracer), albedo[3];

    surface_find_albedo(&still->objects, hit->region_behind, hit->shape, hit->position, albedo);
    for (size_t i = 0; i < still->light_count; i++) {
        struct light_arrival arrival = light_arrive(&still->lights[i], hit->position);
        struct ray shadow_ray = {hit->position, vec3_scale(arrival.travel, -1.0)};
        struct transmittance_accuracy accuracy = {.optical_depth = tolerance};
        double cosine = -vec3_dot(arrival.travel, hit->normal), unshadowed[3], share[3];

        if (!(cosine > 0.0)) continue;
        for (int c = 0; c < 3; c++)
            unshadowed[c] = ray->throughput[c] * rest * albedo[c] / M_PI * arrival.irradiance[c] * cosine;
        if (greatest(unshadowed) == 0.0) continue;
        accuracy.light = tolerance * brightness_of(tracer) / greatest(unshadowed);
        light_walk(still, &shadow_ray, arrival.distance, &accuracy, share);
        for (int c = 0; c < 3; c++)
            tracer->result->radiance[c] += unshadowed[c] * share[c];
    }
}

static void answer_diffuse(struct tracer *tracer, const struct light_ray *ray, const struct hit *hit,
                           const struct material *material)
{
    double share = material->specular;

    if (share > 0.0 && material->fresnel.kind != SCENE_FRESNEL_NONE) {
        double cosine = clamp_cosine(-vec3_dot(ray->ray.direction, hit->rough));

        share *= fresnel_share(&material->fresnel, cosine, objects_ior(&tracer->still->objects, hit->region_before),
                               material->ior);
    }
    if (share > 0.0) reflect(tracer, ray, hit, (const double[3]){share, share, share});
    if (share < 1.0) add_lights(tracer, ray, hit, 1.0 - share);
}

static void answer(struct tracer *tracer, const struct light_ray *ray, struct hit *hit)
{
    const struct objects *objects = &tracer->still->objects;
    bool is_opaque = objects_is_opaque(objects, hit->region_behind);
    size_t later = hit->region_before > hit->region_behind ? hit->region_before : hit->region_behind;
    const struct material *material = &objects->list[(is_opaque ? hit->region_behind : later) - 1].material;
    bool is_matt = material->kind == SCENE_MATERIAL_DIFFUSE && material->specular == 0.0;

    hit->rough = rough_normal(&tracer->random, hit->normal, ray->ray.direction, is_matt ? 0.0 : material->roughness);
    switch (material->kind) {
    case SCENE_MATERIAL_DIFFUSE:
        answer_diffuse(tracer, ray, hit, material);
        break;
    case SCENE_MATERIAL_MIRROR:
        reflect(tracer, ray, hit, material->reflectance);
        break;
    case SCENE_MATERIAL_DIELECTRIC:
        answer_dielectric(tracer, ray, hit);
        break;
    }
}

// Adds the light of the media along the ray's straight piece, between the clip distances, and attenuates the
// throughput.
static void gather(struct tracer *tracer, struct light_ray *ray, const struct object_piece *piece)
{
    const struct camera_pinhole *camera = &tracer->still->camera;
    struct integrate_stretch stretch = {.ray = ray->ray,
                                        .near = fmax(camera->clip_near - ray->length, 0.0),
                                        .far = fmin(camera->clip_far - ray->length, piece->end),
                                        .region = piece->region};
    struct integrate_accuracy accuracy = {.relative = relative_of(tracer),
                                          .floor = brightness_of(tracer) / greatest(ray->throughput),
                                          .halving_limit = tracer->accuracy ? tracer->accuracy->halving_limit : 0};
    struct integrate_result gathered;

    if (!(stretch.near < stretch.far)) return;
    gathered = integrate_stretch(tracer->still, &stretch, &accuracy);
    for (int c = 0; c < 3; c++) {
        tracer->result->radiance[c] += ray->throughput[c] * gathered.radiance[c];
        ray->throughput[c] *= gathered.transmittance[c];
    }
    tracer->result->is_converged = tracer->result->is_converged && gathered.is_converged;
}

static void escape(struct tracer *tracer, const struct light_ray *ray)
{
    const struct still *still = tracer->still;

    for (int c = 0; c < 3; c++) {
        if (still->has_background) tracer->result->radiance[c] += ray->throughput[c] * still->background[c];
        if (!ray->is_reflected) tracer->result->transmittance[c] += ray->throughput[c];
    }
}

// Fills the hit from its position, which is exact to rounding, its regions and its shape.
static void meet(struct tracer *tracer, const struct light_ray *ray, struct hit *hit)
{
    const struct shape *shape = &tracer->still->objects.shapes[hit->shape];
    bool is_entering = hit->region_behind > hit->region_before;

    hit->position = shape_snap(shape, hit->position);
    hit->normal = vec3_scale(shape_normal(shape, hit->position), is_entering ? 1.0 : -1.0);
    answer(tracer, ray, hit);
}

// A ray that meets two boundaries at once, in a corner, may leave the one straight into the other.
static void meet_edge(struct tracer *tracer, const struct light_ray *ray, size_t region)
{
    const struct objects *objects = &tracer->still->objects;
    const struct object *later = &objects->list[(ray->region > region ? ray->region : region) - 1];
    struct hit hit = {.position = ray->ray.origin, .region_before = ray->region, .region_behind = region};
    double nearest = INFINITY;

    for (size_t i = 0; i < later->shape_count; i++) {
        size_t shape = later->first_shape + i;
        struct vec3 boundary = shape_snap(&objects->shapes[shape], hit.position);
        double distance = vec3_length(vec3_subtract(boundary, hit.position));

        if (distance >= nearest) continue;
        nearest = distance;
        hit.shape = shape;
    }
    meet(tracer, ray, &hit);
}

static void trace(struct tracer *tracer, const struct light_ray *from)
{
    const struct objects *objects = &tracer->still->objects;
    struct light_ray ray = *from;
    struct object_walk walk;
    const struct object_piece *piece = &walk.pieces[0];
    struct hit hit;

    tracer->result->ray_count += 1.0;
    objects_walk(objects, &ray.ray, INFINITY, &walk);
    if (objects_is_opaque(objects, piece->region)) {
        if (from->region != piece->region) meet_edge(tracer, &ray, piece->region);
        return;
    }
    gather(tracer, &ray, piece);
    if (walk.count == 1) {
        escape(tracer, &ray);
        return;
    }
    ray.length += piece->end;
    hit.position = ray_at(&ray.ray, piece->end);
    hit.region_before = piece->region;
    hit.region_behind = walk.pieces[1].region;
    hit.shape = piece->shape;
    meet(tracer, &ray, &hit);
}

struct trace_result trace_ray(const struct still *still, const struct ray *ray, uint64_t seed,
                              const struct integrate_accuracy *accuracy)
{
    struct trace_result result = {.is_converged = true};
    struct tracer tracer = {.still = still, .accuracy = accuracy, .random = {seed}, .result = &result};
    struct object_walk walk;

    objects_walk(&still->objects, ray, INFINITY, &walk);
    trace(&tracer, &(struct light_ray){.ray = *ray, .throughput = {1.0, 1.0, 1.0}, .region = walk.pieces[0].region});
    return result;
}
