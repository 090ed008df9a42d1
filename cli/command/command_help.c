// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

enum exit_status command_help(const struct options *options, struct error *error)
{
    const struct command *command;

    if (options->json) {
        struct json_writer writer = {0};

        command_write_overview(&writer);
        print_json_text(&writer);
        json_writer_finish(&writer);
        return EXIT_STATUS_DONE;
    }
    if (options->operand_count == 0) {
        command_print_overview(stdout);
        return EXIT_STATUS_DONE;
    }
    command = command_find(options->operands[0]);
    if (!command) {
        command_fail_unknown(options->operands[0], error);
        return EXIT_STATUS_USAGE;
    }
    command_print_help(stdout, command);
    return EXIT_STATUS_DONE;
}
