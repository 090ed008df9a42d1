// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/program/options.h"
#include "cli/program/program_beside.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <stdio.h>
#include <stdlib.h>

// The state folder of the daemon at a socket that was named: the queue of another farm is not meant.
static enum exit_status ask_folder(const struct options *options, const char *socket, char **folder,
                                   struct error *error)
{
    struct message reply;
    enum exit_status status = daemon_call(options, "daemon.status", NULL, &reply, error);
    struct json_node node;
    const char *text;

    if (status == EXIT_STATUS_DONE) {
        node = json_node_child(&reply.body, "state_folder");
        if (json_node_type(&node) == JSON_STRING && json_read_string(&node, &text, NULL)) *folder = xstrdup(text);
        message_finish(&reply);
        if (!*folder) status = EXIT_STATUS_FAILED;
    }
    if (status == EXIT_STATUS_NO_DAEMON || status == EXIT_STATUS_FAILED)
        error_set(error, "no daemon at %s says where its queue is: name its state folder as a second word after FILE",
                  socket);
    return status;
}

// The daemon's program does it: it knows the form of the queue's file, and where it lies by default.
static enum exit_status copy(const struct options *options, const char *option, const char *folder, const char *key,
                             struct error *error)
{
    const char *arguments[] = {option, options->operands[0], folder ? "--state" : NULL, folder, NULL};
    struct json_writer writer = {0};

    switch (program_beside_run("marchd", arguments, options->json)) {
    case 0:
        break;
    case -1:
        error_set(error, "cannot run marchd, which belongs beside march");
        return EXIT_STATUS_FAILED;
    default:
        return EXIT_STATUS_FAILED;
    }
    if (!options->json) return EXIT_STATUS_DONE;
    json_write_begin_object(&writer);
    json_write_string_member(&writer, key, options->operands[0]);
    json_write_end_object(&writer);
    puts(writer.text);
    json_writer_finish(&writer);
    return EXIT_STATUS_DONE;
}

static enum exit_status run(const struct options *options, const char *option, const char *key, struct error *error)
{
    const char *socket = daemon_call_socket(options);
    char *folder = options->operand_count > 1 ? xstrdup(options->operands[1]) : NULL;
    enum exit_status status = folder || !socket ? EXIT_STATUS_DONE : ask_folder(options, socket, &folder, error);

    if (status == EXIT_STATUS_DONE) status = copy(options, option, folder, key, error);
    free(folder);
    return status;
}

enum exit_status command_backup(const struct options *options, struct error *error)
{
    return run(options, "--backup", "backup", error);
}

enum exit_status command_restore(const struct options *options, struct error *error)
{
    return run(options, "--restore", "restored", error);
}
