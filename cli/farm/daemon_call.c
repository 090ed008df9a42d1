// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/daemon_call.h"

#include "cli/farm/daemon_socket.h"
#include "cli/farm/job_report.h"
#include "cli/farm/socket_path.h"
#include "cli/peer/connection.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "cli/terminal/progress.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *daemon_call_socket(const struct options *options)
{
    const char *named = options->socket && *options->socket ? options->socket : getenv("MARCHD_SOCKET");

    return named && *named ? named : NULL;
}

struct connection *daemon_call_connect(const struct options *options, enum exit_status *status, struct error *error)
{
    const struct socket_path_params params = {.option = options->socket,
                                              .environment = getenv("MARCHD_SOCKET"),
                                              .system_path = SOCKET_PATH_SYSTEM,
                                              .runtime_folder = getenv("XDG_RUNTIME_DIR"),
                                              .state_home = getenv("XDG_STATE_HOME"),
                                              .home = getenv("HOME")};
    struct socket_path_list list;
    struct connection *connection;

    socket_path_choose(&list, &params);
    connection = daemon_socket_connect(list.paths, list.count, status, error);
    socket_path_finish(&list);
    return connection;
}

enum exit_status daemon_call(const struct options *options, const char *method, const char *params,
                             struct message *reply, struct error *error)
{
    enum exit_status status;
    struct connection *connection = daemon_call_connect(options, &status, error);

    if (!connection) return status;
    status = EXIT_STATUS_DONE;
    if (!connection_call(connection, method, params, reply, error)) status = connection_failure(connection);
    connection_close(connection);
    return status;
}

static bool tell_job(const struct json_node *result, int64_t id, struct json_writer *results, struct error *error)
{
    struct job_report report = {0};
    char *text;

    if (!job_report_read(&report, result, error)) return false;
    if (results) {
        text = json_node_format(result);
        json_write_raw(results, text, strlen(text));
        free(text);
    } else {
        text = progress_format_state(report.state, report.reason);
        printf("job %" PRId64 ": %s\n", id, text);
        free(text);
    }
    job_report_finish(&report);
    return true;
}

static bool call(struct connection *connection, const struct daemon_call_each *each, int64_t id,
                 struct json_writer *results, struct error *error)
{
    struct message reply;
    char params[96];
    bool ok;

    snprintf(params, sizeof params, "{\"id\":%" PRId64 "%s}", id, each->more);
    if (!connection_call(connection, each->method, params, &reply, error)) return false;
    ok = each->report(&reply.body, id, results, error);
    message_finish(&reply);
    return ok;
}

static void tell_error(int64_t id, const char *message, struct json_writer *errors)
{
    bool names_job = strncmp(message, "job ", strlen("job ")) == 0;

    if (names_job)
        fprintf(stderr, "%s\n", message);
    else
        fprintf(stderr, "job %" PRId64 ": %s\n", id, message);
    if (!errors) return;
    json_write_begin_object(errors);
    json_write_integer_member(errors, "id", id);
    json_write_string_member(errors, "error", message);
    json_write_end_object(errors);
}

static void print_results(const char *key, struct json_writer *jobs, struct json_writer *errors)
{
    struct json_writer whole = {0};

    json_write_end_array(jobs);
    json_write_end_array(errors);
    json_write_begin_object(&whole);
    json_write_key(&whole, key);
    json_write_raw(&whole, jobs->text, jobs->length);
    json_write_key(&whole, "errors");
    json_write_raw(&whole, errors->text, errors->length);
    json_write_end_object(&whole);
    print_json_text(&whole);
    json_writer_finish(&whole);
}

enum exit_status daemon_call_each_job(const struct options *options, const char *method,
                                      const struct job_selection_params *selection, struct error *error)
{
    return daemon_call_each(
        options,
        &(struct daemon_call_each){
            .method = method, .more = "", .key = "jobs", .report = tell_job, .selection = *selection},
        error);
}

enum exit_status daemon_call_each(const struct options *options, const struct daemon_call_each *each,
                                  struct error *error)
{
    struct connection *connection = NULL;
    struct json_writer jobs = {0}, errors = {0};
    enum exit_status status = job_selection_check(options, error);
    struct job_selection selection = {0};

    if (status == EXIT_STATUS_DONE) connection = daemon_call_connect(options, &status, error);
    if (!connection) return status;
    status = job_selection_find(&selection, connection, options, &each->selection, error);
    if (status != EXIT_STATUS_DONE) goto out;
    json_write_begin_array(&jobs);
    json_write_begin_array(&errors);
    for (size_t i = 0; i < selection.count; i++) {
        struct error wrong = {0};
        enum exit_status failure;

        if (call(connection, each, selection.ids[i], options->json ? &jobs : NULL, &wrong)) continue;
        failure = connection_failure(connection);
        if (status == EXIT_STATUS_DONE) status = failure ? failure : EXIT_STATUS_FAILED;
        tell_error(selection.ids[i], wrong.message, options->json ? &errors : NULL);
        if (failure == EXIT_STATUS_NO_DAEMON) break;
    }
    if (options->json) print_results(each->key, &jobs, &errors);
out:
    job_selection_finish(&selection);
    json_writer_finish(&jobs);
    json_writer_finish(&errors);
    connection_close(connection);
    return status;
}
