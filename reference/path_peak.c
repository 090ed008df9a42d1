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

// On the given ray within the reach: even in the angle that the lamp sees.
static struct place draw_on_ray(const struct path_vertex *vertex, const struct path_peak *peak, double near, double far,
                                struct stream *stream)
{
    struct vec3 toward = vec3_subtract(peak->position, vertex->position);
    double along = vec3_dot(toward, vertex->incoming);
    double beside = vec3_length(vec3_subtract(toward, vec3_scale(vertex->incoming, along)));
    double half = sqrt(fmax(peak->reach * peak->reach - beside * beside, 0.0)), first, last, angle, rise;
    struct place place = {.direction = vertex->incoming, .begin = near};

    near = fmax(near, along - half);
    far = fmin(far, along + half);
    if (peak->spot && !spot_edges_clip(peak->spot, &(struct ray){vertex->position, vertex->incoming}, &near, &far))
        return place;
    if (!(near < far) || beside == 0.0) return place;
    first = find_angle(near - along, beside);
    last = find_angle(far - along, beside);
    angle = first + stream_draw(stream) * (last - first);
    rise = tan(angle);
    place.distance = along + beside * rise;
    place.weight = (last - first) * beside * (1.0 + rise * rise);
    return place;
}

// Direction and distance such that the density is in proportion to 1 / r^2, r being the distance to the lamp.
static struct place draw_jointly(const struct path_vertex *vertex, const struct path_peak *peak, struct stream *stream)
{
    struct vec3 toward = vec3_subtract(peak->position, vertex->position);
    double apart = vec3_length(toward), off = M_PI * (1.0 - sqrt(1.0 - stream_draw(stream)));
    double beside = apart * sin(off), angle = off - M_PI_2 + stream_draw(stream) * (M_PI - off), r;
    struct place place = {.distance = apart * cos(off) + beside * tan(angle)};

    if (!(apart > 0.0) || !(place.distance > 0.0)) return place;
    place.direction = phase_draw_about(vec3_scale(toward, 1.0 / apart), cos(off), stream);
    r = beside / cos(angle);
    place.weight = M_PI * M_PI * M_PI * r * r / apart;
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

static struct place draw_place(const struct path_vertex *vertex, const struct path_peak *peak, double near, double far,
                               struct stream *stream)
{
    struct vec3 toward = vec3_subtract(peak->position, vertex->position);
    bool is_beginning = !vertex->medium && !vertex->is_surface;

    if (is_beginning) return draw_on_ray(vertex, peak, near, far, stream);
    if (peak->spot) return draw_in_cone(vertex, peak, stream);
    if (vec3_length(toward) > FAR_REACHES * peak->reach) return draw_about(vertex, peak, stream);
    return draw_jointly(vertex, peak, stream);
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

void path_peak_add(const struct path_scene *scene, const struct path_vertex *vertex, double near, double far,
                   struct stream *stream, double radiance[static 3])
{
    const struct still *still = scene->still;

    for (size_t i = 0; i < still->light_count + still->sphere_count; i++) {
        bool is_sphere = i >= still->light_count;
        size_t lamp = is_sphere ? i - still->light_count : i;
        const struct path_peak *peak = is_sphere ? &scene->sphere_peaks[lamp] : &scene->peaks[lamp];
        struct place place;

        if (!(peak->reach > 0.0)) continue;
        place = draw_place(vertex, peak, near, far, stream);
        if (place.weight > 0.0) add_peak(scene, vertex, peak, &place, lamp, is_sphere, stream, radiance);
    }
}
