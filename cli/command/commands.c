// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"

#include "cli/program/options.h"
#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "core/json/json_write.h"

#include <stdbool.h>
#include <string.h>

#define BIT(name) OPTION_BIT(OPTION_##name)
#define EVERY (BIT(HELP) | BIT(JSON))
#define DAEMON (EVERY | BIT(SOCKET))
#define WORKER (EVERY | BIT(WORKER_PROGRAM))
#define FRAMES (BIT(FRAMES) | BIT(RANGE))                      // two words for one thing
#define CHOICE (BIT(ALL) | BIT(OWNER) | BIT(STATE) | BIT(YES)) // of jobs, in place of ids
#define RENDERER (WORKER | BIT(BACKEND) | BIT(DEVICE) | BIT(SHADER_DIR))

enum { ANY = 1 << 20 };

// The verbs that ask a daemon come first.
static const struct command commands[] = {
    {"submit", "JOB...", 1, ANY,
     DAEMON | BIT(AFTER) | BIT(CHAIN) | BIT(WAIT) | BIT(WATCH) | BIT(RECONNECT) | BIT(DRY_RUN) | FRAMES | BIT(SET) |
         BIT(DRAFT) | BIT(PAUSED) | BIT(PRIORITY) | BIT(POOL) | BIT(NOTIFY),
     "Hands a job file (- for standard input) to the daemon and prints the job's id.",
     "march submit --watch --frames 0-99 jobs/cloud.json", command_submit},
    {"list", "", 0, 0, DAEMON | BIT(STATE) | BIT(OWNER) | BIT(NAME) | BIT(SINCE) | BIT(LIMIT), "Lists the jobs.",
     "march list --state running,queued --since 12h", command_list},
    {"show", "ID", 1, 1, DAEMON, "Shows a job.", "march show 7", command_show},
    {"frames", "ID", 1, 1, DAEMON | BIT(STATE) | FRAMES, "Lists a job's frames.", "march frames 7 --state failed",
     command_frames},
    {"log", "ID", 1, 1, DAEMON | BIT(FRAME), "Prints the messages of attempts that have ended, the newest last.",
     "march log 7 --frame 120", command_log},
    {"watch", "[ID...]", 0, ANY, DAEMON | BIT(RECONNECT),
     "Shows the progress of these jobs until they have ended, or of all jobs.", "march watch 7", command_watch},
    {"wait", "ID...", 1, ANY, DAEMON | BIT(RECONNECT),
     "Waits until the jobs have ended; exit code 1 unless all succeeded.", "march wait 7 8", command_wait},
    {"pause", "[ID...]", 0, ANY, DAEMON | CHOICE, "Starts no more frames of the jobs until they are resumed.",
     "march pause 7", command_pause},
    {"resume", "[ID...]", 0, ANY, DAEMON | CHOICE, "Resumes paused jobs.", "march resume 7", command_resume},
    {"cancel", "[ID...]", 0, ANY, DAEMON | CHOICE, "Cancels jobs; files already published stay.", "march cancel 7",
     command_cancel},
    {"retry", "ID", 1, 1, DAEMON | BIT(STATE) | FRAMES | BIT(FORCE),
     "Queues frames again: the failed ones, or those in --state.", "march retry 7 --state succeeded,canceled --force",
     command_retry},
    {"prio", "ID PRIORITY", 2, 2, DAEMON,
     "Sets a job's priority, 0 to 100; higher goes first. Administrators may go up to 200.", "march prio 7 80",
     command_prio},
    {"delete", "[ID...]", 0, ANY, DAEMON | CHOICE | BIT(OVER) | BIT(FILES),
     "Deletes jobs that have ended; the files that they published stay, unless --files is given.",
     "march delete --over 30d --state succeeded", command_delete},
    {"workers", "", 0, 0, DAEMON | BIT(NODES), "Lists the workers and what they run on.", "march workers --nodes",
     command_workers},
    {"status", "", 0, 0, DAEMON, "Shows how the daemon is: its jobs, roots, and how long the turns of its loop are.",
     "march status", command_status},
    {"metrics", "", 0, 0, DAEMON, "Prints what the daemon counts, as text that Prometheus reads.",
     "march metrics | promtool check metrics", command_metrics},
    {"drain", "", 0, 0, DAEMON | BIT(WAIT),
     "Has the daemon finish the frames that run and begin none, until `march undrain` or a restart; for "
     "administrators.",
     "march drain --wait", command_drain},
    {"undrain", "", 0, 0, DAEMON, "Ends `march drain`: frames are begun again.", "march undrain", command_undrain},
    {"reload", "", 0, 0, DAEMON,
     "Has the daemon read its settings again; exit code 1, and nothing changes, if one is wrong; for administrators.",
     "march reload", command_reload},
    {"token", "create|list|revoke [NAME|TOKEN...]", 1, ANY, DAEMON | BIT(SCOPE) | BIT(EXPIRES),
     "Makes, lists or revokes tokens, with which programs act as you; `create` prints the token (--scope is read "
     "unless given).",
     "march token create dashboard --scope read --expires 30d", command_token},
    {"web", "", 0, 0, DAEMON | BIT(SCOPE) | BIT(URL) | BIT(PRINT),
     "Opens the farm's page in your browser, signed in by a token for one use (--scope is submit unless given).",
     "march web", command_web},
    {"backup", "FILE [STATE-FOLDER]", 1, 2, DAEMON,
     "Copies the daemon's queue to a file of mode 0600, while the daemon runs or not; for its user and root.",
     "march backup /var/backups/marchd-queue.db", command_backup},
    {"restore", "FILE [STATE-FOLDER]", 1, 2, DAEMON,
     "Puts such a copy in place of the queue of a daemon that is stopped; the old one is kept beside it.",
     "march restore /var/backups/marchd-queue.db", command_restore},
    {"validate", "FILE...", 1, ANY, EVERY | BIT(SET), "Checks job files.",
     "march validate jobs/cloud.json jobs/fog.json", command_validate},
    {"render", "JOB", 1, 1,
     RENDERER | FRAMES | BIT(DRAFT) | BIT(PLAN_OF) | BIT(PREVIEW) | BIT(SET) | BIT(OUT) | BIT(ENCODE_THREADS) |
         BIT(PROGRESS_LIMIT),
     "Renders a job here, without a daemon, into the current folder or to --out.",
     "march render jobs/cloud.json --frames 0-239x60 --out /tmp/cloud.####.exr", command_render},
    {"explain", "JOB", 1, 1, RENDERER | BIT(SET) | BIT(SHADER) | BIT(PLAN),
     "Says at once what the renderer models for the scene, what it leaves out, and why, and counts the work.",
     "march explain jobs/cloud.json --shader", command_explain},
    {"chart", "JOB", 1, 1,
     RENDERER | BIT(FRAME) | BIT(METHODS) | BIT(SIZE) | BIT(QUICK) | BIT(POINT_LIMIT) | BIT(OUT) | BIT(SET),
     "Measures seconds and error of every method that can render a frame of the job, and draws one against the other.",
     "march chart jobs/cloud.json --frame 48 --quick --out /tmp/chart", command_chart},
    {"preview", "DIR|PATTERN|FILE...", 1, ANY,
     WORKER | FRAMES | BIT(OUT) | BIT(COLUMNS) | BIT(TILE_WIDTH) | BIT(EXPOSURE) | BIT(FPS),
     "Makes a contact sheet (.png) or a film (.mp4) of a sequence, in one exposure.",
     "march preview cloud --out sheet.png", command_preview},
    {"verify", "DIR|JOB", 1, 1, WORKER | FRAMES | BIT(SET) | BIT(OUT) | BIT(TOLERANCE),
     "Checks a sequence: all frames are there, whole, of one job and within its tolerance; exit code 1 if not.",
     "march verify first --frames 0-47", command_verify},
    {"completion", "SHELL", 1, ANY, EVERY, "Prints the completion script for bash, zsh or fish.",
     "march completion bash", command_completion},
    {"version", "", 0, 0, EVERY, "Prints the version, the commit and the libraries of march, march-worker and marchd.",
     "march version", command_version},
    {"help", "[VERB]", 0, 1, EVERY, "Explains a verb.", "march help submit", command_help},
};

enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

const struct command *command_find(const char *name)
{
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(commands[i].name, name) == 0) return &commands[i];
    return NULL;
}

const struct command *command_at(size_t index)
{
    return index < COMMAND_COUNT ? &commands[index] : NULL;
}

void command_fail_unknown(const char *name, struct error *error)
{
    const char *names[COMMAND_COUNT + 1] = {NULL};
    const char *nearest;

    for (size_t i = 0; i < COMMAND_COUNT; i++)
        names[i] = commands[i].name;
    nearest = nearest_name_find(name, names);
    if (nearest)
        error_set(error, "unknown verb \"%s\", did you mean \"%s\"?", name, nearest);
    else
        error_set(error, "unknown verb \"%s\"", name);
}

void command_print_help(FILE *out, const struct command *command)
{
    fprintf(out, "usage: march %s%s%s [OPTION...]\n\n%s\n\n", command->name, *command->operands ? " " : "",
            command->operands, command->summary);
    options_print_help(out, command->options);
    fprintf(out, "\nExample:\n  %s\n", command->example);
}

void command_print_overview(FILE *out)
{
    bool is_local = false;

    fputs("usage: march VERB [OPTION...]\n\nWith a daemon:\n", out);
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        if (!is_local && !(commands[i].options & BIT(SOCKET))) {
            is_local = true;
            fputs("\nWithout:\n", out);
        }
        fprintf(out, "  %-10s %-15s %s\n", commands[i].name, commands[i].operands, commands[i].summary);
    }
    fputs("\n`march VERB --help` lists the options of a verb.\n"
          "Exit codes: 0 done, 1 the work failed, 2 wrong usage or job file, 3 no daemon, 4 not allowed,\n"
          "130 interrupted.\n",
          out);
}

void command_write_overview(struct json_writer *writer)
{
    json_write_begin_object(writer);
    json_write_key(writer, "verbs");
    json_write_begin_array(writer);
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        json_write_begin_object(writer);
        json_write_string_member(writer, "name", commands[i].name);
        json_write_string_member(writer, "operands", commands[i].operands);
        json_write_string_member(writer, "summary", commands[i].summary);
        json_write_end_object(writer);
    }
    json_write_end_array(writer);
    json_write_end_object(writer);
}
