// SPDX-License-Identifier: Apache-2.0
#include "reference/path_light.h"

#include "reference/path_passage.h"
#include "reference/phase_draw.h"

#include <math.h>

// The least chance of a look towards a lamp.
static const double LEAST_CHANCE = 0.05;

double path_vertex_scatter(const struct path_vertex *vertex, struct vec3 direction)
{
    if (vertex->is_surface) return fmax(vec3_dot(vertex->normal, direction), 0.0) / M_PI;
    return medium_phase(vertex->medium, vec3_dot(vertex->incoming, direction));
}

struct vec3 path_vertex_draw(const struct path_vertex *vertex, struct stream *stream)
{
    if (vertex->is_surface) return phase_draw_about(vertex->normal, sqrt(1.0 - stream_draw(stream)), stream);
    return phase_draw_about(vertex->incoming, phase_draw_cosine(vertex->medium, stream), stream);
}

// Adds light that comes along `toward` from `distance`, times `factor`.
static void add(const struct path_scene *scene, const struct path_vertex *vertex, struct vec3 toward, double distance,
                double factor, const double light[static 3], struct stream *stream, double radiance[static 3])
{
    const struct ray ray = {vertex->position, toward};
    double passed[3], sum = 0.0;

    for (int c = 0; c < 3; c++) {
        passed[c] = vertex->throughput[c] * light[c] * factor;
        sum += passed[c];
    }
    if (!(sum > 0.0)) return;
    path_passage_attenuate(scene, &ray, distance, stream, passed);
    for (int c = 0; c < 3; c++)
        radiance[c] += passed[c];
}

// How often a vertex looks towards a lamp into whose light it scatters `scatter`: always from the share on that it has
// in all directions, else less often. A narrow phase sees most lamps from aside, and each look costs a passage.
static double chance_of_look(const struct path_vertex *vertex, double scatter)
{
    double throughput = fmax(fmax(vertex->throughput[0], vertex->throughput[1]), vertex->throughput[2]);

    return fmin(fmax(4.0 * M_PI * scatter * throughput, LEAST_CHANCE), 1.0);
}

static void add_lamp(const struct path_scene *scene, const struct path_vertex *vertex, size_t lamp, double share,
                     bool is_seldom, struct stream *stream, double radiance[static 3])
{
    struct light_arrival arrival = light_arrive(&scene->still->lights[lamp], vertex->position);
    struct vec3 toward = vec3_scale(arrival.travel, -1.0);
    double scatter = path_vertex_scatter(vertex, toward), chance = 1.0;

    // At the lamp itself nothing is known.
    if (share == 0.0 || scatter == 0.0 || arrival.distance == 0.0) return;
    if (is_seldom) chance = chance_of_look(vertex, scatter);
    if (chance < 1.0 && !(stream_draw(stream) < chance)) return;
    add(scene, vertex, toward, arrival.distance, scatter * share / chance, arrival.irradiance, stream, radiance);
}

void path_light_add_lamp(const struct path_scene *scene, const struct path_vertex *vertex, size_t lamp, double share,
                         struct stream *stream, double radiance[static 3])
{
    add_lamp(scene, vertex, lamp, share, false, stream, radiance);
}

// `is_alone`: no other way brings this light.
static void add_sphere(const struct path_scene *scene, const struct path_vertex *vertex, size_t sphere, double share,
                       bool is_alone, struct stream *stream, double radiance[static 3])
{
    const struct sphere_light *lamp = &scene->still->spheres[sphere];
    double angle = sphere_light_solid_angle(lamp, vertex->position), scatter, distance;
    struct ray ray = {.origin = vertex->position};
    double u[2];

    if (share == 0.0 || angle == 0.0) return;
    u[0] = stream_draw(stream);
    u[1] = stream_draw(stream);
    ray.direction = sphere_light_draw(lamp, vertex->position, u);
    scatter = path_vertex_scatter(vertex, ray.direction);
    if (scatter == 0.0) return;
    distance = sphere_light_distance(lamp, &ray);
    // Rounding may let a direction at the rim pass by.
    if (isinf(distance)) distance = vec3_length(vec3_subtract(lamp->center, ray.origin));
    add(scene, vertex, ray.direction, distance, scatter * share / (1.0 / angle + (is_alone ? 0.0 : scatter)),
        lamp->radiance, stream, radiance);
}

void path_light_add_sphere(const struct path_scene *scene, const struct path_vertex *vertex, size_t sphere,
                           double share, struct stream *stream, double radiance[static 3])
{
    add_sphere(scene, vertex, sphere, share, true, stream, radiance);
}

// Only images have directions so bright that they must be looked for.
static bool has_bright_directions(const struct path_scene *scene)
{
    return scene->still->has_dome && scene->dome.sums;
}

static void add_dome(const struct path_scene *scene, const struct path_vertex *vertex, struct stream *stream,
                     double radiance[static 3])
{
    double u[4], light[3], scatter;
    struct vec3 toward;

    for (int i = 0; i < 4; i++)
        u[i] = stream_draw(stream);
    toward = dome_sampler_draw(&scene->dome, u);
    scatter = path_vertex_scatter(vertex, toward);
    if (scatter == 0.0) return;
    dome_radiance(&scene->still->dome, toward, light);
    add(scene, vertex, toward, INFINITY, scatter / (dome_sampler_density(&scene->dome, toward) + scatter), light,
        stream, radiance);
}

// What is left to the vertex itself.
static double own_share(const struct path_peak *peak, const struct path_vertex *vertex)
{
    return vertex->is_surface ? 1.0 : 1.0 - path_peak_share(peak, vertex->position);
}

double path_light_aimed_share(const struct path_aim *aim, size_t lamp)
{
    double sum = 1.0;

    for (int i = 0; i < PATH_AIM_VERTICES && aim->lamp_count > 0; i++)
        sum += aim->ratios[i][lamp];
    return 1.0 / sum;
}

void path_light_add_one(const struct path_scene *scene, const struct path_vertex *vertex, const struct path_aim *aim,
                        size_t lamp, struct stream *stream, double radiance[static 3])
{
    size_t lights = scene->still->light_count;
    double share = path_light_aimed_share(aim, lamp);

    if (lamp < lights) {
        // Where light grows without limit, a seldom look would bring too much at once.
        bool is_seldom = scene->peaks[lamp].reach == 0.0 && !vertex->is_first;

        add_lamp(scene, vertex, lamp, share * own_share(&scene->peaks[lamp], vertex), is_seldom, stream, radiance);
    } else {
        lamp -= lights;
        share *= own_share(&scene->sphere_peaks[lamp], vertex);
        add_sphere(scene, vertex, lamp, share, false, stream, radiance);
    }
}

void path_light_add(const struct path_scene *scene, const struct path_vertex *vertex, const struct path_aim *aim,
                    struct stream *stream, double radiance[static 3])
{
    for (size_t i = 0; i < scene->still->light_count + scene->still->sphere_count; i++)
        path_light_add_one(scene, vertex, aim, i, stream, radiance);
    if (has_bright_directions(scene)) add_dome(scene, vertex, stream, radiance);
}

double path_light_sphere_share(const struct path_scene *scene, const struct path_vertex *vertex, size_t sphere,
                               struct vec3 direction)
{
    double angle = sphere_light_solid_angle(&scene->still->spheres[sphere], vertex->position);
    double scatter = path_vertex_scatter(vertex, direction);

    if (angle == 0.0 || scatter == 0.0) return 0.0;
    return own_share(&scene->sphere_peaks[sphere], vertex) * scatter / (1.0 / angle + scatter);
}

double path_light_dome_share(const struct path_scene *scene, const struct path_vertex *vertex, struct vec3 direction)
{
    double scatter = path_vertex_scatter(vertex, direction);

    if (!has_bright_directions(scene)) return 1.0;
    return scatter > 0.0 ? scatter / (dome_sampler_density(&scene->dome, direction) + scatter) : 0.0;
}
