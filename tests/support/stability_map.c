// SPDX-License-Identifier: Apache-2.0
#include "tests/support/stability_map.h"

#include "tests/support/stability.h"
#include "tests/support/svg_map.h"
#include "worker/gl/gl_context.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Up to which error a point is good, and by how much light may grow.
static const double GOOD = 1e-2, FAIR = 0.1, GAIN = 1e-2;

enum mark { MARK_GOOD, MARK_FAIR, MARK_BAD, MARK_REFUSED };

static enum mark mark_of(const struct stability_point *point)
{
    if (point->is_refused) return MARK_REFUSED;
    if (!point->is_finite || point->error > FAIR || point->gain > FAIR) return MARK_BAD;
    return point->error <= GOOD && point->gain <= GAIN ? MARK_GOOD : MARK_FAIR;
}

static void print_points(const struct stability_sweep *sweep, const struct stability_method *method,
                         const struct stability_point *points)
{
    printf("%-10s %-12s", sweep->slug, method->name);
    for (size_t i = 0; i < sweep->count; i++) {
        if (points[i].is_refused)
            printf("  %9s", "refused");
        else if (!points[i].is_finite)
            printf("  %9s", "infinite");
        else
            printf("  %9.1e", points[i].error);
    }
    printf("\n%-23s", "   light gained");
    for (size_t i = 0; i < sweep->count; i++)
        printf("  %+9.1e", points[i].gain);
    printf("\n");
    for (size_t i = 0; i < sweep->count; i++)
        if (points[i].is_refused) printf("   at %g: %s\n", sweep->values[i], points[i].reason);
}

// "0.001 to 10 good, 100 fair": stretches of like marks.
static void print_stretches(const struct stability_sweep *sweep, const struct stability_point *points)
{
    static const char *const names[] = {"good", "**fair**", "**bad**", "refused"};

    for (size_t i = 0; i < sweep->count;) {
        enum mark mark = mark_of(&points[i]);
        size_t end = i + 1;
        double worst = points[i].error;

        while (end < sweep->count && mark_of(&points[end]) == mark)
            worst = fmax(worst, points[end++].error);
        if (i == 0 && end == sweep->count)
            printf("%s", names[mark]);
        else if (end == i + 1)
            printf("%s%s at %g", i > 0 ? ", " : "", names[mark], sweep->values[i]);
        else
            printf("%s%s from %g to %g", i > 0 ? ", " : "", names[mark], sweep->values[i], sweep->values[end - 1]);
        if (mark != MARK_REFUSED) printf(" (%.0e)", worst);
        i = end;
    }
}

enum { CELL_WIDTH = 46, CELL_HEIGHT = 18, LEFT = 104, TITLE_HEIGHT = 22 };

// Methods before `end` that have to do with a sweep.
static int count_rows(const struct stability_sweep *sweep, size_t end)
{
    int count = 0;

    for (size_t k = 0; k < end; k++)
        count += stability_concerns(sweep, &stability_methods[k]);
    return count;
}

// Where a sweep's part of the picture begins.
static int find_top(size_t sweep_index)
{
    int top = 26;

    for (size_t i = 0; i < sweep_index; i++)
        top += TITLE_HEIGHT + CELL_HEIGHT * (count_rows(&stability_sweeps[i], stability_method_count) + 1) + 14;
    return top;
}

static void begin_svg(void)
{
    int width = LEFT + CELL_WIDTH * 9 + 10, height = find_top(stability_sweep_count) + 4;

    svg_map_begin(width, height);
    printf("<text x=\"8\" y=\"16\">error up to %g is good, up to %g fair, more is bad; so is light made, and refused "
           "is said why</text>\n",
           GOOD, FAIR);
}

static void draw_row(size_t sweep_index, size_t method_index, const struct stability_point *points)
{
    static const char *const classes[] = {"good", "fair", "bad", "refused"};
    const struct stability_sweep *sweep = &stability_sweeps[sweep_index];
    int top = find_top(sweep_index) + TITLE_HEIGHT;
    int y = top + CELL_HEIGHT * (count_rows(sweep, method_index) + 1);

    if (count_rows(sweep, method_index) == 0) {
        printf("<text class=\"title\" x=\"8\" y=\"%d\">%s</text>\n", top - 6, sweep->name);
        for (size_t i = 0; i < sweep->count; i++)
            printf("<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%g</text>\n",
                   LEFT + CELL_WIDTH * (int)i + CELL_WIDTH / 2, top + 12, sweep->values[i]);
    }
    printf("<text x=\"8\" y=\"%d\">%s</text>\n", y + 13, stability_methods[method_index].name);
    for (size_t i = 0; i < sweep->count; i++) {
        int x = LEFT + CELL_WIDTH * (int)i;

        printf("<rect class=\"%s\" x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/>", classes[mark_of(&points[i])], x + 1,
               y + 1, CELL_WIDTH - 2, CELL_HEIGHT - 2);
        if (!points[i].is_refused)
            printf("<text class=\"cell\" x=\"%d\" y=\"%d\" text-anchor=\"middle\">%.0e</text>", x + CELL_WIDTH / 2,
                   y + 13, points[i].error);
        printf("\n");
    }
}

static void begin_table(void)
{
    printf("| |");
    for (size_t k = 0; k < stability_method_count; k++)
        printf(" `%s` |", stability_methods[k].name);
    printf("\n|---|");
    for (size_t k = 0; k < stability_method_count; k++)
        printf("---|");
    printf("\n");
}

static bool print_sweep(struct gl_context *context, size_t index, const char *form)
{
    const struct stability_sweep *sweep = &stability_sweeps[index];
    bool is_map = strcmp(form, "map") == 0, is_svg = strcmp(form, "svg") == 0;

    if (is_map) printf("| %s |", sweep->name);
    for (size_t k = 0; k < stability_method_count; k++) {
        struct stability_point points[STABILITY_POINT_LIMIT];

        if (!stability_concerns(sweep, &stability_methods[k])) {
            if (is_map) printf(" |");
            continue;
        }
        if (!stability_measure(context, sweep, &stability_methods[k], points)) return false;
        if (is_svg) {
            draw_row(index, k, points);
        } else if (is_map) {
            printf(" ");
            print_stretches(sweep, points);
            printf(" |");
        } else {
            print_points(sweep, &stability_methods[k], points);
        }
    }
    if (is_map) printf("\n");
    return true;
}

bool stability_map_print(struct gl_context *context, const char *form, const char *slug)
{
    bool ok = true;

    if (strcmp(form, "svg") == 0) begin_svg();
    if (strcmp(form, "map") == 0) begin_table();
    for (size_t i = 0; ok && i < stability_sweep_count; i++)
        if (!slug || strcmp(slug, stability_sweeps[i].slug) == 0) ok = print_sweep(context, i, form);
    if (strcmp(form, "svg") == 0) printf("</svg>\n");
    return ok;
}
