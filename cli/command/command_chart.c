// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_axis.h"
#include "cli/chart/chart_ladder.h"
#include "cli/chart/chart_session.h"
#include "cli/command/commands.h"
#include "cli/job/job_document.h"
#include "cli/job/json_set.h"
#include "cli/program/options.h"
#include "cli/render/beyond_report.h"
#include "cli/terminal/print.h"
#include "cli/terminal/table.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_write.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { WIDTH_PX = 320, HEIGHT_PX = 180 };

// Errors for which the time of each method is printed.
static const double ERRORS[] = {0.1, 0.03, 0.01, 0.003, 0.001};
enum { ERROR_COUNT = sizeof ERRORS / sizeof *ERRORS };

struct chart_files {
    char *csv, *svg, *png, *truth; // owned; absolute
};

static void finish_files(struct chart_files *files)
{
    free(files->csv);
    free(files->svg);
    free(files->png);
    free(files->truth);
}

// FOLDER/NAME.csv and so on, with the job's NAME, in which '_' replaces characters unfit for file names.
static bool name_files(struct chart_files *files, const char *folder, const char *job_name, struct error *error)
{
    char absolute[PATH_MAX], name[JOB_NAME_LIMIT + 1], *with_slash = xasprintf("%s/", folder);
    bool is_there = (mkdir(folder, 0777) == 0 || errno == EEXIST) && realpath(with_slash, absolute);

    free(with_slash);
    if (!is_there) {
        error_set_errno(error, errno, "--out: %s", folder);
        return false;
    }
    snprintf(name, sizeof name, "%s", *job_name ? job_name : "job");
    for (char *at = name; *at; at++)
        if (!isalnum((unsigned char)*at) && *at != '-' && *at != '_') *at = '_';
    *files = (struct chart_files){
        .csv = xasprintf("%s/%s.csv", absolute, name),
        .svg = xasprintf("%s/%s.svg", absolute, name),
        .png = xasprintf("%s/%s_error.png", absolute, name),
        .truth = xasprintf("%s/%s.truth", absolute, name),
    };
    return true;
}

static bool set_size(char **document, const char *size, struct error *error)
{
    int width = WIDTH_PX, height = HEIGHT_PX, end = 0;
    char *assignment, *edited;

    if (size && (sscanf(size, "%5dx%5d%n", &width, &height, &end) != 2 || size[end] || width < 1 || height < 1)) {
        error_set(error, "--size: expected WIDTHxHEIGHT such as 320x180, got \"%s\"", size);
        return false;
    }
    assignment = xasprintf("resolution=[%d,%d]", width, height);
    edited = json_set(*document, assignment, error);
    free(assignment);
    if (!edited) return false;
    free(*document);
    *document = edited;
    return true;
}

static bool find_frame(const struct options *options, const struct job *job, int64_t *frame, struct error *error)
{
    *frame = options->frame >= 0 ? options->frame : frame_range_at(&job->frames, 0);
    for (int64_t i = 0; i < frame_range_count(&job->frames); i++)
        if (frame_range_at(&job->frames, i) == *frame) return true;
    error_set(error, "--frame: expected a frame of the job, got %" PRId64, *frame);
    return false;
}

static void on_point(void *user, const struct chart_point *point)
{
    const struct options *options = user;
    char seconds[CHART_LABEL_SIZE], error[CHART_LABEL_SIZE];

    if (options->json) return;
    chart_axis_format_seconds(point->seconds, seconds);
    chart_axis_format_percent(point->error, error);
    if (point->outcome == CHART_MEASURED)
        fprintf(stderr, "%-14s %2d  %10s  %s\n", point->series, point->rung, seconds, error);
    else if (point->outcome == CHART_TOO_SLOW)
        fprintf(stderr, "%-14s %2d  takes longer than %s\n", point->series, point->rung, seconds);
    else
        fprintf(stderr, "%-14s %2d  refused: %s\n", point->series, point->rung, point->reason);
}

static bool has_point(const struct chart_points *points, const char *series)
{
    for (size_t i = 0; i < points->count; i++)
        if (points->list[i].outcome == CHART_MEASURED && strcmp(points->list[i].series, series) == 0) return true;
    return false;
}

static void add_time(struct table *table, const struct chart_points *points, const char *series, double error)
{
    double seconds = chart_points_time(points, series, error), baseline = chart_points_time(points, "riemann", error);
    char label[CHART_LABEL_SIZE];

    if (isnan(seconds)) {
        table_add(table, "-");
        return;
    }
    chart_axis_format_seconds(seconds, label);
    if (isnan(baseline) || strcmp(series, "riemann") == 0)
        table_add(table, label);
    else
        table_add_format(table, "%s (%.3gx)", label, baseline / seconds);
}

static void print_times(const struct chart_points *points)
{
    static const struct table_column columns[] = {{"TIME TO", false}, {"10 %", true},  {"3 %", true},
                                                  {"1 %", true},      {"0.3 %", true}, {"0.1 %", true}};
    struct table table = {.columns = columns, .column_count = 1 + ERROR_COUNT};

    for (size_t series = 0; series < chart_ladder_count(); series++) {
        const char *name = chart_ladder_name(series);

        if (!has_point(points, name)) continue;
        table_add(&table, name);
        for (int i = 0; i < ERROR_COUNT; i++)
            add_time(&table, points, name, ERRORS[i]);
    }
    print_table(&table);
    table_finish(&table);
}

static void write_point(struct json_writer *out, const struct chart_points *points, size_t index)
{
    static const char *const outcomes[] = {"measured", "refused", "too slow"};
    const struct chart_point *point = &points->list[index];

    json_write_begin_object(out);
    json_write_string_member(out, "series", point->series);
    json_write_integer_member(out, "rung", point->rung);
    json_write_key(out, "quality");
    json_write_raw(out, point->quality, strlen(point->quality));
    json_write_string_member(out, "outcome", outcomes[point->outcome]);
    if (point->outcome == CHART_MEASURED) {
        json_write_number_member(out, "seconds", point->seconds);
        json_write_number_member(out, "error", point->error);
        json_write_number_member(out, "largest_error", point->largest_error);
        json_write_bool_member(out, "best", chart_points_is_best(points, index));
    }
    if (point->outcome == CHART_REFUSED) json_write_string_member(out, "reason", point->reason);
    json_write_end_object(out);
}

static void write_times(struct json_writer *out, const struct chart_points *points)
{
    json_write_begin_array(out);
    for (size_t series = 0; series < chart_ladder_count(); series++) {
        const char *name = chart_ladder_name(series);

        if (!has_point(points, name)) continue;
        json_write_begin_object(out);
        json_write_string_member(out, "series", name);
        json_write_key(out, "seconds");
        json_write_begin_array(out);
        for (int i = 0; i < ERROR_COUNT; i++)
            json_write_number(out, chart_points_time(points, name, ERRORS[i])); // null: never reached
        json_write_end_array(out);
        json_write_end_object(out);
    }
    json_write_end_array(out);
}

static void print_chart_json(const struct chart_points *points, const struct chart_files *files,
                             const struct job_beyond *beyond)
{
    const struct chart_facts *facts = &points->facts;
    struct json_writer out = {0};

    json_write_begin_object(&out);
    json_write_string_member(&out, "name", facts->name);
    json_write_integer_member(&out, "frame", facts->frame);
    json_write_integer_member(&out, "width_px", facts->width_px);
    json_write_integer_member(&out, "height_px", facts->height_px);
    json_write_string_member(&out, "backend", facts->backend);
    json_write_string_member(&out, "renderer", facts->renderer);
    json_write_string_member(&out, "csv", files->csv);
    json_write_string_member(&out, "svg", files->svg);
    json_write_string_member(&out, "png", files->png);
    job_beyond_write(beyond, &out);
    json_write_key(&out, "errors");
    json_write_begin_array(&out);
    for (int i = 0; i < ERROR_COUNT; i++)
        json_write_number(&out, ERRORS[i]);
    json_write_end_array(&out);
    json_write_key(&out, "times");
    write_times(&out, points);
    json_write_key(&out, "points");
    json_write_begin_array(&out);
    for (size_t i = 0; i < points->count; i++)
        write_point(&out, points, i);
    json_write_end_array(&out);
    json_write_end_object(&out);
    print_json_text(&out);
    json_writer_finish(&out);
}

static enum exit_status chart(const struct options *options, const char *document, const struct job *job,
                              struct error *error)
{
    enum exit_status status = EXIT_STATUS_USAGE;
    struct chart_files files = {0};
    struct chart_points points = {0};
    struct chart_svg_mark mark = {0};
    char left[JOB_BEYOND_TEXT_SIZE];
    struct job_beyond beyond;
    int64_t frame;

    if (!find_frame(options, job, &frame, error)) return status;
    if (!name_files(&files, options->out ? options->out : ".", job->name ? job->name : "job", error)) return status;
    status = chart_session_run(&(struct chart_session_params){.options = options,
                                                              .document = document,
                                                              .frame = frame,
                                                              .csv_path = files.csv,
                                                              .svg_path = files.svg,
                                                              .png_path = files.png,
                                                              .truth_path = files.truth,
                                                              .on_point = on_point,
                                                              .user = (void *)options},
                               &points, &mark, error);
    if (status == EXIT_STATUS_DONE) beyond_report_ask(options, job, document, &beyond);
    if (status == EXIT_STATUS_DONE && options->json) {
        print_chart_json(&points, &files, &beyond);
    } else if (status == EXIT_STATUS_DONE) {
        print_times(&points);
        job_beyond_describe(&beyond, job->scene.orders, left);
        if (left[0]) printf("\nErrors are of the orders that are modelled: %s.\n", left);
        printf("\n%s\n%s\n%s\n", files.csv, files.svg, files.png);
    }
    chart_points_finish(&points);
    finish_files(&files);
    return status;
}

enum exit_status command_chart(const struct options *options, struct error *error)
{
    char *document = job_document_load(options->operands[0], options->sets, options->set_count, error);
    enum exit_status status = EXIT_STATUS_USAGE;
    struct job job = {0};

    if (document && set_size(&document, options->size, error) &&
        job_document_check(options->operands[0], document, "/", &job, error))
        status = chart(options, document, &job, error);
    job_finish(&job);
    free(document);
    return status;
}
