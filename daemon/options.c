#include "daemon/options.h"

#include "core/alloc.h"
#include "core/error.h"
#include "daemon/options_file.h"

#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char options_help[] =
    "usage: marchd [options]\n"
    "\n"
    "Takes jobs over a unix socket, keeps them in a durable queue and feeds their frames to workers.\n"
    "\n"
    "  --config PATH           settings read from there: a line `KEY = VALUE` each, keys as the options below\n"
    "                          (root: /etc/marchd/marchd.conf, if it is there)\n"
    "  --state DIR             where the queue is kept (root: /var/lib/marchd, else $XDG_STATE_HOME/marchd)\n"
    "  --socket PATH           where clients connect (root: /run/marchd/marchd.sock, else "
    "$XDG_RUNTIME_DIR/marchd.sock)\n"
    "  --output-root DIR       the folder that no output leaves (root: /srv/marchd, else ~/marchd)\n"
    "  --workers N|auto        worker processes (auto: one a core)\n"
    "  --threads N             threads one worker renders with (1)\n"
    "  --backend NAME          auto, egl or osmesa (auto)\n"
    "  --worker-program PATH   the worker (march-worker beside marchd)\n"
    "  --shader-dir DIR        shaders read from there instead of the worker's own\n"
    "  --max-attempts N        attempts a frame has before it is failed (3)\n"
    "  --progress-limit SECONDS  a worker that makes no progress for so long is killed (120)\n"
    "  --stop-timeout SECONDS  what running frames get to finish when the daemon stops (30)\n"
    "  --log-level LEVEL       debug, info, warning or error (info)\n"
    "  --help, --version\n"
    "\n"
    "The command line counts before the environment, that before the file. MARCHD_SOCKET in the environment stands for "
    "--socket.\n"
    "SIGTERM stops in order, a second one at once.\n";

enum option_code {
    OPTION_CONFIG = 256,
    OPTION_STATE,
    OPTION_SOCKET,
    OPTION_OUTPUT_ROOT,
    OPTION_WORKERS,
    OPTION_THREADS,
    OPTION_BACKEND,
    OPTION_WORKER_PROGRAM,
    OPTION_SHADER_DIR,
    OPTION_MAX_ATTEMPTS,
    OPTION_PROGRESS_LIMIT,
    OPTION_STOP_TIMEOUT,
    OPTION_LOG_LEVEL,
    OPTION_HELP,
    OPTION_VERSION
};

static const struct option long_options[] = {
    {"config", required_argument, NULL, OPTION_CONFIG},
    {"state", required_argument, NULL, OPTION_STATE},
    {"socket", required_argument, NULL, OPTION_SOCKET},
    {"output-root", required_argument, NULL, OPTION_OUTPUT_ROOT},
    {"workers", required_argument, NULL, OPTION_WORKERS},
    {"threads", required_argument, NULL, OPTION_THREADS},
    {"backend", required_argument, NULL, OPTION_BACKEND},
    {"worker-program", required_argument, NULL, OPTION_WORKER_PROGRAM},
    {"shader-dir", required_argument, NULL, OPTION_SHADER_DIR},
    {"max-attempts", required_argument, NULL, OPTION_MAX_ATTEMPTS},
    {"progress-limit", required_argument, NULL, OPTION_PROGRESS_LIMIT},
    {"stop-timeout", required_argument, NULL, OPTION_STOP_TIMEOUT},
    {"log-level", required_argument, NULL, OPTION_LOG_LEVEL},
    {"help", no_argument, NULL, OPTION_HELP},
    {"version", no_argument, NULL, OPTION_VERSION},
    {NULL, 0, NULL, 0},
};

static bool parse_integer(const char *name, const char *text, long min, long max, long *integer, struct error *error)
{
    char *end = NULL;

    errno = 0;
    *integer = strtol(text, &end, 10);
    if (errno == 0 && end != text && !*end && *integer >= min && *integer <= max) return true;
    error_set(error, "--%s: expected a whole number from %ld to %ld, got \"%s\"", name, min, max, text);
    return false;
}

static bool parse_count(const char *name, const char *text, long max, int *count, struct error *error)
{
    long integer;

    if (!parse_integer(name, text, 1, max, &integer, error)) return false;
    *count = (int)integer;
    return true;
}

static bool parse_seconds(const char *name, const char *text, double min, int64_t *ms, struct error *error)
{
    char *end = NULL;
    double seconds = strtod(text, &end);

    if (end != text && !*end && seconds >= min && seconds <= 86400) {
        *ms = (int64_t)(seconds * 1000);
        return true;
    }
    error_set(error, "--%s: expected seconds from %g to 86400, got \"%s\"", name, min, text);
    return false;
}

static bool parse_workers(const char *text, int *count, struct error *error)
{
    *count = 0;
    if (strcmp(text, "auto") == 0) return true;
    if (parse_count("workers", text, 1024, count, NULL)) return true;
    error_set(error, "--workers: expected \"auto\" or a whole number from 1 to 1024, got \"%s\"", text);
    return false;
}

static bool parse_backend(const char *text, char **backend, struct error *error)
{
    if (strcmp(text, "auto") != 0 && strcmp(text, "egl") != 0 && strcmp(text, "osmesa") != 0) {
        error_set(error, "--backend: expected auto, egl or osmesa, got \"%s\"", text);
        return false;
    }
    free(*backend);
    *backend = xstrdup(text);
    return true;
}

static bool parse_level(const char *text, enum log_level *level, struct error *error)
{
    static const char *const names[] = {"debug", "info", "warning", "error"};

    for (int i = 0; i < 4; i++) {
        if (strcmp(text, names[i]) != 0) continue;
        *level = (enum log_level)i;
        return true;
    }
    error_set(error, "--log-level: expected debug, info, warning or error, got \"%s\"", text);
    return false;
}

static bool set_path(char **path, const char *name, const char *text, const struct options_surroundings *surroundings,
                     struct error *error)
{
    if (!*text) {
        error_set(error, "--%s: expected a path, got nothing", name);
        return false;
    }
    if (text[0] != '/' && !surroundings->current_folder) {
        error_set(error, "--%s: expected an absolute path, got \"%s\"", name, text);
        return false;
    }
    free(*path);
    *path = text[0] == '/' ? xstrdup(text) : xasprintf("%s/%s", surroundings->current_folder, text);
    for (size_t length = strlen(*path); length > 1 && (*path)[length - 1] == '/'; length--)
        (*path)[length - 1] = '\0';
    return true;
}

static bool set_option(struct options *options, int code, const char *text,
                       const struct options_surroundings *surroundings, struct error *error)
{
    switch (code) {
    case OPTION_STATE:
        return set_path(&options->state_folder, "state", text, surroundings, error);
    case OPTION_SOCKET:
        return set_path(&options->socket_path, "socket", text, surroundings, error);
    case OPTION_OUTPUT_ROOT:
        return set_path(&options->output_root, "output-root", text, surroundings, error);
    case OPTION_WORKER_PROGRAM:
        return set_path(&options->worker_program, "worker-program", text, surroundings, error);
    case OPTION_SHADER_DIR:
        return set_path(&options->shader_folder, "shader-dir", text, surroundings, error);
    case OPTION_WORKERS:
        return parse_workers(text, &options->worker_count, error);
    case OPTION_THREADS:
        return parse_count("threads", text, 1024, &options->thread_count, error);
    case OPTION_MAX_ATTEMPTS:
        return parse_count("max-attempts", text, 100, &options->max_attempts, error);
    case OPTION_STOP_TIMEOUT:
        return parse_seconds("stop-timeout", text, 0, &options->stop_timeout_ms, error);
    case OPTION_PROGRESS_LIMIT:
        return parse_seconds("progress-limit", text, 1, &options->progress_limit_ms, error);
    case OPTION_BACKEND:
        return parse_backend(text, &options->backend, error);
    default:
        return parse_level(text, &options->log_level, error);
    }
}

static bool set_defaults(struct options *options, const struct options_surroundings *surroundings, struct error *error)
{
    const char *home = surroundings->home;

    if (!surroundings->is_root && !home && (!options->state_folder || !options->output_root)) {
        error_set(error, "there is no HOME: expected --state and --output-root");
        return false;
    }
    if (!options->state_folder) {
        options->state_folder = surroundings->is_root          ? xstrdup("/var/lib/marchd")
                                : surroundings->xdg_state_home ? xasprintf("%s/marchd", surroundings->xdg_state_home)
                                                               : xasprintf("%s/.local/state/marchd", home);
    }
    if (!options->output_root)
        options->output_root = surroundings->is_root ? xstrdup("/srv/marchd") : xasprintf("%s/marchd", home);
    if (!options->socket_path) {
        options->socket_path = surroundings->is_root ? xstrdup("/run/marchd/marchd.sock")
                               : surroundings->xdg_runtime_dir
                                   ? xasprintf("%s/marchd.sock", surroundings->xdg_runtime_dir)
                                   : xasprintf("%s/marchd.sock", options->state_folder);
    }
    return true;
}

struct setting_reader {
    struct options *options;
    struct options_surroundings surroundings;
};

// As the option of that name would set it.
static bool on_setting(void *user, const char *key, const char *value, struct error *error)
{
    const struct setting_reader *reader = user;

    for (const struct option *option = long_options; option->name; option++)
        if (option->has_arg == required_argument && option->val != OPTION_CONFIG && strcmp(option->name, key) == 0)
            return set_option(reader->options, option->val, value, &reader->surroundings, error);
    error_set(error, "%s: there is no such setting, see marchd --help", key);
    return false;
}

static bool read_file(struct options *options, const char *named, const struct options_surroundings *surroundings,
                      struct error *error)
{
    struct setting_reader reader = {.options = options, .surroundings = *surroundings};
    const char *path = named ? named : surroundings->config_path;

    if (!path || (!named && access(path, F_OK) != 0)) return true;
    // Whoever starts the daemon stands anywhere.
    reader.surroundings.current_folder = NULL;
    return options_file_read(path, on_setting, &reader, error);
}

// One pass over the command line: the first, with `named`, looks for what goes before all else.
static bool parse_line(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                       const char **named, struct error *error)
{
    int code;

    optind = 0;
    opterr = 0;
    while ((code = getopt_long(argc, argv, "+:", long_options, NULL)) != -1) {
        if (code == OPTION_HELP) options->wants_help = true;
        if (code == OPTION_VERSION) options->wants_version = true;
        if (code == OPTION_HELP || code == OPTION_VERSION) return true;
        if (code == '?' || code == ':') {
            error_set(error, code == ':' ? "%s: expected a value after it" : "%s: there is no such option, see --help",
                      argv[optind - 1]);
            return false;
        }
        if (code == OPTION_CONFIG && named) *named = optarg;
        if (code != OPTION_CONFIG && !named && !set_option(options, code, optarg, surroundings, error)) return false;
    }
    if (optind == argc) return true;
    error_set(error, "%s: expected options only, see --help", argv[optind]);
    return false;
}

static bool read_all(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                     struct error *error)
{
    const char *named = NULL, *socket = surroundings->marchd_socket;

    if (!parse_line(options, argc, argv, surroundings, &named, error)) return false;
    if (options->wants_help || options->wants_version) return true;
    if (!read_file(options, named, surroundings, error)) return false;
    if (socket && *socket && !set_path(&options->socket_path, "socket", socket, surroundings, error)) return false;
    if (!parse_line(options, argc, argv, surroundings, NULL, error)) return false;
    if (!options->worker_program) options->worker_program = xasprintf("%s/march-worker", surroundings->program_folder);
    return set_defaults(options, surroundings, error);
}

bool options_parse(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                   struct error *error)
{
    *options = (struct options){.thread_count = 1,
                                .max_attempts = 3,
                                .stop_timeout_ms = 30000,
                                .progress_limit_ms = 120000,
                                .log_level = LOG_INFO,
                                .backend = xstrdup("auto")};
    if (read_all(options, argc, argv, surroundings, error)) return true;
    options_finish(options);
    return false;
}

void options_finish(struct options *options)
{
    free(options->state_folder);
    free(options->socket_path);
    free(options->output_root);
    free(options->worker_program);
    free(options->shader_folder);
    free(options->backend);
    *options = (struct options){0};
}
