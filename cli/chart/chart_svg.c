// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_svg.h"

#include "cli/chart/chart_axis.h"
#include "cli/chart/chart_ladder.h"
#include "cli/chart/chart_points.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// In units of the picture, which are pixels at its natural size.
enum {
    WIDTH = 920,
    HEIGHT = 560,
    LEFT = 84,
    RIGHT = 696,
    TOP = 64,
    BOTTOM = 458,
    LEGEND_X = 722,
    LEGEND_STEP = 23,
    MARKER_COUNT = 11,
    COLOR_COUNT = 12
};

// The lowest error that is drawn.
static const double LEAST_ERROR = 1e-7;

// Pairs of colours of one hue, for light and for dark ground.
static const char *const COLORS[COLOR_COUNT][2] = {
    {"#5f6368", "#b4b9bf"}, {"#0b66c3", "#62aef7"}, {"#c2410c", "#fb9a5b"}, {"#15803d", "#5fd38a"},
    {"#a21caf", "#e78bf0"}, {"#9a6700", "#e6bd4a"}, {"#b91c1c", "#ff8a8a"}, {"#0e7490", "#4fd0e4"},
    {"#4d5bce", "#a5b0ff"}, {"#be185d", "#ff8cc0"}, {"#4d7c0f", "#b3dc5a"}, {"#7c4a2d", "#d8a789"},
};

struct drawing {
    FILE *out;
    const struct chart_points *points;
    const struct chart_svg_mark *mark;
    struct chart_axis seconds, error;
};

static void put_text(FILE *out, const char *text)
{
    for (; *text; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        default:
            fputc((unsigned char)*text < 0x20 ? '?' : *text, out);
        }
    }
}

static double position_x(const struct drawing *drawing, double seconds)
{
    return LEFT + (RIGHT - LEFT) * chart_axis_position(&drawing->seconds, seconds);
}

static double position_y(const struct drawing *drawing, double error)
{
    return BOTTOM - (BOTTOM - TOP) * chart_axis_position(&drawing->error, fmax(error, LEAST_ERROR));
}

static bool is_drawn(const struct chart_point *point)
{
    return point->outcome == CHART_MEASURED && isfinite(point->error);
}

static void write_style(FILE *out)
{
    fputs("<style>\n"
          "svg{background:#fff;color:#1c1e21;font:13px system-ui,'Segoe UI','DejaVu Sans',sans-serif}\n"
          "text{fill:currentColor}.dim{fill:#5b6167}.grid{stroke:#dfe2e6;fill:none}.frame{stroke:#8a9097;fill:none}\n"
          ".front{stroke:#f2c94c;stroke-opacity:.55;stroke-width:11;fill:none;stroke-linecap:round;stroke-linejoin:"
          "round}\n"
          ".line{fill:none;stroke-width:1.8}.mark{stroke-width:1.8;fill:#fff}.best{fill:currentColor}\n"
          ".tolerance{stroke:#c2185b;stroke-dasharray:6 4;fill:none}.tolerance-text{fill:#c2185b}\n"
          ".star{fill:#f2a900;stroke:#1c1e21}\n",
          out);
    for (int i = 0; i < COLOR_COUNT; i++)
        fprintf(out, ".c%d{color:%s;stroke:%s}", i, COLORS[i][0], COLORS[i][0]);
    fputs("\n@media (prefers-color-scheme:dark){\n"
          "svg{background:#16181b;color:#e7e9ec}.dim{fill:#a3a9b0}.grid{stroke:#2f3338}.frame{stroke:#767d85}\n"
          ".front{stroke:#d9b23c;stroke-opacity:.4}.mark{fill:#16181b}.best{fill:currentColor}\n"
          ".tolerance{stroke:#ff7aa8}.tolerance-text{fill:#ff7aa8}.star{stroke:#fff}\n",
          out);
    for (int i = 0; i < COLOR_COUNT; i++)
        fprintf(out, ".c%d{color:%s;stroke:%s}", i, COLORS[i][1], COLORS[i][1]);
    fputs("\n}\n</style>\n", out);
}

static void write_star(FILE *out, double x, double y, const char *classes)
{
    fprintf(out, "<path class=\"%s\" d=\"M", classes);
    for (int i = 0; i < 10; i++) {
        double radius = i % 2 ? 4.0 : 9.5, angle = acos(-1.0) * i / 5.0;

        fprintf(out, "%s%.1f %.1f", i ? "L" : "", x + radius * sin(angle), y - radius * cos(angle));
    }
    fputs("Z\"/>\n", out);
}

static void write_marker(FILE *out, double x, double y, size_t series, bool is_best)
{
    static const char *const shapes[MARKER_COUNT] = {
        "m-4.5-4.5h9v9h-9Z",
        "m-4.6 0a4.6 4.6 0 1 0 9.2 0a4.6 4.6 0 1 0-9.2 0Z",
        "m0-5.6l5.4 9.4h-10.8Z",
        "m0-6l6 6l-6 6l-6-6Z",
        "m0 5.6l5.4-9.4h-10.8Z",
        "m-5.8-3.2h11.6v6.4h-11.6Z",
        "m-3-5.4h6l3 5.4l-3 5.4h-6l-3-5.4Z",
        "m-3.2-5.8h6.4v11.6h-6.4Z",
        "m-3.8-5.4v10.8l9.4-5.4Z",
        "m3.8-5.4v10.8l-9.4-5.4Z",
        "m0-6l5.7 4.1l-2.2 6.7h-7l-2.2-6.7Z",
    };

    fprintf(out, "<path class=\"mark c%zu%s\" d=\"M%.1f %.1f%s\"/>\n", series % COLOR_COUNT, is_best ? " best" : "", x,
            y, shapes[series % MARKER_COUNT]);
}

static void write_axes(const struct drawing *drawing)
{
    FILE *out = drawing->out;
    char label[CHART_LABEL_SIZE];

    for (int decade = drawing->seconds.first; decade <= drawing->seconds.last; decade++) {
        double x = position_x(drawing, pow(10, decade));

        chart_axis_format_seconds(pow(10, decade), label);
        fprintf(out,
                "<path class=\"grid\" d=\"M%.1f %dV%d\"/><text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s</text>\n",
                x, TOP, BOTTOM, x, BOTTOM + 20, label);
    }
    for (int decade = drawing->error.first; decade <= drawing->error.last; decade++) {
        double y = position_y(drawing, pow(10, decade));

        chart_axis_format_percent(pow(10, decade), label);
        fprintf(out,
                "<path class=\"grid\" d=\"M%d %.1fH%d\"/><text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%s</text>\n",
                LEFT, y, RIGHT, LEFT - 8, y + 4.5, label);
    }
    fprintf(out, "<rect class=\"frame\" x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/>\n", LEFT, TOP, RIGHT - LEFT,
            BOTTOM - TOP);
    fprintf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">seconds a frame</text>\n", (LEFT + RIGHT) / 2,
            BOTTOM + 42);
    fprintf(out,
            "<text transform=\"translate(20 %d) rotate(-90)\" text-anchor=\"middle\">error: relative RMSE</text>\n",
            (TOP + BOTTOM) / 2);
}

// Writes the indices of the measured points of a series, by rung; returns their count.
static size_t list_series(const struct chart_points *points, size_t series, size_t indices[CHART_RUNG_LIMIT])
{
    size_t count = 0;

    for (int rung = 0; rung < CHART_RUNG_LIMIT; rung++) {
        const struct chart_point *point = chart_points_find(points, chart_ladder_name(series), rung);

        if (point && is_drawn(point)) indices[count++] = (size_t)(point - points->list);
    }
    return count;
}

static void write_series(const struct drawing *drawing, size_t series)
{
    size_t indices[CHART_RUNG_LIMIT], count = list_series(drawing->points, series, indices);
    const struct chart_points *points = drawing->points;

    if (count > 1) fprintf(drawing->out, "<path class=\"line c%zu\" d=\"M", series % COLOR_COUNT);
    for (size_t i = 0; count > 1 && i < count; i++)
        fprintf(drawing->out, "%s%.1f %.1f", i ? "L" : "", position_x(drawing, points->list[indices[i]].seconds),
                position_y(drawing, points->list[indices[i]].error));
    if (count > 1) fputs("\"/>\n", drawing->out);
    for (size_t i = 0; i < count; i++)
        write_marker(drawing->out, position_x(drawing, points->list[indices[i]].seconds),
                     position_y(drawing, points->list[indices[i]].error), series,
                     chart_points_is_best(points, indices[i]));
}

static int compare_seconds(const void *left, const void *right)
{
    const struct chart_point *a = left, *b = right;

    return a->seconds < b->seconds ? -1 : a->seconds > b->seconds;
}

static void write_front(const struct drawing *drawing)
{
    const struct chart_points *points = drawing->points;
    struct chart_point *best = xcalloc(points->count + 1, sizeof *best); // its texts are borrowed
    size_t count = 0;

    for (size_t i = 0; i < points->count; i++)
        if (is_drawn(&points->list[i]) && chart_points_is_best(points, i)) best[count++] = points->list[i];
    qsort(best, count, sizeof *best, compare_seconds);
    if (count > 0) fputs("<path class=\"front\" d=\"M", drawing->out);
    for (size_t i = 0; i < count; i++)
        fprintf(drawing->out, "%s%.1f %.1f", i ? "L" : "", position_x(drawing, best[i].seconds),
                position_y(drawing, best[i].error));
    if (count > 0) fprintf(drawing->out, "%s\"/>\n", count == 1 ? "h.1" : "");
    free(best);
}

static void write_mark(const struct drawing *drawing)
{
    const struct chart_svg_mark *mark = drawing->mark;
    char label[CHART_LABEL_SIZE];
    double y;

    if (mark->tolerance > 0.0) {
        y = position_y(drawing, mark->tolerance);
        chart_axis_format_percent(mark->tolerance, label);
        fprintf(drawing->out, "<path class=\"tolerance\" d=\"M%d %.1fH%d\"/>\n", LEFT, y, RIGHT);
        fprintf(drawing->out,
                "<text class=\"tolerance-text\" x=\"%d\" y=\"%.1f\" text-anchor=\"end\">tolerance %s</text>\n",
                RIGHT - 6, y - 5, label);
    }
    if (mark->seconds > 0.0)
        write_star(drawing->out, position_x(drawing, mark->seconds), position_y(drawing, mark->error), "star");
}

static void write_legend_text(FILE *out, int line, const char *text)
{
    fprintf(out, "<text x=\"%d\" y=\"%.1f\">", LEGEND_X + 40, TOP + 14.5 + line * LEGEND_STEP);
    put_text(out, text);
    fputs("</text>\n", out);
}

static void write_legend(const struct drawing *drawing)
{
    FILE *out = drawing->out;
    int line = 0;

    for (size_t series = 0; series < chart_ladder_count(); series++) {
        size_t indices[CHART_RUNG_LIMIT];
        double y = TOP + 10 + line * LEGEND_STEP;

        if (list_series(drawing->points, series, indices) == 0) continue;
        fprintf(out, "<path class=\"line c%zu\" d=\"M%d %.1fh32\"/>\n", series % COLOR_COUNT, LEGEND_X, y);
        write_marker(out, LEGEND_X + 16, y, series, false);
        write_legend_text(out, line++, chart_ladder_name(series));
    }
    if (line == 0) return;
    fprintf(out, "<path class=\"front\" d=\"M%d %dh24\"/>\n", LEGEND_X + 4, TOP + 10 + line * LEGEND_STEP);
    write_legend_text(out, line++, "Pareto front");
    if (drawing->mark->seconds > 0.0) {
        write_star(out, LEGEND_X + 16, TOP + 10 + line * LEGEND_STEP, "star");
        write_legend_text(out, line++, "the planner's choice");
        if (drawing->mark->label) write_legend_text(out, line++, drawing->mark->label);
    }
}

static void write_title(const struct drawing *drawing)
{
    fprintf(drawing->out, "<text x=\"%d\" y=\"30\" style=\"font-size:18px;font-weight:600\">", LEFT);
    put_text(drawing->out, drawing->points->facts.name);
    fputs(": speed against accuracy</text>\n", drawing->out);
    fprintf(drawing->out, "<text class=\"dim\" x=\"%d\" y=\"50\">lower and farther left is better</text>\n", LEFT);
}

// Writes what the measured points have in common, taken from the first of them.
static void write_facts(const struct drawing *drawing)
{
    const struct chart_facts *facts = &drawing->points->facts;
    const struct chart_point *first = NULL;
    FILE *out = drawing->out;

    for (size_t i = 0; !first && i < drawing->points->count; i++)
        if (is_drawn(&drawing->points->list[i])) first = &drawing->points->list[i];
    fprintf(out, "<text class=\"dim\" x=\"%d\" y=\"%d\">frame %lld, %lld x %lld pixels, %s: ", LEFT, HEIGHT - 34,
            (long long)facts->frame, (long long)facts->width_px, (long long)facts->height_px, facts->backend);
    put_text(out, facts->renderer);
    fputs("</text>\n", out);
    if (!first) return;
    fprintf(out, "<text class=\"dim\" x=\"%d\" y=\"%d\">", LEFT, HEIGHT - 15);
    if (strcmp(first->truth, "reference") == 0)
        fprintf(out, "against the converged integral in %lld pixels", (long long)first->pixels);
    else
        fputs("against the finest midpoint march, for the reference has no GLSL densities", out);
    fprintf(out, "; %s time, warm, median</text>\n", strcmp(first->timer, "gpu") == 0 ? "GPU" : "wall-clock");
}

static void find_axes(struct drawing *drawing)
{
    for (size_t i = 0; i < drawing->points->count; i++) {
        if (!is_drawn(&drawing->points->list[i])) continue;
        chart_axis_add(&drawing->seconds, drawing->points->list[i].seconds);
        chart_axis_add(&drawing->error, fmax(drawing->points->list[i].error, LEAST_ERROR));
    }
    if (drawing->error.count == 0) return;
    chart_axis_add(&drawing->error, drawing->mark->tolerance);
    chart_axis_add(&drawing->seconds, drawing->mark->seconds);
    chart_axis_add(&drawing->error, drawing->mark->error);
}

static void write_plot(const struct drawing *drawing)
{
    if (drawing->error.count == 0) {
        fprintf(drawing->out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">nothing was measured</text>\n",
                (LEFT + RIGHT) / 2, (TOP + BOTTOM) / 2);
        return;
    }
    write_axes(drawing);
    write_front(drawing);
    for (size_t series = 0; series < chart_ladder_count(); series++)
        write_series(drawing, series);
    write_mark(drawing);
    write_legend(drawing);
}

char *chart_svg_format(const struct chart_points *points, const struct chart_svg_mark *mark)
{
    static const struct chart_svg_mark none = {0};
    struct drawing drawing = {.points = points, .mark = mark ? mark : &none};
    char *text = NULL;
    size_t size;

    drawing.out = open_memstream(&text, &size);
    if (!drawing.out) abort();
    find_axes(&drawing);
    fprintf(
        drawing.out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" role=\"img\">\n",
        WIDTH, HEIGHT, WIDTH, HEIGHT);
    fputs("<title>", drawing.out);
    put_text(drawing.out, points->facts.name);
    fputs(": seconds a frame against error, by method</title>\n", drawing.out);
    write_style(drawing.out);
    write_title(&drawing);
    write_plot(&drawing);
    write_facts(&drawing);
    fputs("</svg>\n", drawing.out);
    fclose(drawing.out);
    return text;
}

bool chart_svg_save(const struct chart_points *points, const struct chart_svg_mark *mark, const char *path,
                    struct error *error)
{
    char *text = chart_svg_format(points, mark);
    bool ok = file_write_atomic(path, text, strlen(text), error);

    if (!ok) error_prefix(error, "%s", path);
    free(text);
    return ok;
}
