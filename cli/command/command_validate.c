// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/job/job_document.h"
#include "cli/job/job_summary.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static bool check_file(const struct options *options, const char *path, struct job *job, struct error *error)
{
    char *document = job_document_load(path, options->sets, options->set_count, error);
    bool ok = document && job_document_check(path, document, "/", job, error);

    free(document);
    return ok;
}

static void write_result(struct json_writer *writer, const char *path, const struct job *job, const struct error *error)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "file", job_document_name(path));
    json_write_bool_member(writer, "valid", !error->message[0]);
    if (error->message[0])
        json_write_string_member(writer, "error", error->message);
    else
        job_summary_write_members(job, writer);
    json_write_end_object(writer);
}

static void print_result(const char *path, const struct job *job, const struct error *error)
{
    int64_t count = frame_range_count(&job->frames);

    if (error->message[0])
        fprintf(stderr, "%s\n", error->message);
    else
        printf("%s: ok, %" PRId64 " frame%s of %d x %d\n", job_document_name(path), count, count == 1 ? "" : "s",
               job->width_px, job->height_px);
}

enum exit_status command_validate(const struct options *options, struct error *error)
{
    enum exit_status status = EXIT_STATUS_DONE;
    struct json_writer results = {0};

    json_write_begin_object(&results);
    json_write_key(&results, "files");
    json_write_begin_array(&results);
    for (size_t i = 0; i < options->operand_count; i++) {
        struct error wrong = {0};
        struct job job = {0};

        if (!check_file(options, options->operands[i], &job, &wrong)) status = EXIT_STATUS_USAGE;
        if (options->json)
            write_result(&results, options->operands[i], &job, &wrong);
        else
            print_result(options->operands[i], &job, &wrong);
        job_finish(&job);
    }
    json_write_end_array(&results);
    json_write_end_object(&results);
    if (options->json) print_json_text(&results);
    json_writer_finish(&results);
    return status;
}
