// SPDX-License-Identifier: Apache-2.0
#include "cli/command/completion.h"

#include "cli/chart/chart_ladder.h"
#include "cli/command/commands.h"
#include "cli/program/options.h"
#include "core/base/alloc.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char *const job_states[] = {"queued", "running", "paused", "succeeded", "failed", "canceled", NULL};
static const char *const frame_states[] = {"queued", "running", "succeeded", "failed", "canceled", "skipped", NULL};
static const char *const backends[] = {"auto", "egl", "osmesa", "software", NULL};
static const char *const scopes[] = {"read", "submit", "admin", NULL};
static const char *const token_words[] = {"create", "list", "revoke", NULL};
static const char *const shells[] = {"bash", "zsh", "fish", NULL};

struct typing {
    FILE *out;
    const char *before; // borrowed; precedes each word written: "--state=running,"
    const char *begun;  // borrowed; the typed part of the word
};

static void offer(const struct typing *typing, const char *word, const char *what)
{
    if (strncmp(word, typing->begun, strlen(typing->begun)) != 0) return;
    fprintf(typing->out, "%s%s\t%s\n", typing->before, word, what);
}

// Offers a name, or the next one in a list with commas.
static void offer_names(const struct typing *typing, const char *const names[], const char *what)
{
    const char *comma = strrchr(typing->begun, ',');
    size_t kept = comma ? (size_t)(comma + 1 - typing->begun) : 0;
    char *before = xasprintf("%s%.*s", typing->before, (int)kept, typing->begun);
    struct typing last = {typing->out, before, typing->begun + kept};

    for (size_t i = 0; names[i]; i++)
        offer(&last, names[i], what);
    free(before);
}

static void offer_methods(const struct typing *typing)
{
    const char **names = xcalloc(chart_ladder_count() + 2, sizeof *names);
    size_t count = 0;

    for (size_t i = 0; i < chart_ladder_count(); i++)
        if (count == 0 || strcmp(names[count - 1], chart_ladder_method(i)) != 0)
            names[count++] = chart_ladder_method(i);
    names[count] = CHART_PLANNED;
    offer_names(typing, names, "method");
    free(names);
}

static void offer_verbs(const struct typing *typing)
{
    const struct command *command;

    for (size_t i = 0; (command = command_at(i)); i++)
        offer(typing, command->name, command->summary);
}

static void offer_options(const struct typing *typing, const struct command *command)
{
    for (int i = 0; i < OPTION_COUNT; i++) {
        char *name;

        if (!(command->options & OPTION_BIT(i))) continue;
        name = xasprintf("--%s", option_name((enum option)i));
        offer(typing, name, option_help((enum option)i));
        free(name);
    }
}

static void offer_value(const struct typing *typing, const struct command *command, enum option option)
{
    switch (option) {
    case OPTION_STATE:
        offer_names(typing, strcmp(command->name, "list") == 0 ? job_states : frame_states, "state");
        return;
    case OPTION_SCOPE:
        offer_names(typing, scopes, "scope");
        return;
    case OPTION_BACKEND:
        offer_names(typing, backends, "backend");
        return;
    case OPTION_METHODS:
        offer_methods(typing);
        return;
    case OPTION_SOCKET:
    case OPTION_OUT:
    case OPTION_PREVIEW:
    case OPTION_WORKER_PROGRAM:
        fputs(":files\n", typing->out);
        return;
    case OPTION_SHADER_DIR:
        fputs(":folders\n", typing->out);
        return;
    default:
        return;
    }
}

// Finds the kind of an operand by its name in the help.
static void offer_operand(const struct typing *typing, const struct command *command, size_t at,
                          completion_write_ids *write_ids)
{
    const char *operands = command->operands;

    if (at >= command->operand_max) return;
    if (strcmp(command->name, "token") == 0) {
        if (at == 0) offer_names(typing, token_words, "tokens");
    } else if (strstr(operands, "ID") && (at == 0 || strstr(operands, "ID..."))) {
        fflush(typing->out);
        write_ids(typing->out, command->name);
    } else if (strcmp(operands, "[VERB]") == 0) {
        offer_verbs(typing);
    } else if (strcmp(operands, "SHELL") == 0) {
        offer_names(typing, shells, "shell");
    } else if (strstr(operands, "DIR") || strstr(operands, "PATTERN")) {
        fputs(":files\n", typing->out);
    } else if (strstr(operands, "JOB") || strstr(operands, "FILE")) {
        fputs(":json\n", typing->out);
    }
}

static bool find_option(const struct command *command, const char *word, size_t length, enum option *found)
{
    for (int i = 0; i < OPTION_COUNT; i++) {
        const char *name = option_name((enum option)i);

        if (!(command->options & OPTION_BIT(i)) || !option_value((enum option)i)) continue;
        if (strlen(name) != length || strncmp(name, word, length) != 0) continue;
        *found = (enum option)i;
        return true;
    }
    return false;
}

struct position {
    bool has_option; // the typed word is its value
    enum option option;
    bool has_ended; // after "--" there are only operands
    size_t operand_count;
};

// Reads the words before the one that is typed.
static void find_position(struct position *position, const struct command *command, const char *const words[],
                          size_t count)
{
    *position = (struct position){.has_option = false};
    for (size_t i = 0; i < count; i++) {
        if (position->has_option && strcmp(words[i], "=") == 0) continue;
        if (position->has_option) {
            position->has_option = false;
        } else if (!position->has_ended && strcmp(words[i], "--") == 0) {
            position->has_ended = true;
        } else if (!position->has_ended && strncmp(words[i], "--", 2) == 0) {
            position->has_option = find_option(command, words[i] + 2, strlen(words[i] + 2), &position->option);
        } else {
            position->operand_count++;
        }
    }
}

void completion_write(FILE *out, const char *const words[], size_t count, completion_write_ids *write_ids)
{
    const char *typed = count > 0 ? words[count - 1] : "", *equals = strchr(typed, '=');
    const struct command *command = count > 1 ? command_find(words[0]) : NULL;
    struct typing typing = {out, "", typed};
    struct position position;
    enum option option;

    if (count <= 1) offer_verbs(&typing);
    if (!command) return;
    find_position(&position, command, words + 1, count - 2);
    if (position.has_option) {
        if (strcmp(typed, "=") == 0) typing.begun = "";
        offer_value(&typing, command, position.option);
    } else if (!position.has_ended && equals && strncmp(typed, "--", 2) == 0) {
        char *before = xstrndup(typed, (size_t)(equals + 1 - typed));

        typing.before = before;
        typing.begun = equals + 1;
        if (find_option(command, typed + 2, (size_t)(equals - typed) - 2, &option))
            offer_value(&typing, command, option);
        free(before);
    } else if (!position.has_ended && typed[0] == '-') {
        offer_options(&typing, command);
    } else {
        offer_operand(&typing, command, position.operand_count, write_ids);
    }
}
