// SPDX-License-Identifier: Apache-2.0
#include "reference/path_walk.h"

#include "reference/path_aim.h"
#include "reference/path_light.h"
#include "reference/path_peak.h"
#include "reference/surface.h"

#include <math.h>

// Below this throughput a path goes on at random.
static const double WEAK = 0.1;
// The same where lamps are looked for, at a path's beginning; set by noise at equal time.
static const double WEAK_TO_LAMPS = 0.3;
// Paths that go on from one vertex, at most.
static const double SPLIT_MOST = 8.0;
enum { SPLITS_MOST = 64 }; // of a path, one after another
// A path that would collide within this depth of the media's bounds is not forced to: others are one in e^-16.
static const double SURE_DEPTH = 16.0;

struct walker {
    const struct path_scene *scene;
    const struct path_walk *walk;
    struct stream *stream;
    double within[3], beyond[3]; // light so far that has not been handed over
    double *radiance;            // 3
    double share;                // of the light, that is handed over
    struct ray ray;
    double near, far; // m: media count between them on this stretch
    double throughput[3];
    int order;                 // scatterings so far
    double turned;             // by them: the sum of 1 less each one's mean cosine
    double pull_first, pull;   // of lamps: at the first vertex, and how many times as great at the last, 1 at least
    int splits;                // of the path so far
    struct path_vertex vertex; // the last; or the path's beginning
    struct path_aim aim;
    bool is_aimed; // a second path, which looks for one lamp alone
    long looks;
};

// A straight stretch up to a surface or to where the still ends.
struct stretch {
    double end; // m; may be INFINITY
    bool is_inside, has_surface;
    size_t region, shape; // of the surface
    struct flight flights[SCENE_MEDIUM_LIMIT];
    double next[SCENE_MEDIUM_LIMIT];     // m to each medium's next tentative collision
    double sphere_at[SCENE_LIGHT_LIMIT]; // m to where each sphere is met; INFINITY: nowhere, or it is counted
};

static double greatest(const double value[static 3])
{
    return fmax(fmax(value[0], value[1]), value[2]);
}

// Where light goes that is scattered so often, counting emitted light as scattered once more than it is.
static double *radiance_of(struct walker *walker, int order)
{
    return walker->walk->beyond && order > walker->walk->parted ? walker->beyond : walker->within;
}

static void hand_over(struct walker *walker)
{
    for (int c = 0; c < 3; c++) {
        walker->radiance[c] += walker->share * walker->within[c];
        if (walker->walk->beyond) walker->walk->beyond[c] += walker->share * walker->beyond[c];
        walker->within[c] = walker->beyond[c] = 0.0;
    }
}

static void advance(struct walker *walker, struct stretch *stretch, size_t medium)
{
    double depth = -log(1.0 - stream_draw(walker->stream));

    stretch->next[medium] = flight_advance(&stretch->flights[medium], depth / walker->scene->media[medium].sigma);
}

static bool is_beginning(const struct walker *walker)
{
    return walker->order == 0;
}

// True when light counts that arrives straight along the ray from domes and lamps with size.
static bool meets_light(const struct walker *walker)
{
    return !walker->is_aimed && !(is_beginning(walker) && walker->walk->is_seen);
}

static double sum_of_depths(const struct path_walk *walk, size_t count)
{
    double sum = 0.0;

    for (size_t i = 0; i < count; i++)
        sum += walk->depths[i];
    return sum;
}

// Tentative collisions of the media are independent: as if the media lay one behind the other, the depth of the first
// one tells in which medium it is. Those before have none, and those behind it any number.
static void force(struct walker *walker, struct stretch *stretch)
{
    const struct path_walk *walk = walker->walk;
    const struct path_scene *scene = walker->scene;
    double chance = -expm1(-sum_of_depths(walk, scene->medium_count));
    double depth = -log1p(-chance * stream_draw(walker->stream));
    size_t first = 0;

    while (first + 1 < scene->medium_count && depth >= walk->depths[first]) {
        stretch->next[first] = INFINITY;
        depth -= walk->depths[first++];
    }
    stretch->next[first] = flight_advance(&stretch->flights[first], depth / scene->media[first].sigma);
    for (size_t i = first + 1; i < scene->medium_count; i++)
        advance(walker, stretch, i);
    hand_over(walker); // what was found without a collision
    walker->share = chance;
}

static void draw_collisions(struct walker *walker, struct stretch *stretch)
{
    if (is_beginning(walker) && walker->walk->is_forced) {
        force(walker, stretch);
        return;
    }
    for (size_t i = 0; i < walker->scene->medium_count; i++)
        advance(walker, stretch, i);
}

static void begin_stretch(struct walker *walker, struct stretch *stretch)
{
    const struct path_scene *scene = walker->scene;
    const struct still *still = scene->still;

    stretch->end = INFINITY;
    stretch->has_surface = stretch->is_inside = false;
    if (still->objects.count > 0) {
        struct object_walk walk;

        objects_walk(&still->objects, &walker->ray, INFINITY, &walk);
        stretch->is_inside = walk.pieces[0].region > 0;
        stretch->has_surface = walk.count > 1;
        if (stretch->has_surface) {
            stretch->end = walk.pieces[0].end;
            stretch->region = walk.pieces[1].region;
            stretch->shape = walk.pieces[0].shape;
        }
    }
    for (size_t i = 0; i < still->sphere_count; i++)
        stretch->sphere_at[i] =
            meets_light(walker) ? sphere_light_distance(&still->spheres[i], &walker->ray) : INFINITY;
    for (size_t i = 0; i < scene->medium_count; i++)
        flight_begin(&stretch->flights[i], &scene->media[i].majorant, &walker->ray, walker->near,
                     fmin(walker->far, stretch->end));
}

// Counts the spheres that are met before `at`.
static void meet_spheres(struct walker *walker, struct stretch *stretch, double at)
{
    const struct still *still = walker->scene->still;
    double *radiance = radiance_of(walker, walker->order);

    for (size_t i = 0; i < still->sphere_count; i++) {
        double share = 1.0;

        if (!(stretch->sphere_at[i] < at)) continue;
        stretch->sphere_at[i] = INFINITY;
        if (!is_beginning(walker))
            share = path_light_sphere_share(walker->scene, &walker->vertex, i, walker->ray.direction);
        for (int c = 0; c < 3; c++)
            radiance[c] += walker->throughput[c] * share * still->spheres[i].radiance[c];
    }
}

static void meet_dome(struct walker *walker)
{
    double *radiance = radiance_of(walker, walker->order), light[3], share = 1.0;

    if (!walker->scene->still->has_dome || !meets_light(walker)) return;
    if (!is_beginning(walker)) share = path_light_dome_share(walker->scene, &walker->vertex, walker->ray.direction);
    dome_radiance(&walker->scene->still->dome, walker->ray.direction, light);
    for (int c = 0; c < 3; c++)
        radiance[c] += walker->throughput[c] * share * light[c];
}

// In a deep white medium a part of n^(-1/2) of the paths goes on after n turns, each of which brings less light of
// lamps: n^(-3/2). The least noise for the time has odds in proportion to the root of the quotient.
static double weak_throughput(const struct walker *walker)
{
    return path_aim_count_lamps(walker->scene) > 0 ? WEAK_TO_LAMPS * sqrt(1.0 + walker->turned) : WEAK;
}

// False: the path ends.
static bool survives(struct walker *walker)
{
    double chance = greatest(walker->throughput) * walker->pull / weak_throughput(walker);

    if (chance >= 1.0) return true;
    if (!(stream_draw(walker->stream) < chance)) return false;
    for (int c = 0; c < 3; c++)
        walker->throughput[c] /= chance;
    return true;
}

static void add_glow(struct walker *walker, const struct path_medium *medium, struct vec3 position, double density,
                     double rate)
{
    double *radiance = radiance_of(walker, walker->order + 1), source[3];

    if (!medium->glows || walker->is_aimed || walker->order >= walker->scene->orders) return;
    medium_source(medium->medium, position, density, source);
    for (int c = 0; c < 3; c++)
        radiance[c] += walker->throughput[c] * source[c] / rate;
}

enum event { EVENT_NONE, EVENT_SCATTERED, EVENT_ENDED };

// Draws what a tentative collision is: a scattering or nothing. What is absorbed is taken from the throughput.
static enum event collide(struct walker *walker, const struct path_medium *path_medium, double most, double at)
{
    const struct medium *medium = path_medium->medium;
    struct vec3 position = ray_at(&walker->ray, at);
    double density = medium->density.at(medium->density.field, position), rate = path_medium->sigma * most;
    double scattered[3], passed[3], scattered_sum = 0.0, passed_sum = 0.0, chance;
    bool is_scattered;

    walker->looks++;
    if (density == 0.0) return EVENT_NONE;
    add_glow(walker, path_medium, position, density, rate);
    for (int c = 0; c < 3; c++) {
        double sigma_t = medium->sigma_s[c] + medium->sigma_a[c];

        scattered[c] = walker->throughput[c] * medium->sigma_s[c] * density / rate;
        passed[c] = walker->throughput[c] * fmax(1.0 - sigma_t * density / rate, 0.0);
        scattered_sum += scattered[c];
        passed_sum += passed[c];
    }
    if (!(scattered_sum + passed_sum > 0.0)) return EVENT_ENDED;
    chance = scattered_sum / (scattered_sum + passed_sum);
    is_scattered = stream_draw(walker->stream) < chance;
    for (int c = 0; c < 3; c++)
        walker->throughput[c] = is_scattered ? scattered[c] / chance : passed[c] / (1.0 - chance);
    if (!is_scattered) return survives(walker) ? EVENT_NONE : EVENT_ENDED;
    walker->vertex = (struct path_vertex){.position = position,
                                          .incoming = walker->ray.direction,
                                          .medium = medium,
                                          .turn = path_medium->turn,
                                          .aim_vertices = path_medium->aim_vertices};
    return walker->order < walker->scene->orders ? EVENT_SCATTERED : EVENT_ENDED;
}

// Follows the stretch through the media to its end or to a scattering.
static enum event fly(struct walker *walker, struct stretch *stretch)
{
    const struct path_scene *scene = walker->scene;

    for (;;) {
        size_t first = 0;
        enum event event;
        double at;

        for (size_t i = 1; i < scene->medium_count; i++)
            if (stretch->next[i] < stretch->next[first]) first = i;
        if (scene->medium_count == 0 || isinf(stretch->next[first])) return EVENT_NONE;
        at = stretch->next[first];
        meet_spheres(walker, stretch, at);
        event = collide(walker, &scene->media[first], stretch->flights[first].most, at);
        if (event != EVENT_NONE) return event;
        advance(walker, stretch, first);
    }
}

// Counts the scattering.
static struct path_vertex *reach_vertex(struct walker *walker)
{
    struct path_vertex *vertex = &walker->vertex;
    const struct path_pull *pull = &walker->scene->pull;

    if (is_beginning(walker)) walker->pull_first = path_pull_at(pull, vertex->position);
    walker->pull = path_pull_growth(pull, vertex->position, walker->pull_first);
    vertex->is_first = is_beginning(walker) && walker->walk->is_seen;
    walker->turned += vertex->turn;
    walker->order++;
    for (int c = 0; c < 3; c++)
        vertex->throughput[c] = walker->throughput[c];
    return vertex;
}

static void leave_vertex(struct walker *walker, struct vec3 direction)
{
    for (int c = 0; c < 3; c++)
        walker->vertex.throughput[c] = walker->throughput[c];
    path_aim_note(&walker->aim, &walker->vertex, direction);
    walker->ray = (struct ray){walker->vertex.position, direction};
    walker->near = 0.0;
    walker->far = INFINITY;
}

// Follows a second path to its next vertex; false: it has ended.
static bool follow_aimed(struct walker *walker, size_t lamp)
{
    struct path_vertex *vertex;
    struct stretch stretch;

    begin_stretch(walker, &stretch);
    if (stretch.is_inside) return false;
    draw_collisions(walker, &stretch);
    if (fly(walker, &stretch) != EVENT_SCATTERED) return false;
    vertex = reach_vertex(walker);
    path_light_add_one(walker->scene, vertex, &walker->aim, lamp, walker->stream, radiance_of(walker, walker->order));
    if (walker->order < walker->scene->orders)
        path_peak_add_one(walker->scene, vertex, &walker->aim, lamp, walker->stream,
                          radiance_of(walker, walker->order + 1));
    if (walker->order >= walker->scene->orders || !survives(walker)) return false;
    path_aim_look(&walker->aim, walker->scene, vertex);
    leave_vertex(walker, path_vertex_draw(vertex, walker->stream));
    return true;
}

// Takes over what another way of the path found, which began with what this one had.
static void take_back(struct walker *walker, const struct walker *other)
{
    walker->looks = other->looks;
    for (int c = 0; c < 3; c++) {
        walker->within[c] = other->within[c];
        walker->beyond[c] = other->beyond[c];
    }
}

static void send_aimed(struct walker *walker)
{
    const struct path_vertex *vertex = &walker->vertex;
    size_t count = vertex->aim_vertices > 0 ? path_aim_count_lamps(walker->scene) : 0;

    for (size_t i = 0; i < count; i++) {
        struct walker aside;

        if (!(stream_draw(walker->stream) < walker->aim.chances[i])) continue;
        aside = *walker;
        aside.is_aimed = true;
        leave_vertex(&aside, path_aim_draw(&walker->aim, vertex, i, walker->stream));
        for (int k = 0; k < vertex->aim_vertices && follow_aimed(&aside, i); k++)
            continue;
        take_back(walker, &aside);
    }
}

static bool is_given_up(const struct walker *walker)
{
    uint64_t most = walker->walk->draws_most;

    return most > 0 && walker->stream->drawn > most;
}

static void follow_to_end(struct walker *walker);

// Has several paths go on from the vertex in place of one where the one would bring so much light.
static void split(struct walker *walker)
{
    double due = greatest(walker->throughput) * walker->pull / fmax(weak_throughput(walker), 1.0);
    int count = (int)fmin(due, SPLIT_MOST);
    struct walker other;

    if (count < 2 || walker->splits >= SPLITS_MOST) return;
    walker->splits++;
    for (int c = 0; c < 3; c++)
        walker->throughput[c] /= count;
    for (int i = 1; i < count && !is_given_up(walker); i++) {
        other = *walker;
        leave_vertex(&other, path_vertex_draw(&other.vertex, other.stream));
        follow_to_end(&other);
        take_back(walker, &other);
    }
}

// Collects the light at the vertex and draws where the path goes on; false: it ends.
static bool scatter(struct walker *walker)
{
    const struct path_scene *scene = walker->scene;
    const struct still *still = scene->still;
    struct path_vertex *vertex = reach_vertex(walker);

    if (walker->walk->on_vertex)
        walker->walk->on_vertex(walker->walk->user, walker->order, vertex->position, walker->throughput);
    if (vertex->is_surface) walker->aim = (struct path_aim){0}; // second paths end at surfaces
    path_light_add(scene, vertex, &walker->aim, walker->stream, radiance_of(walker, walker->order));
    for (size_t i = 0; walker->order < scene->orders && i < path_aim_count_lamps(scene); i++)
        path_peak_add_one(scene, vertex, &walker->aim, i, walker->stream, radiance_of(walker, walker->order + 1));
    if (walker->order >= scene->orders && !still->has_dome && still->sphere_count == 0) return false;
    if (!survives(walker)) return false;
    path_aim_look(&walker->aim, scene, vertex);
    if (walker->order < scene->orders) send_aimed(walker);
    split(walker);
    leave_vertex(walker, path_vertex_draw(vertex, walker->stream));
    return true;
}

// False: the surface is not followed, since light was scattered as often as it may.
static bool meet_surface(struct walker *walker, const struct stretch *stretch)
{
    const struct objects *objects = &walker->scene->still->objects;
    const struct shape *shape = &objects->shapes[stretch->shape];
    struct path_vertex *vertex = &walker->vertex;
    double albedo[3];

    if (walker->order >= walker->scene->orders) return false;
    *vertex = (struct path_vertex){.incoming = walker->ray.direction, .is_surface = true, .turn = 1.0};
    vertex->position = shape_snap(shape, ray_at(&walker->ray, stretch->end));
    vertex->normal = shape_normal(shape, vertex->position);
    // An object that ends here leaves the face of the one behind it, turned the other way.
    if (vec3_dot(vertex->normal, walker->ray.direction) > 0.0) vertex->normal = vec3_scale(vertex->normal, -1.0);
    surface_find_albedo(objects, stretch->region, stretch->shape, vertex->position, albedo);
    for (int c = 0; c < 3; c++)
        walker->throughput[c] *= albedo[c];
    return greatest(walker->throughput) > 0.0;
}

// False: the path has ended.
static bool follow(struct walker *walker)
{
    struct stretch stretch;
    enum event event;

    begin_stretch(walker, &stretch);
    if (stretch.is_inside) return false;
    if (is_beginning(walker))
        path_peak_add(walker->scene, &walker->vertex, walker->near, fmin(walker->far, stretch.end), walker->stream,
                      radiance_of(walker, walker->order + 1));
    draw_collisions(walker, &stretch);
    event = fly(walker, &stretch);
    if (event == EVENT_NONE) {
        meet_spheres(walker, &stretch, stretch.end);
        if (!stretch.has_surface) {
            meet_dome(walker);
            return false;
        }
        if (!meet_surface(walker, &stretch)) return false;
    }
    return event != EVENT_ENDED && scatter(walker);
}

static void follow_to_end(struct walker *walker)
{
    while (!is_given_up(walker) && follow(walker))
        continue;
}

void path_walk_force(const struct path_scene *scene, struct path_walk *walk)
{
    struct walker walker = {
        .scene = scene, .walk = walk, .ray = walk->ray, .near = walk->near, .far = walk->far, .order = 0};
    struct stretch stretch;
    double depth;

    begin_stretch(&walker, &stretch);
    for (size_t i = 0; i < scene->medium_count; i++) {
        double sigma = scene->media[i].sigma;

        walk->depths[i] = sigma > 0.0 ? sigma * flight_column(&stretch.flights[i]) : 0.0;
    }
    depth = sum_of_depths(walk, scene->medium_count);
    walk->is_forced = walk->is_seen && !stretch.has_surface && !stretch.is_inside && depth > 0.0 && depth < SURE_DEPTH;
}

long path_walk_add(const struct path_scene *scene, const struct path_walk *walk, struct stream *stream,
                   double radiance[static 3])
{
    struct walker walker = {
        .scene = scene,
        .walk = walk,
        .stream = stream,
        .radiance = radiance,
        .share = 1.0,
        .ray = walk->ray,
        .near = walk->near,
        .far = walk->far,
        .throughput = {1.0, 1.0, 1.0},
        .pull = 1.0,
        .vertex = {.position = walk->ray.origin, .incoming = walk->ray.direction, .throughput = {1.0, 1.0, 1.0}},
    };

    if (walk->from) {
        walker.vertex = *walk->from;
        walker.ray = (struct ray){walk->from->position, path_vertex_draw(walk->from, stream)};
    }
    follow_to_end(&walker);
    hand_over(&walker);
    return walker.looks;
}
