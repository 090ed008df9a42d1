// SPDX-License-Identifier: Apache-2.0
#include "reference/in_scattering.h"

#include "core/base/alloc.h"
#include "reference/light_walk.h"
#include "reference/refinement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELL_LIMIT = 1 << 16 };

// Parts of the allowed error: of the interpolation; of optical depths towards lights; of light from them that counts
// little; of light that is left out.
static const double INTERPOLATION_PART = 0.2, DEPTH_PART = 0.33, LIGHT_PART = 0.67, DARK_PART = 0.02;

// The share of the ray's unshadowed light that a cell has at most at first: a beam may pass between its nodes.
static const double LARGEST_SHARE = 1.0 / 8.0;

// A value for each medium and channel.
struct spectra {
    double of[SCENE_MEDIUM_LIMIT][3];
};

// A stretch of the ray with nodes between which the arriving light is interpolated.
struct cell {
    double begin, end;                   // m along the ray
    size_t first, count;                 // of the profile's cells
    int halvings, node_count;            // GAUSS_NODES or KRONROD_NODES
    struct spectra light[KRONROD_NODES]; // scattered at a node, per unit of density and sigma_s
    double radiance[3], radiance_error[3];
    double error; // relative to the ray's radiance
};

struct gatherer {
    const struct in_scattering_params *params;
    struct still_media media;
    struct cell *cells; // owned; in any order
    size_t count, capacity;
    double length;        // m, of all spans
    double brightness[3]; // the radiance as far as it is known, at least the floor
    double brightest[3];  // the largest for which one of the cells' values was found
    bool hit_limit;
};

// At `at`, the polynomial that is 1 at the node `own` and 0 at the others.
static double lagrange(const int *nodes, int count, int own, double at)
{
    double product = 1.0;

    for (int i = 0; i < count; i++) {
        if (nodes[i] == own) continue;
        product *= (at - kronrod_nodes[nodes[i]]) / (kronrod_nodes[own] - kronrod_nodes[nodes[i]]);
    }
    return product;
}

// Nodes of a cell and what the light at each of them is worth, for the polynomial through all of them.
struct interpolation {
    int nodes[KRONROD_NODES], count;
    struct spectra worth[KRONROD_NODES];
};

// Adds what a density at `at` (0 to 1 in the cell) is worth, which scatters so much of the light there.
static void spread(struct interpolation *interpolation, double at, const struct spectra *scattered, size_t medium_count)
{
    for (int n = 0; n < interpolation->count; n++) {
        int node = interpolation->nodes[n];
        double share = lagrange(interpolation->nodes, interpolation->count, node, at);

        for (size_t m = 0; m < medium_count; m++)
            for (int c = 0; c < 3; c++)
                interpolation->worth[node].of[m][c] += share * scattered->of[m][c];
    }
}

// The part of the light at a profile's node that reaches the camera.
static struct spectra scatter(const struct gatherer *gatherer, const struct profile_cell *crossed, int node)
{
    const struct still_media *media = &gatherer->media;
    double length = kronrod_weights(crossed->node_count)[node] * (crossed->end - crossed->begin);
    struct spectra scattered;

    for (int c = 0; c < 3; c++) {
        double weight = exp(-profile_depth(crossed, node, c)) * length;

        for (size_t m = 0; m < media->count; m++)
            scattered.of[m][c] = weight * media->list[m].sigma_s[c] * crossed->density[node][m];
    }
    return scattered;
}

static void weigh(const struct gatherer *gatherer, const struct cell *cell, struct interpolation *coarse,
                  struct interpolation *fine)
{
    for (size_t k = cell->first; k < cell->first + cell->count; k++) {
        const struct profile_cell *crossed = &gatherer->params->profile->cells[k];

        for (int i = 0; i < crossed->node_count; i++) {
            double at = (profile_distance(crossed, i) - cell->begin) / (cell->end - cell->begin);
            struct spectra scattered = scatter(gatherer, crossed, i);

            spread(coarse, at, &scattered, gatherer->media.count);
            spread(fine, at, &scattered, gatherer->media.count);
        }
    }
}

// The radiance that the light would bring to the node without shadows, relative to the ray's.
static double find_importance(const struct gatherer *gatherer, const struct spectra *worth,
                              const struct light_arrival *arrival, const double phase[static SCENE_MEDIUM_LIMIT])
{
    double importance = 0.0;

    for (int c = 0; c < 3; c++) {
        double radiance = 0.0;

        for (size_t m = 0; m < gatherer->media.count; m++)
            radiance += fabs(worth->of[m][c]) * phase[m] * arrival->irradiance[c];
        importance = fmax(importance, radiance / gatherer->brightness[c]);
    }
    return importance;
}

static void add_light(const struct gatherer *gatherer, struct cell *cell, int node, const struct spectra *worth,
                      const struct light *light)
{
    const struct in_scattering_params *params = gatherer->params;
    const struct ray *ray = params->profile->ray;
    struct vec3 position = ray_at(ray, cell->begin + kronrod_nodes[node] * (cell->end - cell->begin));
    struct light_arrival arrival = light_arrive(light, position);
    struct ray shadow = {position, vec3_scale(arrival.travel, -1.0)};
    double values = (double)cell->node_count * (double)params->still->light_count;
    // What this value may have of the ray's allowed error.
    double allowed = params->relative * (cell->end - cell->begin) / gatherer->length / values;
    double phase[SCENE_MEDIUM_LIMIT], share[3], importance;

    // The scattered light travels against the camera's ray.
    for (size_t m = 0; m < gatherer->media.count; m++)
        phase[m] = medium_phase(&gatherer->media.list[m], -vec3_dot(arrival.travel, ray->direction));
    importance = find_importance(gatherer, worth, &arrival, phase);
    if (importance <= DARK_PART * allowed) return;
    light_walk(params->still, &shadow, arrival.distance,
               &(struct transmittance_accuracy){.optical_depth = DEPTH_PART * params->relative,
                                                .light = LIGHT_PART * allowed / importance},
               share);
    for (size_t m = 0; m < gatherer->media.count; m++)
        for (int c = 0; c < 3; c++)
            cell->light[node].of[m][c] += phase[m] * share[c] * arrival.irradiance[c];
}

static double sum(const struct gatherer *gatherer, const struct cell *cell, const struct interpolation *interpolation,
                  int channel)
{
    double radiance = 0.0;

    for (int n = 0; n < interpolation->count; n++) {
        int node = interpolation->nodes[n];

        for (size_t m = 0; m < gatherer->media.count; m++)
            radiance += interpolation->worth[node].of[m][channel] * cell->light[node].of[m][channel];
    }
    return radiance;
}

// Looks at the nodes from `first` to before `end`. The error is the difference to an interpolation through fewer nodes:
// through Gauss' alone, through the outer two of these.
static void look(const struct gatherer *gatherer, struct cell *cell, int first, int end)
{
    struct interpolation coarse = {.nodes = {0, 2}, .count = 2};
    struct interpolation fine = {.nodes = {0, 1, 2, 3, 4, 5, 6}, .count = end};

    if (end == KRONROD_NODES) coarse = (struct interpolation){.nodes = {0, 1, 2}, .count = GAUSS_NODES};
    cell->node_count = end;
    weigh(gatherer, cell, &coarse, &fine);
    for (int i = first; i < end; i++) {
        memset(&cell->light[i], 0, sizeof cell->light[i]);
        for (size_t k = 0; k < gatherer->params->still->light_count; k++)
            add_light(gatherer, cell, i, &fine.worth[i], &gatherer->params->still->lights[k]);
    }
    for (int c = 0; c < 3; c++) {
        cell->radiance[c] = sum(gatherer, cell, &fine, c);
        cell->radiance_error[c] = fabs(cell->radiance[c] - sum(gatherer, cell, &coarse, c));
        if (end == GAUSS_NODES)
            cell->radiance_error[c] = fmax(cell->radiance_error[c], GAUSS_LEAST_ERROR * fabs(cell->radiance[c]));
    }
}

static struct cell *append(struct gatherer *gatherer)
{
    gatherer->cells = xgrow(gatherer->cells, &gatherer->capacity, gatherer->count + 1, sizeof gatherer->cells[0]);
    return &gatherer->cells[gatherer->count++];
}

// Halves a cell without looking at it; the second half is appended. The profile's cells are halves of the same spans,
// so none of several reaches over the middle.
static struct cell *divide(struct gatherer *gatherer, size_t index)
{
    struct profile *profile = gatherer->params->profile;
    struct cell *second = append(gatherer), *first = &gatherer->cells[index];

    first->halvings++;
    *second = *first;
    first->end = second->begin = 0.5 * (first->begin + first->end);
    if (first->count == 1) {
        profile_halve(profile, first->first);
        second->first = profile->count - 1;
    } else {
        while (profile->cells[second->first].begin < second->begin)
            second->first++;
        first->count = second->first - first->first;
        second->count -= first->count;
    }
    return second;
}

static void halve(struct gatherer *gatherer, size_t index)
{
    struct cell *second = divide(gatherer, index), *first = &gatherer->cells[index];
    double before[3];

    memcpy(before, first->radiance, sizeof before);
    look(gatherer, first, 0, GAUSS_NODES);
    look(gatherer, second, 0, GAUSS_NODES);
    for (int c = 0; c < 3; c++)
        refinement_doubt(&first->radiance_error[c], &second->radiance_error[c],
                         first->radiance[c] + second->radiance[c] - before[c]);
}

static void refine(struct gatherer *gatherer, size_t index)
{
    struct cell *cell = &gatherer->cells[index];

    if (cell->node_count == KRONROD_NODES) {
        halve(gatherer, index);
        return;
    }
    if (cell->count == 1) profile_extend(gatherer->params->profile, cell->first);
    look(gatherer, cell, GAUSS_NODES, KRONROD_NODES);
}

static double error_of(const struct gatherer *gatherer, const struct cell *cell)
{
    double error = 0.0;

    for (int c = 0; c < 3; c++)
        error = fmax(error, cell->radiance_error[c] / gatherer->brightness[c]);
    return error;
}

static void find_errors(struct gatherer *gatherer)
{
    gatherer->hit_limit = false;
    for (size_t i = 0; i < gatherer->count; i++) {
        struct cell *cell = &gatherer->cells[i];

        cell->error = error_of(gatherer, cell);
        if (cell->error == 0.0 || cell->halvings < gatherer->params->halving_limit || cell->node_count < KRONROD_NODES)
            continue;
        cell->error = 0.0;
        gatherer->hit_limit = true;
    }
}

// Sets the brightness to that of the emitted light and the cells.
static void add_up(struct gatherer *gatherer, const double emitted[static 3], double radiance[static 3])
{
    for (int c = 0; c < 3; c++) {
        radiance[c] = emitted[c];
        for (size_t i = 0; i < gatherer->count; i++)
            radiance[c] += gatherer->cells[i].radiance[c];
        gatherer->brightness[c] = fmax(radiance[c], gatherer->params->floor);
        gatherer->brightest[c] = fmax(gatherer->brightest[c], gatherer->brightness[c]);
    }
}

static void refine_enough(struct gatherer *gatherer, const double emitted[static 3], double radiance[static 3])
{
    double allowed = INTERPOLATION_PART * gatherer->params->relative, limit;

    for (;;) {
        struct refinement refinement = {&gatherer->cells[0].error, sizeof gatherer->cells[0], gatherer->count};

        add_up(gatherer, emitted, radiance);
        find_errors(gatherer);
        if (!(refinement_error(&refinement) > allowed)) return;
        if (gatherer->count > CELL_LIMIT) {
            gatherer->hit_limit = true;
            return;
        }
        limit = refinement_limit(&refinement, allowed);
        for (size_t i = 0; i < refinement.count; i++)
            if (gatherer->cells[i].error > limit) refine(gatherer, i);
    }
}

static bool is_thick(const struct gatherer *gatherer, const struct cell *cell)
{
    const struct profile_cell *first = &gatherer->params->profile->cells[cell->first];
    const struct profile_cell *last = first + cell->count - 1;

    for (int c = 0; c < 3; c++) {
        double depth = last->depth_before[c] + last->optical_depth[c] - first->depth_before[c];

        if (depth > PROFILE_THICKEST) return true;
    }
    return false;
}

// The radiance of a cell if there were no shadows.
static void find_unshadowed(const struct gatherer *gatherer, const struct cell *cell, double radiance[static 3])
{
    const struct in_scattering_params *params = gatherer->params;
    const struct ray *ray = params->profile->ray;

    for (int c = 0; c < 3; c++)
        radiance[c] = 0.0;
    for (size_t k = cell->first; k < cell->first + cell->count; k++) {
        const struct profile_cell *crossed = &params->profile->cells[k];

        for (int i = 0; i < crossed->node_count; i++) {
            struct spectra scattered = scatter(gatherer, crossed, i);

            for (size_t l = 0; l < params->still->light_count; l++) {
                struct light_arrival arrival =
                    light_arrive(&params->still->lights[l], ray_at(ray, profile_distance(crossed, i)));

                for (size_t m = 0; m < gatherer->media.count; m++) {
                    double phase = medium_phase(&gatherer->media.list[m], -vec3_dot(arrival.travel, ray->direction));

                    for (int c = 0; c < 3; c++)
                        radiance[c] += scattered.of[m][c] * phase * arrival.irradiance[c];
                }
            }
        }
    }
}

// True when too much light could be missed between the cell's nodes.
static bool is_sparse(const struct gatherer *gatherer, const struct cell *cell, const double total[static 3])
{
    double own[3];

    find_unshadowed(gatherer, cell, own);
    for (int c = 0; c < 3; c++) {
        double least = gatherer->params->relative * gatherer->brightness[c];

        if (own[c] > fmax(LARGEST_SHARE * total[c], least)) return true;
    }
    return false;
}

static void divide_sparse(struct gatherer *gatherer)
{
    double total[3] = {0.0};

    for (size_t i = 0; i < gatherer->count; i++) {
        double own[3];

        find_unshadowed(gatherer, &gatherer->cells[i], own);
        for (int c = 0; c < 3; c++)
            total[c] += own[c];
    }
    for (size_t i = 0; i < gatherer->count; i++) {
        while (gatherer->cells[i].halvings < gatherer->params->halving_limit &&
               is_sparse(gatherer, &gatherer->cells[i], total))
            divide(gatherer, i);
    }
}

// Begins with a cell for each span, halved where it is thick. Dark ones are left out.
static void append_cells(struct gatherer *gatherer)
{
    const struct in_scattering_params *params = gatherer->params;
    const struct profile *profile = params->profile;

    for (size_t i = 0, first = 0, next; i < params->spans->count; i++, first = next) {
        const struct span *span = &params->spans->spans[i];

        next = first;
        while (next < profile->count && profile->cells[next].begin < span->end)
            next++;
        gatherer->length += span->end - span->begin;
        if (profile_is_dark(profile->cells[first].depth_before)) continue;
        *append(gatherer) =
            (struct cell){.begin = span->begin, .end = span->end, .first = first, .count = next - first};
    }
    for (size_t i = 0; i < gatherer->count; i++) {
        while (gatherer->cells[i].count > 1 && is_thick(gatherer, &gatherer->cells[i]))
            divide(gatherer, i);
    }
}

static void look_at_all(struct gatherer *gatherer, const double emitted[static 3])
{
    double known[3] = {emitted[0], emitted[1], emitted[2]};

    for (size_t i = 0; i < gatherer->count; i++) {
        struct cell *cell = &gatherer->cells[i];

        // Nodes that cells have already keep a first look from being too bright again.
        look(gatherer, cell, 0, cell->node_count > 0 ? cell->node_count : GAUSS_NODES);
        for (int c = 0; c < 3; c++) {
            known[c] += cell->radiance[c];
            gatherer->brightness[c] = fmax(gatherer->brightness[c], known[c]);
        }
    }
}

// True when a value was found for so bright a ray that it may not be exact enough, or may be left out.
static bool was_too_bright(const struct gatherer *gatherer)
{
    for (int c = 0; c < 3; c++) {
        if (gatherer->brightest[c] > 2.0 * gatherer->brightness[c]) return true;
    }
    return false;
}

bool in_scattering_add(const struct in_scattering_params *params, double radiance[static 3])
{
    struct gatherer gatherer = {.params = params, .media = params->profile->media};
    const double emitted[3] = {radiance[0], radiance[1], radiance[2]};

    for (int c = 0; c < 3; c++)
        gatherer.brightness[c] = fmax(emitted[c], params->floor);
    append_cells(&gatherer);
    divide_sparse(&gatherer);
    do {
        memcpy(gatherer.brightest, gatherer.brightness, sizeof gatherer.brightest);
        look_at_all(&gatherer, emitted);
        if (gatherer.count > 0) refine_enough(&gatherer, emitted, radiance);
    } while (was_too_bright(&gatherer));
    free(gatherer.cells);
    return !gatherer.hit_limit;
}
