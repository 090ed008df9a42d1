// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/job/job_document.h"
#include "cli/job/job_mistakes.h"
#include "cli/job/job_summary.h"
#include "cli/program/options.h"
#include "cli/render/unseen_report.h"
#include "cli/terminal/print.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/job/job_warnings.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct verdict {
    const char *path;
    char *document; // owned; NULL: it cannot be read
    struct job job;
    struct error *errors; // owned; they name the file; none: the job is right
    size_t error_count;
};

static struct error *copy_error(const struct error *error)
{
    struct error *copy = xmalloc(sizeof *copy);

    *copy = *error;
    return copy;
}

// Finds all mistakes of a document that is no job; what is wrong beyond its text alone is one.
static void list_errors(struct verdict *verdict, const char *document, const struct error *error)
{
    struct error first = {0};
    struct job job;

    if (!document || job_parse(&job, document, strlen(document), "/", &first)) {
        if (document) job_finish(&job);
        verdict->errors = copy_error(error);
        verdict->error_count = 1;
        return;
    }
    verdict->errors = job_mistakes_find(document, &first, &verdict->error_count);
    for (size_t i = 0; i < verdict->error_count; i++)
        error_prefix(&verdict->errors[i], "%s", job_document_name(verdict->path));
}

static void judge(const struct options *options, struct verdict *verdict)
{
    struct error error = {0};

    verdict->document = job_document_load(verdict->path, options->sets, options->set_count, &error);
    if (!verdict->document || !job_document_check(verdict->path, verdict->document, "/", &verdict->job, &error))
        list_errors(verdict, verdict->document, &error);
}

static void find_warnings(const struct options *options, const struct verdict *verdict, job_warnings_on_found *on_found,
                          void *user)
{
    job_warnings_find(&verdict->job, on_found, user);
    unseen_report_find(options, &verdict->job, verdict->document, on_found, user);
}

static void write_warning(void *user, const char *text)
{
    json_write_string(user, text);
}

static void write_result(const struct options *options, struct json_writer *writer, const struct verdict *verdict)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "file", job_document_name(verdict->path));
    json_write_bool_member(writer, "valid", verdict->error_count == 0);
    if (verdict->error_count > 0) {
        json_write_string_member(writer, "error", verdict->errors[0].message);
        json_write_key(writer, "errors");
        json_write_begin_array(writer);
        for (size_t i = 0; i < verdict->error_count; i++)
            json_write_string(writer, verdict->errors[i].message);
        json_write_end_array(writer);
    } else {
        job_summary_write_members(&verdict->job, writer);
        json_write_key(writer, "warnings");
        json_write_begin_array(writer);
        find_warnings(options, verdict, write_warning, writer);
        json_write_end_array(writer);
    }
    json_write_end_object(writer);
}

static void print_warning(void *user, const char *text)
{
    const struct verdict *verdict = user;

    fprintf(stderr, "%s: warning: %s\n", job_document_name(verdict->path), text);
}

static void print_result(const struct options *options, struct verdict *verdict)
{
    int64_t count = frame_range_count(&verdict->job.frames);

    for (size_t i = 0; i < verdict->error_count; i++)
        fprintf(stderr, "%s\n", verdict->errors[i].message);
    if (verdict->error_count > 0) return;
    printf("%s: ok, %" PRId64 " frame%s of %d x %d\n", job_document_name(verdict->path), count, count == 1 ? "" : "s",
           verdict->job.width_px, verdict->job.height_px);
    find_warnings(options, verdict, print_warning, verdict);
}

enum exit_status command_validate(const struct options *options, struct error *error)
{
    enum exit_status status = EXIT_STATUS_DONE;
    struct json_writer results = {0};

    json_write_begin_object(&results);
    json_write_key(&results, "files");
    json_write_begin_array(&results);
    for (size_t i = 0; i < options->operand_count; i++) {
        struct verdict verdict = {.path = options->operands[i]};

        judge(options, &verdict);
        if (verdict.error_count > 0) status = EXIT_STATUS_USAGE;
        if (options->json)
            write_result(options, &results, &verdict);
        else
            print_result(options, &verdict);
        free(verdict.errors);
        free(verdict.document);
        job_finish(&verdict.job);
    }
    json_write_end_array(&results);
    json_write_end_object(&results);
    if (options->json) print_json_text(&results);
    json_writer_finish(&results);
    return status;
}
