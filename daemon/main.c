// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/base/version.h"
#include "core/json/json_write.h"
#include "daemon/requests/openrpc.h"
#include "daemon/service/config_check.h"
#include "daemon/service/copies.h"
#include "daemon/service/daemon.h"
#include "daemon/service/journal.h"
#include "daemon/service/library_versions.h"
#include "daemon/service/opening.h"
#include "daemon/settings/options.h"
#include "daemon/settings/options_help.h"

#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { EXIT_USAGE = 2 };

// Threads of libuv's pool.
enum { ROOT_THREADS = 12, FREE_THREADS = 20, THREAD_LIMIT = 1024 };

static void find_program_folder(char folder[static PATH_MAX])
{
    ssize_t length = readlink("/proc/self/exe", folder, PATH_MAX - 1);
    char *slash;

    folder[length > 0 ? length : 0] = '\0';
    slash = strrchr(folder, '/');
    if (slash) *slash = '\0';
}

struct command_line {
    int argc;
    char **argv;
    char program_folder[PATH_MAX], current_folder[PATH_MAX];
    struct options_surroundings surroundings;
    char version[64];
};

static void look_around(struct command_line *line)
{
    find_program_folder(line->program_folder);
    if (!getcwd(line->current_folder, sizeof line->current_folder)) strcpy(line->current_folder, "/");
    line->surroundings = (struct options_surroundings){.home = getenv("HOME"),
                                                       .xdg_state_home = getenv("XDG_STATE_HOME"),
                                                       .xdg_config_home = getenv("XDG_CONFIG_HOME"),
                                                       .xdg_runtime_dir = getenv("XDG_RUNTIME_DIR"),
                                                       .marchd_socket = getenv("MARCHD_SOCKET"),
                                                       .config_path = "/etc/marchd/marchd.conf",
                                                       .current_folder = line->current_folder,
                                                       .program_folder = line->program_folder,
                                                       .is_root = geteuid() == 0};
    snprintf(line->version, sizeof line->version, "%s %s", MARCHD_VERSION, version_commit);
}

static bool read_again(void *user, struct options *options, struct error *error)
{
    struct command_line *line = user;

    if (!options_parse(options, line->argc, line->argv, &line->surroundings, error)) return false;
    options->version = line->version;
    return true;
}

static void print_mistake(void *user, const char *mistake)
{
    (void)user;
    fprintf(stderr, "marchd: %s\n", mistake);
}

static void print_openrpc(void)
{
    struct json_writer writer = {0};

    openrpc_write(&writer);
    puts(writer.text);
    json_writer_finish(&writer);
}

static int check_config(const struct options *options)
{
    config_check_print(options, stderr);
    if (options->config_file)
        printf("%s: every setting is right\n", options->config_file);
    else
        printf("there is no file of settings: the defaults hold\n");
    return EXIT_SUCCESS;
}

// An output root that hangs keeps up to twelve threads, a deletion one, looks of nodes two. The environment goes
// before.
static void set_thread_count(const struct options *options)
{
    size_t count = options->output_roots.count * ROOT_THREADS + FREE_THREADS;
    char text[24];

    snprintf(text, sizeof text, "%zu", count < THREAD_LIMIT ? count : THREAD_LIMIT);
    setenv("UV_THREADPOOL_SIZE", text, 0);
}

static int run(struct options *options, struct command_line *line)
{
    struct error error = {0};
    struct daemon *daemon;

    journal_open(getenv("JOURNAL_STREAM"), journal_socket_path);
    log_set_level(options->log_level);
    signal(SIGPIPE, SIG_IGN);
    set_thread_count(options);
    // Settings have just been read, and a start may wait for long; of a terminal the signal means its end.
    if (!isatty(STDERR_FILENO)) signal(SIGHUP, SIG_IGN);
    if (!opening_check_new(options, &error)) {
        log_error("%s", error.message);
        return EXIT_USAGE;
    }
    daemon = daemon_create(options, read_again, line, &error);
    if (!daemon) {
        log_error("%s", error.message);
        return EXIT_FAILURE;
    }
    daemon_run(daemon);
    daemon_destroy(daemon);
    return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    struct command_line line = {.argc = argc, .argv = argv};
    struct options options;
    int status = EXIT_SUCCESS;

    look_around(&line);
    if (!options_read(&options, argc, argv, &line.surroundings, print_mistake, NULL)) return EXIT_USAGE;
    options.version = line.version;
    if (options.wants_help)
        fputs(options_help, stdout);
    else if (options.wants_version) {
        version_print(stdout, "marchd");
        library_versions_print(stdout);
    } else if (options.wants_openrpc)
        print_openrpc();
    else if (options.wants_check)
        status = check_config(&options);
    else if (options.backup_file)
        status = copies_back_up(&options);
    else if (options.restore_file)
        status = copies_restore(&options);
    else
        status = run(&options, &line);
    options_finish(&options);
    return status;
}
