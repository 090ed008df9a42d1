// SPDX-License-Identifier: Apache-2.0
#include "reference/integrate.h"

#include "core/base/alloc.h"
#include "core/scene/light_rules.h"
#include "reference/gauss.h"
#include "reference/light_walk.h"
#include "reference/shadow_edges.h"
#include "reference/transmittance.h"

#include <math.h>
#include <stdlib.h>

static const double DEFAULT_RELATIVE = 1e-4;
static const double DEFAULT_FLOOR = 1e-6;
enum { DEFAULT_HALVING_LIMIT = 30 };

// The transmittance behind which scattered light is left out.
static const double DARKNESS = 1e-12;
// The radiance of the scattered light that a loose accuracy leaves out, relative to the floor's error.
static const double FAINT = 1e-3;

// The optical depth of a cell at most: in a deeper one every node may lie behind the bright front, and two halvings
// agree on black.
static const double THICKEST_CELL = 2.0;

// The factor by which a halving divides a cell's error at least, even at a kink: 2^2.
static const double LITTLE = 4.0;

struct gatherer {
    const struct still *still;
    const struct ray *ray;
    struct still_media media; // of the ray's region
    double relative;          // accuracy of the radiance
    double shadow_tolerance;  // of optical depths
    double radiance_tolerance[3], share_tolerance;
    double faint;  // light is left out where it would add less even without shadow; radiance per metre
    bool is_loose; // one agreement of halvings is enough
    bool hit_limit;
};

struct cell {
    double begin, end; // m along the ray
};

static struct cell cell_of(const struct span *span)
{
    return (struct cell){span->begin, span->end};
}

// The light that a cell adds to a ray of throughput 1 at its begin.
struct cell_light {
    double radiance[3], optical_depth[3];
};

static bool is_dark(const double throughput[static 3])
{
    return throughput[0] < DARKNESS && throughput[1] < DARKNESS && throughput[2] < DARKNESS;
}

// Near a light even a small throughput may leave much of it.
static bool is_faint(const struct gatherer *gatherer, const double throughput[static 3], const double source[static 3])
{
    for (int c = 0; c < 3; c++) {
        if (!(throughput[c] * source[c] <= gatherer->faint)) return false;
    }
    return true;
}

static void add_light(const struct gatherer *gatherer, const struct light *light, struct vec3 position,
                      const double *density, const double throughput[static 3], double source[static 3])
{
    struct light_arrival arrival = light_arrive(light, position);
    struct ray shadow = {position, vec3_scale(arrival.travel, -1.0)};
    // The scattered light travels against the camera's ray.
    double cos_theta = -vec3_dot(arrival.travel, gatherer->ray->direction);
    double unshadowed[3] = {0.0}, share[3];

    for (size_t m = 0; m < gatherer->media.count; m++) {
        const struct medium *medium = &gatherer->media.list[m];
        double phase = medium_phase(medium, cos_theta);

        for (int c = 0; c < 3; c++)
            unshadowed[c] += medium->sigma_s[c] * density[m] * phase * arrival.irradiance[c];
    }
    if (is_faint(gatherer, throughput, unshadowed)) return;
    light_walk(gatherer->still, &shadow, arrival.distance, gatherer->shadow_tolerance, share);
    for (int c = 0; c < 3; c++)
        source[c] += share[c] * unshadowed[c];
}

// Extinction and source per metre at one point of the ray, which is seen with `throughput`.
static void sample(const struct gatherer *gatherer, double distance, const double throughput[static 3],
                   double sigma_t[static 3], double source[static 3])
{
    const struct still *still = gatherer->still;
    struct vec3 position = ray_at(gatherer->ray, distance);
    double density[SCENE_MEDIUM_LIMIT];
    double scattering = 0.0;

    for (int c = 0; c < 3; c++)
        sigma_t[c] = source[c] = 0.0;
    for (size_t m = 0; m < gatherer->media.count; m++) {
        const struct medium *medium = &gatherer->media.list[m];
        double own_source[3];

        density[m] = medium->density.at(medium->density.field, position);
        medium_source(medium, position, density[m], own_source);
        for (int c = 0; c < 3; c++) {
            sigma_t[c] += (medium->sigma_s[c] + medium->sigma_a[c]) * density[m];
            source[c] += own_source[c];
            scattering += medium->sigma_s[c] * density[m];
        }
    }
    if (scattering == 0.0 || is_dark(throughput)) return;
    for (size_t i = 0; i < still->light_count; i++)
        add_light(gatherer, &still->lights[i], position, density, throughput, source);
}

static struct cell_light light_of_cell(const struct gatherer *gatherer, struct cell cell,
                                       const double throughput[static 3])
{
    struct cell_light light = {0};
    double length = cell.end - cell.begin;
    double sigma_t[GAUSS_NODES][3], source[GAUSS_NODES][3];

    for (int i = 0; i < GAUSS_NODES; i++) {
        sample(gatherer, cell.begin + GAUSS_NODE[i] * length, throughput, sigma_t[i], source[i]);
    }
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < GAUSS_NODES; i++) {
            double depth_before = 0.0;

            for (int j = 0; j < GAUSS_NODES; j++)
                depth_before += GAUSS_PARTIAL[i][j] * sigma_t[j][c] * length;
            light.radiance[c] += GAUSS_WEIGHT[i] * source[i][c] * length * exp(-depth_before);
            light.optical_depth[c] += GAUSS_WEIGHT[i] * sigma_t[i][c] * length;
        }
    }
    return light;
}

static struct cell_light follow(const struct cell_light *first, const struct cell_light *second)
{
    struct cell_light both;

    for (int c = 0; c < 3; c++) {
        both.radiance[c] = first->radiance[c] + exp(-first->optical_depth[c]) * second->radiance[c];
        both.optical_depth[c] = first->optical_depth[c] + second->optical_depth[c];
    }
    return both;
}

// True when the change is within `slack` times the cell's share of the accuracy.
static bool agree(const struct gatherer *gatherer, const double throughput[static 3], const struct cell_light *a,
                  const struct cell_light *b, double slack)
{
    for (int c = 0; c < 3; c++) {
        if (throughput[c] > DARKNESS && b->optical_depth[c] > THICKEST_CELL) return false;
    }
    for (int c = 0; c < 3; c++) {
        double radiance_change = throughput[c] * fabs(a->radiance[c] - b->radiance[c]);
        double share_change = throughput[c] * fabs(exp(-a->optical_depth[c]) - exp(-b->optical_depth[c]));

        if (!(radiance_change <= slack * gatherer->radiance_tolerance[c])) return false;
        if (!(share_change <= slack * gatherer->share_tolerance)) return false;
    }
    return true;
}

// Halves the cell until two halvings in a row change little, and the second changes nothing that matters. One alone may
// agree by accident.
static struct cell_light refine(struct gatherer *gatherer, struct cell cell, const double throughput[static 3],
                                const struct cell_light *whole, bool agreed_before, int halvings_left)
{
    double middle = 0.5 * (cell.begin + cell.end);
    struct cell left = {cell.begin, middle}, right = {middle, cell.end};
    struct cell_light left_light = light_of_cell(gatherer, left, throughput);
    double throughput_right[3];
    struct cell_light right_light, halved;
    bool agrees;

    for (int c = 0; c < 3; c++)
        throughput_right[c] = throughput[c] * exp(-left_light.optical_depth[c]);
    right_light = light_of_cell(gatherer, right, throughput_right);
    halved = follow(&left_light, &right_light);
    if (agreed_before && agree(gatherer, throughput, whole, &halved, 1.0)) return halved;
    agrees = agree(gatherer, throughput, whole, &halved, LITTLE);
    if (halvings_left == 0) {
        gatherer->hit_limit = true;
        return halved;
    }
    left_light = refine(gatherer, left, throughput, &left_light, agrees, halvings_left - 1);
    for (int c = 0; c < 3; c++)
        throughput_right[c] = throughput[c] * exp(-left_light.optical_depth[c]);
    right_light = refine(gatherer, right, throughput_right, &right_light, agrees, halvings_left - 1);
    return follow(&left_light, &right_light);
}

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

// Finds spans whose ends lie where a medium's density, its glow, a light's distance or an object's shadow is not
// smooth.
static void find_spans(const struct gatherer *gatherer, double near, double far, struct span_list *spans)
{
    const struct still *still = gatherer->still;
    const struct ray *ray = gatherer->ray;

    for (size_t m = 0; m < gatherer->media.count; m++) {
        const struct medium *medium = &gatherer->media.list[m];
        struct span_list own = {0};

        medium->density.spans(medium->density.field, ray, near, far, &own);
        if (medium->glow.split) medium->glow.split(medium->glow.field, ray, &own);
        span_list_merge(spans, &own);
        span_list_finish(&own);
    }
    for (size_t i = 0; i < still->light_count; i++) {
        if (light_rules_of(still->lights[i].kind)->has_position) cut_at_light(spans, ray, still->lights[i].position);
        shadow_edges_split(&still->objects, &still->lights[i], ray, spans);
    }
}

// A first guess of a span's light.
struct expectation {
    struct cell_light rough; // as one cell
    double radiance[3];      // its part of the ray's radiance: a guess, then replaced by the integrated one
};

static struct cell_light gather(struct gatherer *gatherer, const struct span_list *spans, struct expectation *expected,
                                const double brightness[static 3], int halving_limit)
{
    struct cell_light total = {0};

    for (size_t i = 0; i < spans->count; i++) {
        double throughput[3];
        struct cell_light light;

        for (int c = 0; c < 3; c++) {
            throughput[c] = exp(-total.optical_depth[c]);
            // A third of the accuracy is divided equally, a third in proportion to the guesses; the last third is for
            // shadows.
            gatherer->radiance_tolerance[c] =
                gatherer->relative / 3.0 * (brightness[c] / (double)spans->count + expected[i].radiance[c]);
        }
        light = refine(gatherer, cell_of(&spans->spans[i]), throughput, &expected[i].rough, gatherer->is_loose,
                       halving_limit);
        for (int c = 0; c < 3; c++)
            expected[i].radiance[c] = throughput[c] * light.radiance[c];
        total = follow(&total, &light);
    }
    return total;
}

static struct cell_light expect(const struct gatherer *gatherer, const struct span_list *spans,
                                struct expectation *expected)
{
    struct cell_light total = {0};

    for (size_t i = 0; i < spans->count; i++) {
        double throughput[3];

        for (int c = 0; c < 3; c++)
            throughput[c] = exp(-total.optical_depth[c]);
        expected[i].rough = light_of_cell(gatherer, cell_of(&spans->spans[i]), throughput);
        for (int c = 0; c < 3; c++)
            expected[i].radiance[c] = throughput[c] * expected[i].rough.radiance[c];
        total = follow(&total, &expected[i].rough);
    }
    return total;
}

// Integrates again where the guess of the radiance was too bright, because the tolerance relative to it was too lax.
static struct cell_light gather_until_guess_holds(struct gatherer *gatherer, const struct span_list *spans,
                                                  double floor, int halving_limit)
{
    struct expectation *expected = xmalloc(spans->count * sizeof expected[0]);
    struct cell_light light = expect(gatherer, spans, expected);
    bool holds = false;

    gatherer->share_tolerance = gatherer->relative / (double)spans->count;
    while (!holds) {
        struct cell_light guess = light;
        double brightness[3];

        gatherer->hit_limit = false;
        for (int c = 0; c < 3; c++)
            brightness[c] = fmax(guess.radiance[c], floor);
        light = gather(gatherer, spans, expected, brightness, halving_limit);
        holds = true;
        for (int c = 0; c < 3; c++) {
            if (guess.radiance[c] > fmax(2.0 * light.radiance[c], floor)) holds = false;
        }
    }
    free(expected);
    return light;
}

struct integrate_result integrate_stretch(const struct still *still, const struct integrate_stretch *stretch,
                                          const struct integrate_accuracy *accuracy)
{
    double relative = accuracy && accuracy->relative > 0.0 ? accuracy->relative : DEFAULT_RELATIVE;
    double floor = accuracy && accuracy->floor > 0.0 ? accuracy->floor : DEFAULT_FLOOR;
    int limit = accuracy && accuracy->halving_limit > 0 ? accuracy->halving_limit : DEFAULT_HALVING_LIMIT;
    struct integrate_result result = {.transmittance = {1.0, 1.0, 1.0}, .is_converged = true};
    struct gatherer gatherer = {.still = still,
                                .ray = &stretch->ray,
                                .media = still_media(still, stretch->region),
                                .relative = relative,
                                .shadow_tolerance = 0.1 * relative,
                                .is_loose = relative >= INTEGRATE_LOOSE};
    struct span_list spans = {0};
    struct cell_light light;
    double far;

    far = transmittance_reach(gatherer.media.list, gatherer.media.count, &stretch->ray, stretch->near, stretch->far);
    find_spans(&gatherer, stretch->near, far, &spans);
    if (spans.count == 0) return result;
    if (gatherer.is_loose)
        gatherer.faint = FAINT * relative * floor / (spans.spans[spans.count - 1].end - spans.spans[0].begin);
    light = gather_until_guess_holds(&gatherer, &spans, floor, limit);
    for (int c = 0; c < 3; c++) {
        result.radiance[c] = light.radiance[c];
        result.transmittance[c] = exp(-light.optical_depth[c]);
    }
    result.is_converged = !gatherer.hit_limit;
    span_list_finish(&spans);
    return result;
}

struct integrate_result integrate_ray(const struct still *still, const struct ray *ray, double near, double far,
                                      const struct integrate_accuracy *accuracy)
{
    return integrate_stretch(still, &(struct integrate_stretch){.ray = *ray, .near = near, .far = far}, accuracy);
}
