// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/program/options.h"
#include "cli/program/program_beside.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <stdio.h>

// The daemon's program does it: it knows where the queue lies, and the form of its file.
static enum exit_status run(const struct options *options, const char *option, const char *key, struct error *error)
{
    const char *folder = options->operand_count > 1 ? options->operands[1] : NULL;
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

enum exit_status command_backup(const struct options *options, struct error *error)
{
    return run(options, "--backup", "backup", error);
}

enum exit_status command_restore(const struct options *options, struct error *error)
{
    return run(options, "--restore", "restored", error);
}
