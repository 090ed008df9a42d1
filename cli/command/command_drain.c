// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/peer/connection.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/base/error.h"

#include <inttypes.h>
#include <poll.h>
#include <stdio.h>

enum { ASK_MS = 250 };

static bool read_running(const struct json_node *object, int64_t *running, struct error *error)
{
    struct json_node node = json_node_child(object, "running");

    return json_read_integer(&node, 0, INT64_MAX / 1024, running, error);
}

static void tell_running(FILE *out, const char *what, int64_t running)
{
    fprintf(out, "%s: %" PRId64 " frame%s\n", what, running, running == 1 ? " runs" : "s run");
}

// Asks how many frames run. A drain that somebody ended meanwhile is a failure.
static bool ask_running(struct connection *connection, int64_t *running, struct error *error)
{
    struct message reply;
    struct json_node drain, frames;
    bool ok;

    if (!connection_call(connection, "daemon.status", NULL, &reply, error)) return false;
    drain = json_node_child(&reply.body, "drain");
    frames = json_node_child(&reply.body, "frames");
    ok = read_running(&frames, running, error);
    if (ok && json_node_type(&drain) != JSON_OBJECT) {
        error_set(error, "the drain was ended by somebody else: frames are begun again");
        ok = false;
    }
    message_finish(&reply);
    return ok;
}

static bool wait_for_frames(struct connection *connection, int64_t *running, struct error *error)
{
    int64_t told = *running;

    while (*running > 0) {
        poll(NULL, 0, ASK_MS);
        if (!ask_running(connection, running, error)) return false;
        if (*running != told && *running > 0) tell_running(stderr, "waiting", *running);
        told = *running;
    }
    return true;
}

static void tell(const struct options *options, int64_t running)
{
    if (options->json)
        printf("{\"running\":%" PRId64 "}\n", running);
    else if (running == 0)
        printf("drained: no frame runs, and none is begun until `march undrain` or a restart\n");
    else
        tell_running(stdout, "drained: no frame is begun until `march undrain` or a restart", running);
}

enum exit_status command_drain(const struct options *options, struct error *error)
{
    enum exit_status status;
    struct connection *connection = daemon_call_connect(options, &status, error);
    struct message reply;
    int64_t running = 0;
    bool ok;

    if (!connection) return status;
    ok = connection_call(connection, "daemon.drain", NULL, &reply, error);
    if (ok) {
        ok = read_running(&reply.body, &running, error);
        message_finish(&reply);
    }
    if (ok && options->wait && running > 0) {
        tell_running(stderr, "waiting", running);
        ok = wait_for_frames(connection, &running, error);
    }
    if (ok) tell(options, running);
    status = ok ? EXIT_STATUS_DONE : connection_failure(connection);
    connection_close(connection);
    return status;
}

enum exit_status command_undrain(const struct options *options, struct error *error)
{
    struct message reply;
    enum exit_status status = daemon_call(options, "daemon.undrain", NULL, &reply, error);

    if (status != EXIT_STATUS_DONE) return status;
    if (options->json)
        print_json(&reply.body);
    else
        printf("frames are begun again\n");
    message_finish(&reply);
    return status;
}
