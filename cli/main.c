// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/program/options.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

static void print_json_error(const struct error *error)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    json_write_string_member(&writer, "error", error->message);
    json_write_end_object(&writer);
    puts(writer.text);
    json_writer_finish(&writer);
}

static enum exit_status fail_usage(const char *verb, bool wants_json, const struct error *error)
{
    if (verb)
        fprintf(stderr, "march %s: %s\nSee `march %s --help`.\n", verb, error->message, verb);
    else
        fprintf(stderr, "march: %s\nSee `march help`.\n", error->message);
    if (wants_json) print_json_error(error);
    return EXIT_STATUS_USAGE;
}

// Finds --json in arguments that cannot be parsed.
static bool has_json_option(const char *const arguments[], size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(arguments[i], "--json") == 0) return true;
    return false;
}

static enum exit_status run_command(const struct command *command, const char *const arguments[], size_t count)
{
    struct options options = {0};
    struct error error = {0};
    enum exit_status status = EXIT_STATUS_USAGE;

    if (!options_parse(&options, command->options, arguments, count, &error))
        return fail_usage(command->name, has_json_option(arguments, count), &error);
    if (options.help) {
        command_print_help(stdout, command);
        status = EXIT_STATUS_DONE;
    } else if (options.operand_count < command->operand_min || options.operand_count > command->operand_max) {
        error_set(&error, "expected %s", *command->operands ? command->operands : "no operand");
        status = fail_usage(command->name, options.json, &error);
    } else {
        status = command->run(&options, &error);
        if (error.message[0]) fprintf(stderr, "march %s: %s\n", command->name, error.message);
        if (error.message[0] && options.json) print_json_error(&error);
    }
    options_finish(&options);
    return status;
}

int main(int argc, char **argv)
{
    const char *verb = argc > 1 ? argv[1] : NULL;
    const struct command *command;
    struct error error = {0};
    enum exit_status status;

    setlocale(LC_CTYPE, "");
    signal(SIGPIPE, SIG_IGN);
    if (!verb) {
        command_print_overview(stderr);
        return EXIT_STATUS_USAGE;
    }
    if (strcmp(verb, "--help") == 0 || strcmp(verb, "-h") == 0) verb = "help";
    if (strcmp(verb, "--version") == 0) verb = "version";
    command = command_find(verb);
    if (!command) {
        command_fail_unknown(verb, &error);
        return fail_usage(NULL, has_json_option((const char *const *)argv + 2, (size_t)argc - 2), &error);
    }
    status = run_command(command, (const char *const *)argv + 2, (size_t)argc - 2);
    if (fflush(stdout) != 0 && status == EXIT_STATUS_DONE) {
        perror("march: standard output");
        return EXIT_STATUS_FAILED;
    }
    return status;
}
