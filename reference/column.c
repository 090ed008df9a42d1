// SPDX-License-Identifier: Apache-2.0
#include "reference/column.h"

#include "core/base/alloc.h"
#include "reference/kronrod.h"
#include "reference/refinement.h"

#include <math.h>
#include <stdlib.h>

enum { HALVING_LIMIT = 24, CELL_LIMIT = 1 << 16 };

// The part of the allowed error that stretches may have which are not looked at.
static const double ROUGH_PART = 0.3;

struct cell {
    double begin, end; // m along the ray
    const struct ray *ray;
    int halvings;   // of the span
    int node_count; // GAUSS_NODES or KRONROD_NODES
    double densities[KRONROD_NODES];
    double column, error;
};

// The cells of a column, in any order.
struct cells {
    const struct density *density;
    struct cell *list; // owned
    size_t count, capacity;
};

// Looks at the nodes from `first` to before `end`.
static void look(const struct cells *cells, struct cell *cell, int first, int end)
{
    const struct density *density = cells->density;
    struct vec3 positions[KRONROD_NODES];

    for (int i = first; i < end; i++)
        positions[i] = ray_at(cell->ray, cell->begin + kronrod_nodes[i] * (cell->end - cell->begin));
    if (density->at_image) {
        for (int i = first; i < end; i++)
            cell->densities[i] = density->at_image(density->field, positions[i]);
    } else {
        density_at_many(density, (size_t)(end - first), &positions[first], &cell->densities[first]);
    }
    cell->node_count = end;
    cell->column = kronrod_integrate(cell->densities, end, cell->end - cell->begin, &cell->error);
}

static struct cell *append(struct cells *cells)
{
    cells->list = xgrow(cells->list, &cells->capacity, cells->count + 1, sizeof cells->list[0]);
    return &cells->list[cells->count++];
}

// The second half is appended.
static void halve(struct cells *cells, size_t index)
{
    struct cell *second = append(cells), *first = &cells->list[index];
    double before = first->column;

    first->halvings++;
    *second = *first;
    first->end = second->begin = 0.5 * (first->begin + first->end);
    look(cells, first, 0, GAUSS_NODES);
    look(cells, second, 0, GAUSS_NODES);
    refinement_doubt(&first->error, &second->error, first->column + second->column - before);
}

static void refine(struct cells *cells, size_t index)
{
    struct cell *cell = &cells->list[index];

    if (cell->node_count < KRONROD_NODES) {
        look(cells, cell, GAUSS_NODES, KRONROD_NODES);
    } else if (cell->halvings == HALVING_LIMIT) {
        cell->error = 0.0;
    } else {
        halve(cells, index);
    }
}

static double allowed_error(const struct column_accuracy *accuracy, double column, double error)
{
    double light = exp(-accuracy->sigma_min * fmax(column - error, 0.0));

    if (accuracy->light == 0.0) return accuracy->error;
    if (light <= accuracy->light) return INFINITY;
    return fmax(accuracy->error, accuracy->light / (accuracy->sigma_max * light));
}

static double refine_enough(struct cells *cells, const struct column_accuracy *accuracy)
{
    for (;;) {
        struct refinement refinement = {&cells->list[0].error, sizeof cells->list[0], cells->count};
        double column = 0.0, error = refinement_error(&refinement), allowed, limit;

        for (size_t i = 0; i < cells->count; i++)
            column += cells->list[i].column;
        allowed = allowed_error(accuracy, column, error);
        if (!(error > allowed) || cells->count > CELL_LIMIT) return column;
        limit = refinement_limit(&refinement, allowed);
        for (size_t i = 0; i < refinement.count; i++)
            if (cells->list[i].error > limit) refine(cells, i);
    }
}

double column_integrate(const struct density *density, const struct ray *ray, double near, double far,
                        const struct column_accuracy *accuracy)
{
    struct cells cells = {.density = density};
    struct span_list spans = {0};
    double missed = accuracy->error, column = 0.0;

    if (density->column) return near < far ? density->column(density->field, ray, near, far) : 0.0;
    if (accuracy->light > 0.0) missed = fmax(missed, accuracy->light / accuracy->sigma_max);
    density_rough_spans(density, ray, near, far, ROUGH_PART * missed, &spans);
    for (size_t i = 0; i < spans.count; i++) {
        const struct span *span = &spans.spans[i];
        struct cell *cell = append(&cells);

        *cell = (struct cell){.begin = span->begin, .end = span->end, .ray = density->at_image ? &span->image : ray};
        look(&cells, cell, 0, GAUSS_NODES);
    }
    if (cells.count > 0) column = refine_enough(&cells, accuracy);
    free(cells.list);
    span_list_finish(&spans);
    return column;
}
