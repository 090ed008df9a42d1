// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/job_selection.h"

#include "cli/farm/job_pages.h"
#include "cli/farm/job_report.h"
#include "cli/peer/connection.h"
#include "cli/program/options.h"
#include "core/base/alloc.h"
#include "core/base/error.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { OWNERS_SHOWN = 8 };

// The owners of the chosen jobs.
struct owners {
    char *names[OWNERS_SHOWN]; // owned
    size_t counts[OWNERS_SHOWN];
    size_t count, others; // `others`: jobs of further owners
};

static bool chooses(const struct options *options)
{
    return options->all || options->owner || options->state || options->over_s >= 0;
}

enum exit_status job_selection_check(const struct options *options, struct error *error)
{
    int64_t id;

    if (options->operand_count > 0 && chooses(options)) {
        error_set(error, "expected ids of jobs, or --all, --owner and --state, got both");
        return EXIT_STATUS_USAGE;
    }
    if (options->operand_count == 0 && !chooses(options)) {
        error_set(error, "expected ids of jobs, or --all, --owner or --state");
        return EXIT_STATUS_USAGE;
    }
    for (size_t i = 0; i < options->operand_count; i++)
        if (!options_parse_id(options->operands[i], &id, error)) return EXIT_STATUS_USAGE;
    return EXIT_STATUS_DONE;
}

static void count_owner(struct owners *owners, const char *name)
{
    size_t i = 0;

    while (i < owners->count && strcmp(owners->names[i], name) != 0)
        i++;
    if (i == OWNERS_SHOWN) {
        owners->others++;
        return;
    }
    if (i == owners->count) owners->names[owners->count++] = xstrdup(name);
    owners->counts[i]++;
}

// What is chosen so far.
struct choice {
    struct job_selection *selection;
    size_t capacity;
    struct owners owners;
    int64_t over_s; // only jobs that ended before; negative: any
};

static bool on_job(void *user, const struct json_node *job, struct error *error)
{
    struct choice *choice = user;
    struct job_selection *selection = choice->selection;
    struct job_report report;

    if (!job_report_read(&report, job, error)) return false;
    if (choice->over_s < 0 || (report.finished >= 0 && report.finished < (double)choice->over_s)) {
        selection->ids = xgrow(selection->ids, &choice->capacity, selection->count + 1, sizeof selection->ids[0]);
        selection->ids[selection->count++] = report.id;
        count_owner(&choice->owners, report.owner ? report.owner : "?");
    }
    job_report_finish(&report);
    return true;
}

static void tell_count(const struct job_selection *selection, const char *verb, const struct owners *owners)
{
    fprintf(stderr, "%s %zu job%s", verb, selection->count, selection->count == 1 ? "" : "s");
    for (size_t i = 0; i < owners->count; i++)
        fprintf(stderr, "%s%zu of %s", i ? ", " : ": ", owners->counts[i], owners->names[i]);
    if (owners->others > 0) fprintf(stderr, ", %zu of others", owners->others);
}

// Says how many jobs there are. Only a terminal is asked.
static enum exit_status confirm(const struct job_selection *selection, const struct options *options, const char *verb,
                                const struct owners *owners, struct error *error)
{
    char answer[16] = "";

    tell_count(selection, verb, owners);
    if (options->yes || selection->count == 0) {
        fprintf(stderr, "\n");
        return EXIT_STATUS_DONE;
    }
    if (!isatty(STDIN_FILENO) || options->json) {
        fprintf(stderr, "\n");
        error_set(error, "nothing was done: --yes does it");
        return EXIT_STATUS_USAGE;
    }
    fprintf(stderr, "? [y/N] ");
    if (fgets(answer, sizeof answer, stdin) && (answer[0] == 'y' || answer[0] == 'Y')) return EXIT_STATUS_DONE;
    error_set(error, "nothing was done");
    return EXIT_STATUS_FAILED;
}

static enum exit_status find_chosen(struct job_selection *selection, struct connection *connection,
                                    const struct options *options, const struct job_selection_params *params,
                                    struct error *error)
{
    struct choice choice = {.selection = selection, .over_s = options->over_s};
    struct job_pages pages = {.states = options->state ? options->state : params->states,
                              .owner = options->owner,
                              .since_s = -1,
                              .on_job = on_job,
                              .user = &choice};
    enum exit_status status = job_pages_read(&pages, connection, error);

    if (status == EXIT_STATUS_DONE) status = confirm(selection, options, params->verb, &choice.owners, error);
    for (size_t i = 0; i < choice.owners.count; i++)
        free(choice.owners.names[i]);
    return status;
}

enum exit_status job_selection_find(struct job_selection *selection, struct connection *connection,
                                    const struct options *options, const struct job_selection_params *params,
                                    struct error *error)
{
    enum exit_status status;

    *selection = (struct job_selection){0};
    if (chooses(options)) {
        status = find_chosen(selection, connection, options, params, error);
        if (status != EXIT_STATUS_DONE) job_selection_finish(selection);
        return status;
    }
    selection->ids = xcalloc(options->operand_count + 1, sizeof selection->ids[0]);
    for (size_t i = 0; i < options->operand_count; i++)
        options_parse_id(options->operands[i], &selection->ids[selection->count++], NULL);
    return EXIT_STATUS_DONE;
}

void job_selection_finish(struct job_selection *selection)
{
    free(selection->ids);
    *selection = (struct job_selection){0};
}
