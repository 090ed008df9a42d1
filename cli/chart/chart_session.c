// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_session.h"

#include "cli/chart/chart_csv.h"
#include "cli/chart/chart_ladder.h"
#include "cli/chart/chart_query.h"
#include "cli/program/interrupt.h"
#include "cli/program/options.h"
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Seconds. A quick chart keeps the remainder of its five minutes for the strip of errors.
static const double QUICK_TRUTH = 40, TRUTH = 120, QUICK_POINTS = 200, QUICK_LIMIT = 8, LIMIT = 60;
static const double STRIP_ERROR = 0.01; // the strip shows the pictures nearest to it
// The truth of a pixel has a relative error of about 1e-4, the mean less; rounding to half adds about 2e-4.
static const double LEAST_FLOAT = 3e-5, LEAST_HALF = 2.5e-4;
// For a job that states none.
static const double TOLERANCE = 0.01;

struct session {
    const struct chart_session_params *params; // borrowed
    struct chart_points *points;               // borrowed
    struct chart_choice choice;
    struct chart_query query;
    struct chart_scale scale;
    struct chart_limits limits;
    double end_s;
    double tolerance;
    struct cJSON *root; // owned; the document
    bool is_changed;    // points were added
};

static struct json_node job_quality(const struct session *session, struct json_node *job)
{
    *job = json_node_root(session->root);
    return json_node_child(job, "quality");
}

// The job with the quality of a rung; NULL, with the reason, when that is no valid job.
static char *make_document(const struct session *session, size_t series, const char *quality, struct error *error)
{
    return chart_query_document(session->params->document, quality,
                                chart_ladder_needs_clip(series) ? &session->scale : NULL, error);
}

static char *rung_quality(const struct session *session, size_t series, int rung)
{
    struct json_node job, quality = job_quality(session, &job);

    return chart_ladder_quality(series, rung, &session->scale, &quality);
}

static int samples_of(const char *quality)
{
    const char *samples = strstr(quality, "\"samples\":");

    return samples ? (int)strtol(samples + strlen("\"samples\":"), NULL, 10) : 1;
}

// Makes two settings of the first method that can render the scene: their difference shows where errors are large.
static bool make_map_documents(const struct session *session, int samples, char **finer, char **coarser,
                               struct error *error)
{
    enum { FINER = 3, COARSER = 2 };

    struct error reason = {{0}}; // of the first method

    *finer = *coarser = NULL;
    for (size_t series = 0; series < chart_ladder_count(); series++) {
        struct error local = {{0}};

        if (chart_ladder_needs_clip(series)) continue;
        for (int i = 0; i < 2; i++) {
            char *quality = rung_quality(session, series, i ? COARSER : FINER);
            char *text = chart_query_with_samples(quality, samples), **document = i ? coarser : finer;

            free(*document);
            *document = make_document(session, series, text, &local);
            free(text);
            free(quality);
        }
        if (*finer && *coarser) return true;
        if (!reason.message[0]) reason = local;
    }
    free(*finer);
    free(*coarser);
    error_set(error, "no method can render it: %s", reason.message);
    return false;
}

static enum exit_status find_truth(struct session *session, int samples, struct chart_truth_facts *facts,
                                   struct error *error)
{
    double seconds = session->params->options->quick ? QUICK_TRUTH : TRUTH;
    enum exit_status status = EXIT_STATUS_USAGE;
    char *finer, *coarser;

    if (!make_map_documents(session, samples, &finer, &coarser, error)) return status;
    status = chart_query_truth(&session->query, finer, coarser, samples, seconds, facts, error);
    free(finer);
    free(coarser);
    return status;
}

static bool keep(struct session *session, struct chart_point *point, struct error *error)
{
    const struct chart_point *before = chart_points_find(session->points, point->series, point->rung - 1);
    bool is_news = !before || point->outcome != CHART_REFUSED || before->outcome != CHART_REFUSED;

    chart_points_add(session->points, point);
    session->is_changed |= point->outcome == CHART_MEASURED;
    if (is_news) session->params->on_point(session->params->user, point);
    return chart_csv_save(session->points, session->params->csv_path, error);
}

// Takes over `point`, in which series, rung and quality are set, and `document`, which is NULL where `why` refused it.
// A worker that ends during a setting is replaced, and the setting counts as refused.
static enum exit_status measure_point(struct session *session, struct chart_point point, char *document,
                                      struct error *why, struct error *error)
{
    enum exit_status status = EXIT_STATUS_DONE;
    const char *quality = point.quality;
    struct error reason = *why;

    point.outcome = CHART_REFUSED;
    if (document) {
        struct chart_truth_facts facts;

        status = find_truth(session, samples_of(quality), &facts, error);
        if (status == EXIT_STATUS_DONE)
            status = chart_query_point(&session->query, document, &facts, samples_of(quality), session->limits.seconds,
                                       &point, &reason);
        if (status == EXIT_STATUS_NO_DAEMON) status = chart_query_restart(&session->query, error);
    }
    free(document);
    if (status != EXIT_STATUS_DONE) {
        if (!error->message[0]) *error = reason;
        free(point.quality);
        return status;
    }
    if (point.outcome == CHART_REFUSED)
        snprintf(point.reason, sizeof point.reason, "%.*s", CHART_TEXT_SIZE - 1, reason.message);
    return keep(session, &point, error) ? EXIT_STATUS_DONE : EXIT_STATUS_FAILED;
}

// True when the series renders a rung by the same program as its base: their lines would coincide.
static bool is_same_as(struct session *session, size_t series, size_t base, int rung)
{
    const size_t both[] = {series, base};
    char hashes[2][HASH_TEXT_SIZE] = {"", ""};

    for (int i = 0; i < 2; i++) {
        char *quality = rung_quality(session, both[i], rung),
             *document = make_document(session, both[i], quality, NULL);

        free(quality);
        if (document) (void)chart_query_program(&session->query, document, hashes[i], NULL);
        free(document);
    }
    return hashes[0][0] && strcmp(hashes[0], hashes[1]) == 0;
}

static enum exit_status measure_rung(struct session *session, size_t series, int rung, struct error *error)
{
    struct chart_point point = {.rung = rung, .quality = rung_quality(session, series, rung)};
    int base = chart_ladder_base(series);
    struct error reason = {{0}};
    char *document = NULL;

    if (base >= 0 && is_same_as(session, series, (size_t)base, rung))
        error_set(&reason, "here it is the same program as %s", chart_ladder_name((size_t)base));
    else
        document = make_document(session, series, point.quality, &reason);
    snprintf(point.series, sizeof point.series, "%s", chart_ladder_name(series));
    return measure_point(session, point, document, &reason, error);
}

// Measures the planner's choice as a point of its own. A scene that cannot be planned gets none.
static enum exit_status measure_planned(struct session *session, struct error *error)
{
    struct json_node job, quality = job_quality(session, &job);
    char *quality_text = chart_ladder_tolerance(session->tolerance, &quality);
    char *document = chart_query_document(session->params->document, quality_text, NULL, NULL), *planned = NULL;
    struct chart_point point = {0};
    struct error reason = {{0}};
    enum exit_status status = EXIT_STATUS_DONE;

    snprintf(point.series, sizeof point.series, "%s", CHART_PLANNED);
    free(quality_text);
    if (document) status = chart_query_plan(&session->query, document, &point.quality, &reason);
    free(document);
    if (status == EXIT_STATUS_INTERRUPTED) *error = reason;
    if (status == EXIT_STATUS_INTERRUPTED || !point.quality) return point.quality ? EXIT_STATUS_DONE : status;
    planned = chart_query_document(session->params->document, point.quality, NULL, &reason);
    return measure_point(session, point, planned, &reason, error);
}

static void mark_planned(const struct session *session, struct chart_svg_mark *mark)
{
    const struct chart_point *point = chart_points_find(session->points, CHART_PLANNED, 0);

    *mark = (struct chart_svg_mark){.tolerance = session->tolerance};
    if (!point || point->outcome != CHART_MEASURED || !isfinite(point->error)) return;
    mark->seconds = point->seconds;
    mark->error = point->error;
}

// Measures rung by rung across all series, so that a chart that ends early shows the same rungs of each.
static enum exit_status climb(struct session *session, struct error *error)
{
    bool has_climbed = true;

    while (has_climbed) {
        has_climbed = false;
        for (size_t series = 0; series < chart_ladder_count() && clock_now_s() < session->end_s; series++) {
            int rung = chart_choice_next(&session->choice, session->points, series, &session->limits);
            enum exit_status status;

            if (rung < 0) continue;
            status = measure_rung(session, series, rung, error);
            if (status != EXIT_STATUS_DONE) return status;
            has_climbed = true;
        }
    }
    return EXIT_STATUS_DONE;
}

// The point of a series whose error is nearest to STRIP_ERROR; NULL when none was measured.
static const struct chart_point *find_shown(const struct session *session, size_t series)
{
    const struct chart_point *shown = NULL;

    for (size_t i = 0; i < session->points->count; i++) {
        const struct chart_point *point = &session->points->list[i];

        if (point->outcome != CHART_MEASURED || !isfinite(point->error) || point->error <= 0 ||
            strcmp(point->series, chart_ladder_name(series)) != 0)
            continue;
        if (!shown || fabs(log(point->error / STRIP_ERROR)) < fabs(log(shown->error / STRIP_ERROR))) shown = point;
    }
    return shown;
}

static const struct chart_point *find_most_exact(const struct session *session, size_t *series)
{
    const struct chart_point *best = NULL;

    for (size_t i = 0; i < session->points->count; i++) {
        const struct chart_point *point = &session->points->list[i];

        if (point->outcome == CHART_MEASURED && strcmp(point->series, CHART_PLANNED) != 0 &&
            (!best || point->error < best->error))
            best = point;
    }
    for (size_t i = 0; best && i < chart_ladder_count(); i++)
        if (strcmp(chart_ladder_name(i), best->series) == 0) *series = i;
    return best;
}

static bool add_to_strip(struct session *session, struct chart_strip *strip, const struct chart_point *point,
                         size_t series, const char *what, struct error *error)
{
    char *document = make_document(session, series, point->quality, error);

    if (!document) return false;
    chart_strip_add(strip, document, xasprintf("%s%s %.2g", what, point->series, point->error));
    return true;
}

static enum exit_status draw_strip(struct session *session, struct error *error)
{
    struct chart_strip strip = {0};
    size_t best_series = 0;
    const struct chart_point *best = find_most_exact(session, &best_series);
    enum exit_status status = EXIT_STATUS_FAILED;
    bool ok = true;

    if (!best) return EXIT_STATUS_DONE;
    for (size_t series = 0; ok && series < chart_ladder_count(); series++) {
        const struct chart_point *shown = find_shown(session, series);

        if (shown && shown != best) ok = add_to_strip(session, &strip, shown, series, "", error);
    }
    ok = ok && add_to_strip(session, &strip, best, best_series, "against ", error);
    if (ok) status = chart_query_strip(&session->query, &strip, session->params->png_path, error);
    chart_strip_finish(&strip);
    return status;
}

// True when a loaded point equals that of the current ladder. A point that was refused before it reached a worker is
// tried again.
static bool is_current(const struct session *session, const struct chart_point *point)
{
    bool is_same = false;

    if (point->outcome == CHART_REFUSED && !point->truth[0]) return false;
    if (strcmp(point->series, CHART_PLANNED) == 0) return true;
    for (size_t series = 0; series < chart_ladder_count(); series++) {
        char *quality;

        if (strcmp(chart_ladder_name(series), point->series) != 0) continue;
        quality = rung_quality(session, series, point->rung);
        is_same = strcmp(quality, point->quality) == 0;
        free(quality);
    }
    return is_same;
}

static bool load_points(struct session *session, struct error *error)
{
    struct chart_points *points = session->points;
    size_t kept = 0;

    if (!chart_csv_load(points, session->params->csv_path, error)) return false;
    for (size_t i = 0; i < points->count; i++) {
        if (is_current(session, &points->list[i]))
            points->list[kept++] = points->list[i];
        else
            free(points->list[i].quality);
    }
    points->count = kept;
    return true;
}

// Reads the job's tolerance, and the smallest error that its pixels allow.
static bool read_exactness(struct session *session, struct error *error)
{
    struct json_node job, quality, tolerance, output, pixel;
    const char *name;

    if (!json_parse(&session->root, session->params->document, strlen(session->params->document), error)) return false;
    quality = job_quality(session, &job);
    tolerance = json_node_child(&quality, "tolerance");
    if (!json_read_number(&tolerance, 0, 1, &session->tolerance, NULL)) session->tolerance = TOLERANCE;
    output = json_node_child(&job, "output");
    pixel = json_node_child(&output, "pixel");
    session->limits.error =
        json_read_string(&pixel, &name, NULL) && strcmp(name, "float") == 0 ? LEAST_FLOAT : LEAST_HALF;
    return true;
}

static enum exit_status run(struct session *session, struct chart_svg_mark *mark, struct error *error)
{
    const struct chart_session_params *params = session->params;
    struct chart_truth_facts facts;
    struct json_node job, quality = job_quality(session, &job);
    char *text = json_node_is_absent(&quality) ? xstrdup("{}") : json_node_format(&quality);
    int samples = samples_of(text);
    enum exit_status status;

    free(text);
    status = chart_query_scale(&session->query, params->document, &session->scale, error);
    if (status == EXIT_STATUS_DONE) status = find_truth(session, samples, &facts, error);
    if (status != EXIT_STATUS_DONE) return status;
    session->points->facts = facts.facts;
    chart_query_set_name(&job, &session->points->facts);
    if (!load_points(session, error)) return EXIT_STATUS_USAGE;
    status = EXIT_STATUS_DONE;
    if (chart_choice_has_planned(&session->choice) && !chart_points_find(session->points, CHART_PLANNED, 0))
        status = measure_planned(session, error);
    if (status == EXIT_STATUS_DONE) status = climb(session, error);
    mark_planned(session, mark);
    if (!chart_svg_save(session->points, mark, params->svg_path, status == EXIT_STATUS_DONE ? error : NULL) &&
        status == EXIT_STATUS_DONE)
        status = EXIT_STATUS_FAILED;
    if (status == EXIT_STATUS_DONE && (session->is_changed || !chart_query_is_there(params->png_path)))
        status = draw_strip(session, error);
    return status;
}

enum exit_status chart_session_run(const struct chart_session_params *params, struct chart_points *points,
                                   struct chart_svg_mark *mark, struct error *error)
{
    const struct options *options = params->options;
    struct session session = {.params = params, .points = points, .end_s = INFINITY};
    enum exit_status status = EXIT_STATUS_USAGE;
    struct interrupt interrupt;

    session.limits.seconds = options->point_limit_s > 0 ? (double)options->point_limit_s
                             : options->quick           ? QUICK_LIMIT
                                                        : LIMIT;
    session.limits.is_short = options->quick;
    if (options->quick) session.end_s = clock_now_s() + QUICK_POINTS;
    if (options->methods && !chart_choice_parse(&session.choice, options->methods, error)) return status;
    interrupt_init(&interrupt);
    session.query = (struct chart_query){
        .options = options, .interrupt = &interrupt, .frame = params->frame, .truth_path = params->truth_path};
    if (read_exactness(&session, error)) {
        status = chart_query_start(&session.query, error);
        if (status == EXIT_STATUS_DONE) status = run(&session, mark, error);
    }
    if (status == EXIT_STATUS_NO_DAEMON) status = EXIT_STATUS_FAILED;
    chart_query_stop(&session.query, status != EXIT_STATUS_DONE);
    interrupt_finish(&interrupt);
    json_delete(session.root);
    chart_choice_finish(&session.choice);
    return status;
}
