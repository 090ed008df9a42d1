// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/program/options.h"
#include "cli/program/program_beside.h"
#include "core/base/version.h"
#include "core/json/json_write.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *own_text(void)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    if (!out) abort();
    version_print(out, "march");
    fclose(out);
    return text;
}

// Cuts the next line off `*text`, and its first word from the rest of it; false at the end.
static bool next_line(char **text, char **name, char **value)
{
    char *line = strsep(text, "\n");

    *value = line;
    *name = strsep(value, " ");
    return *value != NULL;
}

// Members of `text`, as version_print and its program wrote it; the program's name where there is a key for it.
static void write_members(struct json_writer *writer, char *text, const char *program_key)
{
    char *name, *value;

    if (!next_line(&text, &name, &value)) return;
    if (program_key) json_write_string_member(writer, program_key, name);
    json_write_string_member(writer, "version", value);
    if (!next_line(&text, &name, &value)) return;
    json_write_string_member(writer, name, strcmp(value, "unknown") == 0 ? NULL : value);
    json_write_key(writer, "libraries");
    json_write_begin_object(writer);
    while (next_line(&text, &name, &value))
        json_write_string_member(writer, name, value);
    json_write_end_object(writer);
}

static void print_json(char *const texts[], size_t count)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    write_members(&writer, texts[0], NULL);
    json_write_key(&writer, "programs");
    json_write_begin_array(&writer);
    for (size_t i = 1; i < count; i++) {
        if (!texts[i]) continue;
        json_write_begin_object(&writer);
        write_members(&writer, texts[i], "program");
        json_write_end_object(&writer);
    }
    json_write_end_array(&writer);
    json_write_end_object(&writer);
    puts(writer.text);
    json_writer_finish(&writer);
}

enum exit_status command_version(const struct options *options, struct error *error)
{
    char *texts[] = {own_text(), program_beside_ask("march-worker", "--version"),
                     program_beside_ask("marchd", "--version")};
    enum { COUNT = sizeof texts / sizeof *texts };

    if (options->json)
        print_json(texts, COUNT);
    else
        for (size_t i = 0; i < COUNT; i++)
            if (texts[i]) printf("%s%s", i > 0 ? "\n" : "", texts[i]);
    for (size_t i = 0; i < COUNT; i++)
        free(texts[i]);
    return EXIT_STATUS_DONE;
}
