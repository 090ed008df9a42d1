// SPDX-License-Identifier: Apache-2.0
#include "reference/profile.h"

#include "core/base/alloc.h"
#include "reference/refinement.h"

#include <math.h>
#include <stdlib.h>

enum { CELL_LIMIT = 1 << 16 };

static const double DARK_DEPTH = 30.0;

bool profile_is_dark(const double optical_depth[static 3])
{
    return fmin(fmin(optical_depth[0], optical_depth[1]), optical_depth[2]) > DARK_DEPTH;
}

double profile_distance(const struct profile_cell *cell, int node)
{
    return cell->begin + kronrod_nodes[node] * (cell->end - cell->begin);
}

static double depth_within(const struct profile_cell *cell, int node, int channel)
{
    const double *weights = kronrod_partial_weights(cell->node_count, node);
    double sum = 0.0;

    for (int i = 0; i < cell->node_count; i++)
        sum += weights[i] * cell->sigma_t[i][channel];
    return sum * (cell->end - cell->begin);
}

double profile_depth(const struct profile_cell *cell, int node, int channel)
{
    return cell->depth_before[channel] + depth_within(cell, node, channel);
}

static void sample(const struct profile *profile, struct profile_cell *cell, int first, int end)
{
    struct vec3 positions[KRONROD_NODES];

    for (int i = first; i < end; i++) {
        positions[i] = ray_at(profile->ray, profile_distance(cell, i));
        for (int c = 0; c < 3; c++)
            cell->sigma_t[i][c] = cell->emission[i][c] = 0.0;
    }
    for (size_t m = 0; m < profile->media.count; m++) {
        const struct medium *medium = &profile->media.list[m];
        double densities[KRONROD_NODES];

        density_at_many(&medium->density, (size_t)(end - first), &positions[first], &densities[first]);
        for (int i = first; i < end; i++) {
            double source[3];

            medium_source(medium, positions[i], densities[i], source);
            cell->density[i][m] = densities[i];
            for (int c = 0; c < 3; c++) {
                cell->sigma_t[i][c] += (medium->sigma_s[c] + medium->sigma_a[c]) * densities[i];
                cell->emission[i][c] += source[c];
            }
        }
    }
}

// Looks at the nodes from `first` to before `end`.
static void look(const struct profile *profile, struct profile_cell *cell, int first, int end)
{
    double length = cell->end - cell->begin;

    sample(profile, cell, first, end);
    cell->node_count = end;
    for (int c = 0; c < 3; c++) {
        double sigma_t[KRONROD_NODES], light[KRONROD_NODES];

        for (int i = 0; i < end; i++) {
            sigma_t[i] = cell->sigma_t[i][c];
            light[i] = cell->emission[i][c];
            if (light[i] > 0.0) light[i] *= exp(-depth_within(cell, i, c));
        }
        cell->optical_depth[c] = kronrod_integrate(sigma_t, end, length, &cell->depth_error[c]);
        cell->emitted[c] = kronrod_integrate(light, end, length, &cell->emitted_error[c]);
    }
}

static struct profile_cell *append(struct profile *profile)
{
    profile->cells = xgrow(profile->cells, &profile->capacity, profile->count + 1, sizeof profile->cells[0]);
    return &profile->cells[profile->count++];
}

void profile_extend(struct profile *profile, size_t index)
{
    struct profile_cell *cell = &profile->cells[index];

    if (cell->node_count < KRONROD_NODES) look(profile, cell, GAUSS_NODES, KRONROD_NODES);
}

void profile_halve(struct profile *profile, size_t index)
{
    struct profile_cell *second = append(profile), *first = &profile->cells[index], before = *first;

    first->halvings++;
    *second = *first;
    first->end = second->begin = 0.5 * (first->begin + first->end);
    look(profile, first, 0, GAUSS_NODES);
    look(profile, second, 0, GAUSS_NODES);
    for (int c = 0; c < 3; c++) {
        double depth = first->optical_depth[c] + second->optical_depth[c];
        double emitted = first->emitted[c] + exp(-first->optical_depth[c]) * second->emitted[c];

        second->depth_before[c] = first->depth_before[c] + first->optical_depth[c];
        refinement_doubt(&first->depth_error[c], &second->depth_error[c], depth - before.optical_depth[c]);
        refinement_doubt(&first->emitted_error[c], &second->emitted_error[c], emitted - before.emitted[c]);
    }
}

static int compare_begins(const void *a, const void *b)
{
    double first = ((const struct profile_cell *)a)->begin, second = ((const struct profile_cell *)b)->begin;

    return (first > second) - (first < second);
}

static void add_up(struct profile *profile)
{
    for (int c = 0; c < 3; c++)
        profile->optical_depth[c] = profile->emitted[c] = 0.0;
    for (size_t i = 0; i < profile->count; i++) {
        struct profile_cell *cell = &profile->cells[i];

        for (int c = 0; c < 3; c++) {
            cell->depth_before[c] = profile->optical_depth[c];
            profile->emitted[c] += exp(-cell->depth_before[c]) * cell->emitted[c];
            profile->optical_depth[c] += cell->optical_depth[c];
        }
    }
}

static double error_of(const struct profile *profile, const struct profile_cell *cell, double floor)
{
    double error = 0.0;

    if (profile_is_dark(cell->depth_before)) return 0.0;
    for (int c = 0; c < 3; c++) {
        double throughput = exp(-cell->depth_before[c]), opacity = -expm1(-profile->optical_depth[c]);

        if (cell->depth_before[c] <= DARK_DEPTH && cell->optical_depth[c] > PROFILE_THICKEST) return INFINITY;
        if (cell->depth_error[c] > 0.0) error = fmax(error, cell->depth_error[c] * fmax(1.0, throughput / opacity));
        error = fmax(error, throughput * cell->emitted_error[c] / fmax(profile->emitted[c], floor));
    }
    return error;
}

static void find_errors(struct profile *profile, const struct profile_accuracy *accuracy)
{
    profile->hit_limit = false;
    for (size_t i = 0; i < profile->count; i++) {
        struct profile_cell *cell = &profile->cells[i];

        cell->error = error_of(profile, cell, accuracy->floor);
        if (cell->error == 0.0 || cell->halvings < accuracy->halving_limit || cell->node_count < KRONROD_NODES)
            continue;
        cell->error = 0.0;
        profile->hit_limit = true;
    }
}

static void refine_enough(struct profile *profile, const struct profile_accuracy *accuracy)
{
    for (;;) {
        struct refinement refinement = {&profile->cells[0].error, sizeof profile->cells[0], profile->count};
        double limit;

        add_up(profile);
        find_errors(profile, accuracy);
        if (!(refinement_error(&refinement) > accuracy->relative)) return;
        if (profile->count > CELL_LIMIT) {
            profile->hit_limit = true;
            return;
        }
        limit = refinement_limit(&refinement, accuracy->relative);
        for (size_t i = 0; i < refinement.count; i++) {
            if (!(profile->cells[i].error > limit)) continue;
            if (profile->cells[i].node_count < KRONROD_NODES) {
                profile_extend(profile, i);
            } else {
                profile_halve(profile, i);
            }
        }
        qsort(profile->cells, profile->count, sizeof profile->cells[0], compare_begins);
    }
}

void profile_init(struct profile *profile, const struct ray *ray, struct still_media media,
                  const struct span_list *spans, const struct profile_accuracy *accuracy)
{
    *profile = (struct profile){.ray = ray, .media = media};
    for (size_t i = 0; i < spans->count; i++) {
        struct profile_cell *cell = append(profile);

        *cell = (struct profile_cell){.begin = spans->spans[i].begin, .end = spans->spans[i].end};
        look(profile, cell, 0, GAUSS_NODES);
    }
    if (profile->count > 0) refine_enough(profile, accuracy);
}

void profile_finish(struct profile *profile)
{
    free(profile->cells);
    *profile = (struct profile){0};
}
