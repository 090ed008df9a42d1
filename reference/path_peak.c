// SPDX-License-Identifier: Apache-2.0
#include "reference/path_peak.h"

#include "reference/path_passage.h"
#include "reference/phase_draw.h"
#include "reference/spot_edges.h"

#include <math.h>

// From farther away than this many reaches, places are drawn about the lamp alone.
static const double FAR_REACHES = 2.0;
// From farther off a spot's axis than so many half-angles, places are drawn evenly in its cone.
static const double BESIDE = 1.1;

// A drawn place of the new vertex.
struct place {
    struct vec3 direction;
    double begin;    // m from the vertex before to where media begin to count
    double distance; // m from the vertex before
    double weight;   // 1 / density per steradian and metre; from a path's beginning, per metre. 0: there is none
};

static double find_angle(double along, double beside)
{
    return atan2(along, beside);
}

// The share of Cauchy's distribution on a circle that turns by less.
static double turn_share(double g, double turn)
{
    return atan2((1.0 + g) * sin(0.5 * turn), (1.0 - g) * cos(0.5 * turn)) * M_2_PI;
}

// An angle between the two, from what is beside the lamp. Every other one is drawn more often where a narrow lobe sends
// light.
static double draw_angle(double first, double last, const struct path_medium *lobe, struct stream *stream,
                         double *density)
{
    double u = stream_draw(stream), low, high, turn, g;

    *density = 1.0 / (last - first);
    if (!lobe) return first + u * (last - first);
    g = lobe->g;
    low = turn_share(g, M_PI_2 + first);
    high = turn_share(g, M_PI_2 + last);
    if (stream_draw(stream) < 0.5) {
        turn = M_PI_2 + first + u * (last - first);
    } else {
        u = M_PI_2 * (low + u * (high - low));
        turn = 2.0 * atan2((1.0 - g) * sin(u), (1.0 + g) * cos(u));
    }
    *density = 0.5 * (*density + (1.0 - g * g) / (M_PI * (1.0 + g * g - 2.0 * g * cos(turn)) * (high - low)));
    return turn - M_PI_2;
}

// On the given ray within the reach: even in the angle that the lamp sees.
static struct place draw_on_ray(const struct path_vertex *vertex, const struct path_peak *peak, double near, double far,
                                const struct path_medium *lobe, struct stream *stream)
{
    struct vec3 toward = vec3_subtract(peak->position, vertex->position);
    double along = vec3_dot(toward, vertex->incoming);
    double beside = vec3_length(vec3_subtract(toward, vec3_scale(vertex->incoming, along)));
    double half = sqrt(fmax(peak->reach * peak->reach - beside * beside, 0.0)), first, last, angle, rise, density;
    struct place place = {.direction = vertex->incoming, .begin = near};

    near = fmax(near, along - half);
    far = fmin(far, along + half);
    if (peak->spot && !spot_edges_clip(peak->spot, &(struct ray){vertex->position, vertex->incoming}, &near, &far))
        return place;
    if (!(near < far) || beside == 0.0) return place;
    first = find_angle(near - along, beside);
    last = find_angle(far - along, beside);
    angle = draw_angle(first, last, lobe, stream, &density);
    rise = tan(angle);
    place.distance = along + beside * rise;
    place.weight = beside * (1.0 + rise * rise) / density;
    return place;
}

// A triangle of the vertex, the new one and the lamp: angles at the vertex and at the lamp. Light turns by their sum.
struct corner {
    double at_vertex, at_lamp;
    struct vec3 direction; // from the vertex to the new one
};

static double angle_between(struct vec3 a, struct vec3 b)
{
    return atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b));
}

// Even in both angles.
static struct corner draw_evenly(struct vec3 toward, struct stream *stream)
{
    struct corner corner = {.at_vertex = M_PI * (1.0 - sqrt(1.0 - stream_draw(stream)))};

    corner.at_lamp = stream_draw(stream) * (M_PI - corner.at_vertex);
    corner.direction = phase_draw_about(toward, cos(corner.at_vertex), stream);
    return corner;
}

// As the vertex scatters, then even in the angle at the lamp.
static struct corner draw_on_by_vertex(const struct path_vertex *vertex, struct vec3 toward, struct stream *stream)
{
    struct corner corner = {.direction = path_vertex_draw(vertex, stream)};

    corner.at_vertex = angle_between(corner.direction, toward);
    corner.at_lamp = stream_draw(stream) * (M_PI - corner.at_vertex);
    return corner;
}

// As the new vertex scatters, then even in the angle at the vertex.
static struct corner draw_by_lobe(const struct medium *lobe, struct vec3 toward, struct stream *stream)
{
    double turn = acos(phase_draw_cosine(lobe, stream));
    struct corner corner = {.at_vertex = turn * stream_draw(stream)};

    corner.at_lamp = turn - corner.at_vertex;
    corner.direction = phase_draw_about(toward, cos(corner.at_vertex), stream);
    return corner;
}

// Per radian of both angles and radian about the way to the lamp.
static double corner_density(const struct path_vertex *vertex, const struct medium *lobe, const struct corner *corner)
{
    double even = 1.0 / (M_PI * M_PI * M_PI), turn = corner->at_vertex + corner->at_lamp, on, by_lobe;

    if (!lobe) return even;
    on = path_vertex_scatter(vertex, corner->direction) * sin(corner->at_vertex) / (M_PI - corner->at_vertex);
    by_lobe = medium_phase(lobe, cos(turn)) * sin(turn) / turn;
    return (even + on + by_lobe) / 3.0;
}

// By one of three densities, each of which counts by the balance heuristic.
static struct place draw_jointly(const struct path_vertex *vertex, const struct path_peak *peak,
                                 const struct medium *lobe, struct stream *stream)
{
    struct vec3 toward = vec3_subtract(peak->position, vertex->position);
    double apart = vec3_length(toward), choice = lobe ? 3.0 * stream_draw(stream) : 0.0, opposite, r;
    struct place place = {.distance = 0.0};
    struct corner corner;

    if (!(apart > 0.0)) return place;
    toward = vec3_scale(toward, 1.0 / apart);
    corner = choice < 1.0   ? draw_evenly(toward, stream)
             : choice < 2.0 ? draw_on_by_vertex(vertex, toward, stream)
                            : draw_by_lobe(lobe, toward, stream);
    opposite = sin(corner.at_vertex + corner.at_lamp);
    if (!(opposite > 0.0 && corner.at_lamp > 0.0)) return place;
    r = apart * sin(corner.at_vertex) / opposite;
    place.direction = corner.direction;
    place.distance = apart * sin(corner.at_lamp) / opposite;
    place.weight = r * r / (apart * corner_density(vertex, lobe, &corner));
    return place;
}

// Where a spot shines: from beside its cone the direction from the lamp is even in the cone, else even in its angle to
// the vertex before. The distance is even in the angle that the vertex sees. So the density is in proportion to the
// inverse squares of both distances.
static struct place draw_in_cone(const struct path_vertex *vertex, const struct path_peak *peak, struct stream *stream)
{
    struct vec3 back = vec3_subtract(vertex->position, peak->position), way;
    double apart = vec3_length(back), inverse, cosine, along, beside, first, angle, r;
    double off = atan2(vec3_length(vec3_cross(peak->spot->direction, back)), vec3_dot(peak->spot->direction, back));
    double turn = fmin(off + peak->spot->outer, M_PI) * stream_draw(stream);
    struct place place = {.begin = 0.0};

    if (!(apart > 0.0)) return place;
    back = vec3_scale(back, 1.0 / apart);
    if (off > BESIDE * peak->spot->outer) {
        cosine = 1.0 - (1.0 - cos(peak->spot->outer)) * stream_draw(stream);
        way = phase_draw_about(peak->spot->direction, cosine, stream);
        inverse = 2.0 * M_PI * (1.0 - cos(peak->spot->outer));
    } else {
        way = phase_draw_about(back, cos(turn), stream);
        inverse = 2.0 * M_PI * fmin(off + peak->spot->outer, M_PI) * sin(turn);
    }
    along = apart * vec3_dot(back, way);
    beside = apart * vec3_length(vec3_cross(back, way));
    if (!(beside > 0.0)) return place;
    first = find_angle(-along, beside);
    angle = find_angle(peak->reach - along, beside) - first;
    r = fmin(fmax(along + beside * tan(first + stream_draw(stream) * angle), 0.0), peak->reach);
    way = vec3_subtract(vec3_scale(way, r), vec3_scale(back, apart));
    place.distance = vec3_length(way);
    if (!(place.distance > 0.0)) return place;
    place.direction = vec3_scale(way, 1.0 / place.distance);
    place.weight = inverse * r * r * angle / beside;
    return place;
}

// About the lamp, even in direction and distance.
static struct place draw_about(const struct path_vertex *vertex, const struct path_peak *peak, struct stream *stream)
{
    static const struct vec3 UP = {0.0, 0.0, 1.0};
    double r = peak->reach * stream_draw(stream);
    struct vec3 away = vec3_scale(phase_draw_about(UP, 2.0 * stream_draw(stream) - 1.0, stream), r);
    struct vec3 way = vec3_subtract(vec3_add(peak->position, away), vertex->position);
    double distance = vec3_length(way);

    return (struct place){.direction = vec3_scale(way, 1.0 / distance),
                          .distance = distance,
                          .weight = 4.0 * M_PI * peak->reach * r * r / (distance * distance)};
}

static struct place draw_place(const struct path_scene *scene, const struct path_vertex *vertex,
                               const struct path_peak *peak, double near, double far, struct stream *stream)
{
    struct vec3 toward = vec3_subtract(peak->position, vertex->position);
    bool is_beginning = !vertex->medium && !vertex->is_surface;

    if (is_beginning) return draw_on_ray(vertex, peak, near, far, scene->narrow, stream);
    if (peak->spot) return draw_in_cone(vertex, peak, stream);
    if (vec3_length(toward) > FAR_REACHES * peak->reach) return draw_about(vertex, peak, stream);
    return draw_jointly(vertex, peak, scene->narrow ? scene->narrow->medium : NULL, stream);
}

// The part that a lamp's peak has in the light of the new vertex.
static void add_peak(const struct path_scene *scene, const struct path_vertex *vertex, const struct path_peak *peak,
                     const struct place *place, size_t lamp, bool is_sphere, struct stream *stream,
                     double radiance[static 3])
{
    const struct ray way = {vertex->position, place->direction}, ray = {ray_at(&way, place->begin), place->direction};
    struct path_vertex next = {.position = ray_at(&way, place->distance), .incoming = place->direction};
    double share = path_peak_share(peak, next.position), passed[3], scatter = 1.0;

    if (vertex->medium || vertex->is_surface) scatter = path_vertex_scatter(vertex, place->direction);
    if (!(share * scatter * place->weight > 0.0)) return;
    for (int c = 0; c < 3; c++)
        passed[c] = vertex->throughput[c] * scatter * place->weight;
    path_passage_attenuate(scene, &ray, place->distance - place->begin, stream, passed);
    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct medium *medium = scene->media[i].medium;
        double density = medium->density.at(medium->density.field, next.position);

        if (density == 0.0) continue;
        next.medium = medium;
        for (int c = 0; c < 3; c++)
            next.throughput[c] = passed[c] * medium->sigma_s[c] * density;
        if (is_sphere) {
            path_light_add_sphere(scene, &next, lamp, share, stream, radiance);
        } else {
            path_light_add_lamp(scene, &next, lamp, share, stream, radiance);
        }
    }
}

static void add_one(const struct path_scene *scene, const struct path_vertex *vertex, size_t lamp, double near,
                    double far, double share, struct stream *stream, double radiance[static 3])
{
    size_t lights = scene->still->light_count;
    bool is_sphere = lamp >= lights;
    const struct path_peak *peak = is_sphere ? &scene->sphere_peaks[lamp - lights] : &scene->peaks[lamp];
    struct place place;

    if (!(peak->reach > 0.0)) return;
    place = draw_place(scene, vertex, peak, near, far, stream);
    place.weight *= share;
    if (place.weight > 0.0)
        add_peak(scene, vertex, peak, &place, is_sphere ? lamp - lights : lamp, is_sphere, stream, radiance);
}

void path_peak_add_one(const struct path_scene *scene, const struct path_vertex *vertex, const struct path_aim *aim,
                       size_t lamp, struct stream *stream, double radiance[static 3])
{
    add_one(scene, vertex, lamp, 0.0, INFINITY, path_light_aimed_share(aim, lamp), stream, radiance);
}

void path_peak_add(const struct path_scene *scene, const struct path_vertex *vertex, double near, double far,
                   struct stream *stream, double radiance[static 3])
{
    for (size_t i = 0; i < scene->still->light_count + scene->still->sphere_count; i++)
        add_one(scene, vertex, i, near, far, 1.0, stream, radiance);
}
