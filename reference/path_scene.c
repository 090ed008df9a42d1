// SPDX-License-Identifier: Apache-2.0
#include "reference/path_scene.h"

#include "core/base/error.h"

#include <math.h>

// Collisions across a medium that glows and hardly attenuates: its source is looked at there.
static const double GLOW_LOOKS = 4.0;
// The most that a medium's bound may attenuate within a lamp's reach; a spot's beam is not found by itself even there.
static const double REACH_DEPTH = 4.0, SPOT_DEPTH = 8.0;
static const double WIDEST_REACH = 0x1p40; // m

// The least relative variance of what a phase shows of a lamp, over all directions, that is worth second paths: by
// noise at equal time. A single lobe has it from a g of 0.82 on, or of -0.82.
static const double NARROW = 15.0;
// From this g on, forward or backward, connections near lamps follow the lobes, too: by noise at equal time.
static const double WIDE_G = 0.3;
// Scattered so often that a lobe's g becomes this one, light may as well be found by chance.
static const double SPREAD_G = 0.5;

// Of an uneven medium's mean bound, as lamps in it see it.
static const double UNEVEN = 0.5;

static double g_of(const struct medium_lobe *lobe)
{
    return lobe->kind == SCENE_LOBE_HENYEY_GREENSTEIN ? lobe->g : 0.0;
}

// 4 pi times the integral of the phase's square. Two lobes' product, turned over all directions, is the lobe whose g is
// their product.
static double phase_variance(const struct medium *medium)
{
    double sum = 0.0;

    for (size_t i = 0; i < medium->lobe_count; i++)
        for (size_t k = 0; k < medium->lobe_count; k++) {
            double g = g_of(&medium->lobes[i]) * g_of(&medium->lobes[k]);

            sum += medium->lobes[i].weight * medium->lobes[k].weight * (1.0 + g) / ((1.0 - g) * (1.0 - g));
        }
    return sum;
}

// Negative where the narrowest lobe scatters backward.
static double narrowest_g(const struct medium *medium)
{
    double narrowest = 0.0;

    for (size_t i = 0; i < medium->lobe_count; i++) {
        double g = g_of(&medium->lobes[i]);

        if (fabs(g) > fabs(narrowest)) narrowest = g;
    }
    return narrowest;
}

static int count_aim_vertices(const struct medium *medium)
{
    double most = fabs(narrowest_g(medium));

    if (most <= SPREAD_G || phase_variance(medium) < NARROW) return 0;
    return (int)fmin(round(log(SPREAD_G) / log(most)), PATH_AIM_VERTICES);
}

static double mean_turn(const struct medium *medium)
{
    double mean = 0.0;

    for (size_t i = 0; i < medium->lobe_count; i++)
        mean += medium->lobes[i].weight * g_of(&medium->lobes[i]);
    return 1.0 - mean;
}

static double sigma_most(const struct medium *medium)
{
    double most = 0.0;

    for (int c = 0; c < 3; c++)
        most = fmax(most, medium->sigma_s[c] + medium->sigma_a[c]);
    return most;
}

static bool glows(const struct medium *medium)
{
    return medium->glow.at || medium->emission[0] > 0.0 || medium->emission[1] > 0.0 || medium->emission[2] > 0.0;
}

// True when light may be scattered there for ever.
static bool is_lossless_without_end(const struct medium *medium)
{
    const struct density *density = &medium->density;
    struct box box;

    if ((density->extent && density->extent(density->field, &box)) || density->clip) return false;
    if (density->at(density->field, (struct vec3){0.0, 0.0, 0.0}) == 0.0 && density->column) return false;
    for (int c = 0; c < 3; c++)
        if (medium->sigma_s[c] > 0.0 && medium->sigma_a[c] == 0.0) return true;
    return false;
}

static bool check_media(const struct still *still, struct error *error)
{
    for (size_t i = 0; i < still->medium_count; i++) {
        const struct medium *medium = &still->media[i];

        if (medium->region > 0) return error_set(error, "paths do not enter dielectrics"), false;
        if (!medium->density.most) return error_set(error, "a density has no known bound"), false;
        if (is_lossless_without_end(medium))
            return error_set(error, "a medium without end absorbs nothing: its paths do not end"), false;
    }
    return true;
}

bool path_scene_is_possible(const struct still *still, struct error *error)
{
    for (size_t i = 0; i < still->objects.count; i++) {
        const struct material *material = &still->objects.list[i].material;

        if (material->kind != SCENE_MATERIAL_DIFFUSE || material->specular > 0.0)
            return error_set(error, "paths follow diffuse surfaces only"), false;
    }
    return check_media(still, error);
}

// Bound of the extinction within `radius` of a position.
static double extinction_near(const struct path_scene *scene, struct vec3 position, double radius)
{
    const struct box box = {position, {radius, radius, radius}};
    double sum = 0.0;

    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct density *density = &scene->media[i].medium->density;

        sum += sigma_most(scene->media[i].medium) * density->most(density->field, &box);
    }
    return sum;
}

// The reach is about a mean free path beside the lamp, whose medium is thinner than its bound: farther away, paths find
// the lamp's light by themselves. It grows from what holds everywhere, since bounds of large boxes take long.
static void find_reach(const struct path_scene *scene, struct path_peak *peak)
{
    double most = 0.0, depth = peak->spot ? SPOT_DEPTH : REACH_DEPTH, reach;

    for (size_t i = 0; i < scene->medium_count; i++)
        most += sigma_most(scene->media[i].medium) * scene->media[i].majorant.most;
    if (!(most > 0.0)) return;
    reach = depth / most;
    while (reach < WIDEST_REACH && 2.0 * reach * extinction_near(scene, peak->position, 2.0 * reach) <= depth)
        reach *= 2.0;
    if (extinction_near(scene, peak->position, reach) > 0.0) peak->reach = reach;
}

static void find_peaks(struct path_scene *scene)
{
    const struct still *still = scene->still;

    for (size_t i = 0; i < still->light_count; i++) {
        const struct light *light = &still->lights[i];

        scene->peaks[i].position = light->position;
        if (light->kind == SCENE_LIGHT_SPOT) scene->peaks[i].spot = light;
        if (light->kind != SCENE_LIGHT_SUN && light->falloff == SCENE_FALLOFF_INVERSE_SQUARE)
            find_reach(scene, &scene->peaks[i]);
    }
    for (size_t i = 0; i < still->sphere_count; i++) {
        scene->sphere_peaks[i].position = still->spheres[i].center;
        find_reach(scene, &scene->sphere_peaks[i]);
        if (scene->sphere_peaks[i].reach < still->spheres[i].radius) scene->sphere_peaks[i].reach = 0.0;
    }
}

// Mean of the bounds of the density, over its extent.
static double mean_bound(const struct majorant *majorant)
{
    size_t count = 1;
    double sum = 0.0;

    if (!majorant->bricks) return majorant->most;
    for (int a = 0; a < 3; a++)
        count *= (size_t)majorant->count[a];
    for (size_t i = 0; i < count; i++)
        sum += majorant->bricks[i];
    return sum / (double)count;
}

static double mean_of(const double value[static 3])
{
    return (value[0] + value[1] + value[2]) / 3.0;
}

// The least fall about a lamp in any of the media that hold it; 0: none does. Light finds the thin ways through what is
// uneven, and a fall that is too quick costs more than one that is too slow.
static double find_fall(const struct path_scene *scene, struct vec3 lamp)
{
    double least = INFINITY;

    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct medium *medium = scene->media[i].medium;
        const struct density *density = &medium->density;
        const struct majorant *majorant = &scene->media[i].majorant;
        double mean = mean_bound(majorant) * (majorant->is_even ? 1.0 : UNEVEN);
        double absorption = fmin(fmin(medium->sigma_a[0], medium->sigma_a[1]), medium->sigma_a[2]);
        double extinction = mean_of(medium->sigma_s) * scene->media[i].turn + absorption;
        struct box box = {.half = {INFINITY, INFINITY, INFINITY}};

        if (density->extent && density->extent(density->field, &box) && !box_holds(&box, lamp)) continue;
        if (mean * extinction > 0.0) least = fmin(least, path_pull_fall(mean * extinction, mean * absorption, &box));
    }
    return isinf(least) ? 0.0 : least;
}

static void add_pull(struct path_scene *scene, const struct path_peak *peak, double power)
{
    struct path_pull_lamp lamp = {peak->position, power, 0.0};

    if (peak->reach > 0.0) lamp.fall = find_fall(scene, peak->position);
    if (lamp.fall > 0.0) path_pull_add(&scene->pull, &lamp);
}

static void find_pull(struct path_scene *scene)
{
    const struct still *still = scene->still;

    for (size_t i = 0; i < still->light_count; i++) {
        const struct light *light = &still->lights[i];
        double part = light->kind == SCENE_LIGHT_SPOT ? 0.5 * (1.0 - cos(light->outer)) : 1.0;

        add_pull(scene, &scene->peaks[i], part * mean_of(light->intensity));
    }
    for (size_t i = 0; i < still->sphere_count; i++) {
        const struct sphere_light *sphere = &still->spheres[i];

        add_pull(scene, &scene->sphere_peaks[i], mean_of(sphere->radiance) * sphere->radius * sphere->radius);
    }
}

static void add_medium(struct path_scene *scene, const struct medium *medium)
{
    struct path_medium *added = &scene->media[scene->medium_count++];
    struct box extent;

    added->medium = medium;
    added->sigma = sigma_most(medium);
    added->glows = glows(medium);
    added->turn = mean_turn(medium);
    added->g = narrowest_g(medium);
    if (fabs(added->g) >= WIDE_G && (!scene->narrow || fabs(scene->narrow->g) < fabs(added->g))) scene->narrow = added;
    added->aim_vertices = count_aim_vertices(medium);
    majorant_init(&added->majorant, &medium->density);
    if (!added->glows || !(added->majorant.most > 0.0)) return;
    if (medium->density.extent && medium->density.extent(medium->density.field, &extent))
        added->sigma = fmax(added->sigma, GLOW_LOOKS / (added->majorant.most * 2.0 * box_radius(&extent)));
}

void path_scene_init(struct path_scene *scene, const struct still *still, int orders)
{
    *scene = (struct path_scene){.still = still, .orders = orders};
    for (size_t i = 0; i < still->medium_count; i++) {
        const struct medium *medium = &still->media[i];

        if (sigma_most(medium) > 0.0 || glows(medium)) add_medium(scene, medium);
    }
    find_peaks(scene);
    find_pull(scene);
    if (scene->narrow) path_depth_init(&scene->depth, still);
    if (still->has_dome) dome_sampler_init(&scene->dome, &still->dome);
}

void path_scene_finish(struct path_scene *scene)
{
    for (size_t i = 0; i < scene->medium_count; i++)
        majorant_finish(&scene->media[i].majorant);
    dome_sampler_finish(&scene->dome);
    path_depth_finish(&scene->depth);
    *scene = (struct path_scene){0};
}

double path_peak_share(const struct path_peak *peak, struct vec3 position)
{
    struct vec3 away = vec3_subtract(position, peak->position);
    double near;

    if (!(peak->reach > 0.0)) return 0.0;
    near = 1.0 - vec3_dot(away, away) / (peak->reach * peak->reach);
    return near > 0.0 ? near * near : 0.0;
}
