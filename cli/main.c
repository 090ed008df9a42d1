#include "cli/commands.h"
#include "cli/options.h"
#include "core/error.h"
#include "core/json_write.h"

#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

static enum exit_status fail_usage(const char *verb, const struct error *error)
{
    if (verb)
        fprintf(stderr, "march %s: %s\nSee `march %s --help`.\n", verb, error->message, verb);
    else
        fprintf(stderr, "march: %s\nSee `march help`.\n", error->message);
    return EXIT_STATUS_USAGE;
}

static const struct command *find_command(const char *name, struct error *error)
{
    const struct command *command = command_find(name);
    const char *nearest;

    if (command) return command;
    nearest = command_nearest_name(name);
    if (nearest)
        error_set(error, "unknown verb \"%s\", did you mean \"%s\"?", name, nearest);
    else
        error_set(error, "unknown verb \"%s\"", name);
    return NULL;
}

static void print_error(const struct command *command, const struct options *options, const struct error *error)
{
    struct json_writer writer = {0};

    fprintf(stderr, "march %s: %s\n", command->name, error->message);
    if (!options->json) return;
    json_write_begin_object(&writer);
    json_write_string_member(&writer, "error", error->message);
    json_write_end_object(&writer);
    puts(writer.text);
    json_writer_finish(&writer);
}

static enum exit_status run_command(const struct command *command, const char *const arguments[], size_t count)
{
    struct options options = {0};
    struct error error = {0};
    enum exit_status status = EXIT_STATUS_USAGE;

    if (!options_parse(&options, command->options, arguments, count, &error)) return fail_usage(command->name, &error);
    if (options.help) {
        command_print_help(stdout, command);
        status = EXIT_STATUS_DONE;
    } else if (options.operand_count < command->operand_min || options.operand_count > command->operand_max) {
        error_set(&error, "expected %s", *command->operands ? command->operands : "no operand");
        status = fail_usage(command->name, &error);
    } else {
        status = command->run(&options, &error);
        if (error.message[0]) print_error(command, &options, &error);
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
    command = find_command(verb, &error);
    if (!command) return fail_usage(NULL, &error);
    status = run_command(command, (const char *const *)argv + 2, (size_t)argc - 2);
    if (fflush(stdout) != 0 && status == EXIT_STATUS_DONE) {
        perror("march: standard output");
        return EXIT_STATUS_FAILED;
    }
    return status;
}
