// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_csv.h"

#include "cli/chart/chart_points.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SIZE_LIMIT = 16 * 1024 * 1024 };

enum column {
    COLUMN_NAME,
    COLUMN_SCENE,
    COLUMN_FRAME,
    COLUMN_WIDTH,
    COLUMN_HEIGHT,
    COLUMN_BACKEND,
    COLUMN_RENDERER,
    COLUMN_SERIES,
    COLUMN_RUNG,
    COLUMN_QUALITY,
    COLUMN_OUTCOME,
    COLUMN_SECONDS,
    COLUMN_REPEATS,
    COLUMN_TIMER,
    COLUMN_ERROR,
    COLUMN_LARGEST,
    COLUMN_TRUTH,
    COLUMN_PIXELS,
    COLUMN_REASON,
    COLUMN_COUNT
};

static const char TITLES[] = "name,scene,frame,width_px,height_px,backend,renderer,series,rung,quality,outcome,seconds,"
                             "repeats,timer,relative_rmse,largest_error,truth,pixels,reason\r\n";
static const char *const OUTCOMES[] = {"measured", "refused", "too slow"};

static void put_text(FILE *out, const char *text)
{
    if (!text[strcspn(text, ",\"\r\n")]) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"') fputc('"', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

static void put_line(FILE *out, const struct chart_facts *facts, const struct chart_point *point)
{
    put_text(out, facts->name);
    fprintf(out, ",%s,%lld,%lld,%lld,", facts->scene, (long long)facts->frame, (long long)facts->width_px,
            (long long)facts->height_px);
    put_text(out, facts->backend);
    fputc(',', out);
    put_text(out, facts->renderer);
    fprintf(out, ",%s,%d,", point->series, point->rung);
    put_text(out, point->quality);
    fprintf(out, ",%s,%.6g,%lld,%s,%.6g,%.6g,%s,%lld,", OUTCOMES[point->outcome], point->seconds,
            (long long)point->repeats, point->timer, point->error, point->largest_error, point->truth,
            (long long)point->pixels);
    put_text(out, point->reason);
    fputs("\r\n", out);
}

bool chart_csv_save(const struct chart_points *points, const char *path, struct error *error)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    bool ok;

    if (!out) abort();
    fputs(TITLES, out);
    for (size_t i = 0; i < points->count; i++)
        put_line(out, &points->facts, &points->list[i]);
    fclose(out);
    ok = file_write_atomic(path, text, size, error);
    if (!ok) error_prefix(error, "%s", path);
    free(text);
    return ok;
}

// Cuts a field out of `*at` and moves `*at` behind it; `*is_last` says whether it ends the line. NULL where the text is
// no CSV.
static char *take_field(char **at, bool *is_last)
{
    char *from = *at, *field = from, *to = from;
    bool is_quoted = *from == '"';

    if (is_quoted) {
        for (from++; *from && (*from != '"' || from[1] == '"'); from++) {
            if (*from == '"') from++;
            *to++ = *from;
        }
        if (*from++ != '"') return NULL;
    } else {
        from += strcspn(from, ",\r\n");
        to = from;
    }
    *is_last = *from != ',';
    *at = from + 1;
    if (*from == '\r') ++*at;
    if (*is_last && (*at)[-1] != '\n') return NULL;
    *to = 0;
    return field;
}

static bool take_line(char **at, char *fields[COLUMN_COUNT])
{
    for (int i = 0; i < COLUMN_COUNT; i++) {
        bool is_last = false;

        fields[i] = take_field(at, &is_last);
        if (!fields[i] || is_last != (i == COLUMN_COUNT - 1)) return false;
    }
    return true;
}

static bool is_same(const struct chart_facts *facts, char *const fields[COLUMN_COUNT])
{
    return strcmp(fields[COLUMN_NAME], facts->name) == 0 && strcmp(fields[COLUMN_SCENE], facts->scene) == 0 &&
           strtoll(fields[COLUMN_FRAME], NULL, 10) == facts->frame &&
           strtoll(fields[COLUMN_WIDTH], NULL, 10) == facts->width_px &&
           strtoll(fields[COLUMN_HEIGHT], NULL, 10) == facts->height_px &&
           strcmp(fields[COLUMN_BACKEND], facts->backend) == 0 && strcmp(fields[COLUMN_RENDERER], facts->renderer) == 0;
}

static bool read_point(struct chart_point *point, char *const fields[COLUMN_COUNT])
{
    enum { OUTCOME_COUNT = sizeof OUTCOMES / sizeof *OUTCOMES };
    int outcome = 0;

    while (outcome < OUTCOME_COUNT && strcmp(fields[COLUMN_OUTCOME], OUTCOMES[outcome]) != 0)
        outcome++;
    if (outcome == OUTCOME_COUNT) return false;
    *point = (struct chart_point){.outcome = (enum chart_outcome)outcome,
                                  .rung = (int)strtol(fields[COLUMN_RUNG], NULL, 10),
                                  .seconds = strtod(fields[COLUMN_SECONDS], NULL),
                                  .repeats = strtoll(fields[COLUMN_REPEATS], NULL, 10),
                                  .error = strtod(fields[COLUMN_ERROR], NULL),
                                  .largest_error = strtod(fields[COLUMN_LARGEST], NULL),
                                  .pixels = strtoll(fields[COLUMN_PIXELS], NULL, 10)};
    snprintf(point->series, sizeof point->series, "%s", fields[COLUMN_SERIES]);
    snprintf(point->timer, sizeof point->timer, "%s", fields[COLUMN_TIMER]);
    snprintf(point->truth, sizeof point->truth, "%s", fields[COLUMN_TRUTH]);
    snprintf(point->reason, sizeof point->reason, "%s", fields[COLUMN_REASON]);
    point->quality = xstrdup(fields[COLUMN_QUALITY]);
    return true;
}

static bool read_points(struct chart_points *points, char *text, struct error *error)
{
    char *at = text, *fields[COLUMN_COUNT];

    if (strncmp(at, TITLES, sizeof TITLES - 1) != 0) {
        error_set(error, "expected a chart's points, got a file with other columns");
        return false;
    }
    for (at += sizeof TITLES - 1; *at;) {
        struct chart_point point;

        if (!take_line(&at, fields) || !read_point(&point, fields)) {
            error_set(error, "expected a chart's points, got another line after %zu of them", points->count);
            return false;
        }
        chart_points_add(points, &point);
        if (is_same(&points->facts, fields)) continue;
        error_set(error,
                  "the points are of another scene, frame, size or backend: remove the file, or choose another --out");
        return false;
    }
    return true;
}

bool chart_csv_load(struct chart_points *points, const char *path, struct error *error)
{
    char *text = NULL;
    bool ok;

    if (access(path, F_OK) != 0) return true;
    ok = file_read_text(path, SIZE_LIMIT, &text, NULL, error) && read_points(points, text, error);
    if (!ok) error_prefix(error, "%s", path);
    free(text);
    return ok;
}
