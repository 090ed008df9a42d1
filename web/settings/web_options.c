// SPDX-License-Identifier: Apache-2.0
#include "web/settings/web_options.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/settings/options_file.h"
#include "core/settings/options_value.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CONNECTION_LIMIT = 16384, PICTURE_WORKER_LIMIT = 4, BUFFER_LEAST = 32 * 1024 * 1024 };

enum option_code {
    OPTION_CONFIG = 256,
    OPTION_CHECK_CONFIG,
    OPTION_SYSTEM,
    OPTION_SOCKET,
    OPTION_LISTEN,
    OPTION_ORIGIN,
    OPTION_PAGE_DIR,
    OPTION_DOCUMENT_DIR,
    OPTION_CHART_FILE,
    OPTION_CONNECTIONS,
    OPTION_ADDRESS_CONNECTIONS,
    OPTION_BUFFER_BYTES,
    OPTION_SEND_TIME,
    OPTION_WORKER_PROGRAM,
    OPTION_CACHE_DIR,
    OPTION_CACHE_BYTES,
    OPTION_PICTURE_WORKERS,
    OPTION_PICTURE_MEMORY,
    OPTION_PICTURE_TIME,
    OPTION_NOTIFY_TARGET,
    OPTION_NOTIFY_WEBHOOKS,
    OPTION_NOTIFY_TIMEOUT,
    OPTION_NOTIFY_KEEP,
    OPTION_LOG_LEVEL,
    OPTION_HELP,
    OPTION_VERSION
};

static const struct option long_options[] = {
    {"config", required_argument, NULL, OPTION_CONFIG},
    {"check-config", no_argument, NULL, OPTION_CHECK_CONFIG},
    {"system", no_argument, NULL, OPTION_SYSTEM},
    {"socket", required_argument, NULL, OPTION_SOCKET},
    {"listen", required_argument, NULL, OPTION_LISTEN},
    {"origin", required_argument, NULL, OPTION_ORIGIN},
    {"page-dir", required_argument, NULL, OPTION_PAGE_DIR},
    {"document-dir", required_argument, NULL, OPTION_DOCUMENT_DIR},
    {"chart-file", required_argument, NULL, OPTION_CHART_FILE},
    {"connections", required_argument, NULL, OPTION_CONNECTIONS},
    {"address-connections", required_argument, NULL, OPTION_ADDRESS_CONNECTIONS},
    {"buffer-bytes", required_argument, NULL, OPTION_BUFFER_BYTES},
    {"send-time", required_argument, NULL, OPTION_SEND_TIME},
    {"worker-program", required_argument, NULL, OPTION_WORKER_PROGRAM},
    {"cache-dir", required_argument, NULL, OPTION_CACHE_DIR},
    {"cache-bytes", required_argument, NULL, OPTION_CACHE_BYTES},
    {"picture-workers", required_argument, NULL, OPTION_PICTURE_WORKERS},
    {"picture-memory", required_argument, NULL, OPTION_PICTURE_MEMORY},
    {"picture-time", required_argument, NULL, OPTION_PICTURE_TIME},
    {"notify-target", required_argument, NULL, OPTION_NOTIFY_TARGET},
    {"notify-webhooks", required_argument, NULL, OPTION_NOTIFY_WEBHOOKS},
    {"notify-timeout", required_argument, NULL, OPTION_NOTIFY_TIMEOUT},
    {"notify-keep", required_argument, NULL, OPTION_NOTIFY_KEEP},
    {"log-level", required_argument, NULL, OPTION_LOG_LEVEL},
    {"help", no_argument, NULL, OPTION_HELP},
    {"version", no_argument, NULL, OPTION_VERSION},
    {NULL, 0, NULL, 0},
};

// Whom mistakes are told to.
struct mistakes {
    web_options_on_mistake *tell;
    void *user;
    size_t count;
};

// A source of options: the command line or the file.
struct setter {
    struct web_options *options;
    struct mistakes *mistakes;
    const char *current_folder; // NULL: paths must be absolute
    bool has_origins;           // the source has set some: it adds more to them
    bool has_targets;           // likewise
};

static bool set_path(const struct setter *setter, char **path, const char *name, const char *text, struct error *error)
{
    size_t length;

    if (!*text || (text[0] != '/' && !setter->current_folder)) {
        error_set(error, "--%s: expected an absolute path, got \"%s\"", name, text);
        return false;
    }
    free(*path);
    *path = text[0] == '/' ? xstrdup(text) : xasprintf("%s/%s", setter->current_folder, text);
    for (length = strlen(*path); length > 1 && (*path)[length - 1] == '/'; length--)
        (*path)[length - 1] = '\0';
    return true;
}

static void drop_origins(struct web_options *options)
{
    for (size_t i = 0; i < options->origin_count; i++)
        free(options->origins[i]);
    free(options->origins);
    options->origins = NULL;
    options->origin_count = options->origin_capacity = 0;
}

// The first origin of a source replaces those of the sources before it.
static void add_origin(struct setter *setter, const char *text)
{
    struct web_options *options = setter->options;

    if (!setter->has_origins) drop_origins(options);
    setter->has_origins = true;
    options->origins =
        xgrow(options->origins, &options->origin_capacity, options->origin_count + 1, sizeof options->origins[0]);
    options->origins[options->origin_count++] = xstrdup(text);
}

// The first target of a source replaces those of the sources before it.
static bool add_target(struct setter *setter, const char *text, struct error *error)
{
    if (!setter->has_targets) notify_targets_finish(&setter->options->notify_targets);
    setter->has_targets = true;
    return notify_targets_add(&setter->options->notify_targets, text, error);
}

static bool set_notify(struct setter *setter, int code, const char *text, struct error *error)
{
    struct web_options *options = setter->options;

    switch (code) {
    case OPTION_NOTIFY_TARGET:
        return add_target(setter, text, error);
    case OPTION_NOTIFY_WEBHOOKS:
        return options_value_switch("notify-webhooks", text, &options->notify_webhooks, error);
    case OPTION_NOTIFY_TIMEOUT:
        return options_value_seconds("notify-timeout", text, 1, &options->notify_timeout_ms, error);
    default:
        return options_value_seconds("notify-keep", text, 1, &options->notify_keep_ms, error);
    }
}

static bool set_picture_option(struct setter *setter, int code, const char *text, struct error *error)
{
    struct web_options *options = setter->options;

    switch (code) {
    case OPTION_WORKER_PROGRAM:
        return set_path(setter, &options->worker_program, "worker-program", text, error);
    case OPTION_CACHE_DIR:
        return set_path(setter, &options->cache_folder, "cache-dir", text, error);
    case OPTION_CACHE_BYTES:
        return options_value_limit("cache-bytes", text, 1024, 0, &options->cache_bytes, error);
    case OPTION_PICTURE_WORKERS:
        return options_value_count("picture-workers", text, PICTURE_WORKER_LIMIT, &options->picture_workers, error);
    case OPTION_PICTURE_MEMORY:
        return options_value_limit("picture-memory", text, 1024, 0, &options->picture_memory_bytes, error);
    default:
        return options_value_seconds("picture-time", text, 1.0, &options->picture_time_ms, error);
    }
}

// One user has a quarter of it, and sends messages of 4 MiB.
static bool set_buffer(struct web_options *options, const char *text, struct error *error)
{
    if (!options_value_limit("buffer-bytes", text, 1024, 0, &options->buffer_bytes, error)) return false;
    if (options->buffer_bytes >= BUFFER_LEAST) return true;
    error_set(error, "--buffer-bytes: expected at least 32M, got \"%s\"", text);
    return false;
}

static bool set_option(struct setter *setter, int code, const char *text, struct error *error)
{
    struct web_options *options = setter->options;

    switch (code) {
    case OPTION_CHECK_CONFIG:
        options->wants_check = true;
        return true;
    case OPTION_SOCKET:
        return set_path(setter, &options->socket_path, "socket", text, error);
    case OPTION_LISTEN:
        free(options->listen);
        options->listen = xstrdup(text);
        return true;
    case OPTION_ORIGIN:
        add_origin(setter, text);
        return true;
    case OPTION_PAGE_DIR:
        return set_path(setter, &options->page_folder, "page-dir", text, error);
    case OPTION_DOCUMENT_DIR:
        return set_path(setter, &options->document_folder, "document-dir", text, error);
    case OPTION_CHART_FILE:
        return set_path(setter, &options->chart_file, "chart-file", text, error);
    case OPTION_CONNECTIONS:
        return options_value_count("connections", text, CONNECTION_LIMIT, &options->connection_limit, error);
    case OPTION_ADDRESS_CONNECTIONS:
        return options_value_count("address-connections", text, CONNECTION_LIMIT, &options->address_limit, error);
    case OPTION_BUFFER_BYTES:
        return set_buffer(options, text, error);
    case OPTION_SEND_TIME:
        return options_value_seconds("send-time", text, 1.0, &options->send_time_ms, error);
    case OPTION_NOTIFY_TARGET:
    case OPTION_NOTIFY_WEBHOOKS:
    case OPTION_NOTIFY_TIMEOUT:
    case OPTION_NOTIFY_KEEP:
        return set_notify(setter, code, text, error);
    case OPTION_LOG_LEVEL:
        return options_value_level(text, &options->log_level, error);
    default:
        return set_picture_option(setter, code, text, error);
    }
}

static bool is_setting(const struct option *option)
{
    return option->has_arg == required_argument && option->val != OPTION_CONFIG;
}

static void fail_unknown(const char *key, struct error *error)
{
    const char *names[OPTION_VERSION - OPTION_CONFIG + 1] = {NULL};
    size_t count = 0;

    for (const struct option *option = long_options; option->name; option++)
        if (is_setting(option)) names[count++] = option->name;
    options_file_fail_key(key, names, "march-web", error);
}

static bool on_setting(void *user, const char *key, const char *value, struct error *error)
{
    struct setter *setter = user;

    for (const struct option *option = long_options; option->name; option++)
        if (is_setting(option) && strcmp(option->name, key) == 0) return set_option(setter, option->val, value, error);
    fail_unknown(key, error);
    return false;
}

static void on_mistake(void *user, const char *mistake)
{
    struct mistakes *mistakes = ((struct setter *)user)->mistakes;

    mistakes->count++;
    mistakes->tell(mistakes->user, mistake);
}

static bool read_file(const struct setter *line, const struct web_surroundings *surroundings, const char *named,
                      bool is_system, struct error *error)
{
    // Paths in a file must be absolute: the current folder may be any.
    struct setter setter = {.options = line->options, .mistakes = line->mistakes};
    struct options_file_handlers handlers = {.on_setting = on_setting, .on_mistake = on_mistake, .user = &setter};
    const struct options_file_place place = {.name = "march-web.conf",
                                             .system_path = surroundings->config_path,
                                             .config_home = surroundings->xdg_config_home,
                                             .home = surroundings->home};
    char **path = &line->options->config_file;

    if (!named) *path = options_file_find(&place, is_system);
    if (named && !set_path(line, path, "config", named, error)) return false;
    if (*path) options_file_read(*path, &handlers);
    return true;
}

// The options that are needed before the others.
struct first_pass {
    const char *config;
    bool is_system;
};

// One pass over the command line. The first, with `first`, only fills that.
static bool parse_line(struct setter *setter, int argc, char **argv, struct first_pass *first, struct error *error)
{
    struct web_options *options = setter->options;
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
        if (code == OPTION_CONFIG && first) first->config = optarg;
        if (code == OPTION_SYSTEM && first) first->is_system = true;
        if (code != OPTION_CONFIG && code != OPTION_SYSTEM && !first && !set_option(setter, code, optarg, error))
            return false;
    }
    if (optind == argc) return true;
    error_set(error, "%s: expected options only, see --help", argv[optind]);
    return false;
}

static void set_picture_defaults(struct web_options *options, const struct web_surroundings *surroundings,
                                 bool is_system)
{
    const char *given = surroundings->cache_directory, *home = surroundings->xdg_cache_home;

    if (!options->worker_program) options->worker_program = xasprintf("%s/march-worker", surroundings->program_folder);
    if (options->cache_folder) return;
    if (given && *given == '/')
        options->cache_folder = xstrdup(given);
    else if (is_system || (!home && !surroundings->home))
        options->cache_folder = xstrdup("/var/cache/marchd-web");
    else if (home && *home == '/')
        options->cache_folder = xasprintf("%s/marchd-web", home);
    else
        options->cache_folder = xasprintf("%s/.cache/marchd-web", surroundings->home);
}

static bool set_defaults(struct web_options *options, const struct web_surroundings *surroundings, bool is_system,
                         struct error *error)
{
    if (!options->listen) options->listen = xstrdup("127.0.0.1:8470");
    if (!options->page_folder) options->page_folder = xasprintf("%s/marchd/page", surroundings->data_folder);
    if (!options->document_folder) options->document_folder = xasprintf("%s/marchd", surroundings->data_folder);
    if (!options->chart_file) options->chart_file = xstrdup("/usr/share/javascript/chart.js/chart.min.js");
    set_picture_defaults(options, surroundings, is_system);
    if (options->socket_path) return true;
    if (is_system)
        options->socket_path = xstrdup("/run/marchd/marchd.sock");
    else if (surroundings->xdg_runtime_dir)
        options->socket_path = xasprintf("%s/marchd.sock", surroundings->xdg_runtime_dir);
    else if (surroundings->xdg_state_home)
        options->socket_path = xasprintf("%s/marchd/marchd.sock", surroundings->xdg_state_home);
    else if (surroundings->home)
        options->socket_path = xasprintf("%s/.local/state/marchd/marchd.sock", surroundings->home);
    if (!options->socket_path) error_set(error, "HOME is not set: expected --socket");
    return options->socket_path;
}

static bool read_all(struct setter *setter, int argc, char **argv, const struct web_surroundings *surroundings,
                     struct error *error)
{
    struct first_pass first = {.is_system = surroundings->is_root};
    const char *socket = surroundings->marchd_socket;

    if (!parse_line(setter, argc, argv, &first, error)) return false;
    if (setter->options->wants_help || setter->options->wants_version) return true;
    if (!read_file(setter, surroundings, first.config, first.is_system, error)) return false;
    if (socket && *socket && !set_path(setter, &setter->options->socket_path, "socket", socket, error)) return false;
    if (!parse_line(setter, argc, argv, NULL, error)) return false;
    return set_defaults(setter->options, surroundings, first.is_system, error);
}

bool web_options_read(struct web_options *options, int argc, char **argv, const struct web_surroundings *surroundings,
                      web_options_on_mistake *tell, void *user)
{
    struct mistakes mistakes = {.tell = tell, .user = user};
    struct setter setter = {.options = options, .mistakes = &mistakes, .current_folder = surroundings->current_folder};
    struct error error = {0};

    *options = (struct web_options){.connection_limit = 1024,
                                    .address_limit = 512,
                                    .buffer_bytes = 256 * 1024 * 1024,
                                    .send_time_ms = 300 * 1000,
                                    .log_level = LOG_INFO,
                                    .notify_timeout_ms = 30 * 1000,
                                    .notify_keep_ms = 24 * 3600 * 1000,
                                    .cache_bytes = INT64_C(1) << 30,
                                    .picture_memory_bytes = INT64_C(1) << 30,
                                    .picture_time_ms = 30000,
                                    .picture_workers = 2};
    if (!read_all(&setter, argc, argv, surroundings, &error)) on_mistake(&setter, error.message);
    if (mistakes.count == 0) return true;
    web_options_finish(options);
    return false;
}

void web_options_finish(struct web_options *options)
{
    free(options->socket_path);
    free(options->listen);
    free(options->page_folder);
    free(options->document_folder);
    free(options->chart_file);
    free(options->worker_program);
    free(options->cache_folder);
    free(options->config_file);
    drop_origins(options);
    notify_targets_finish(&options->notify_targets);
    *options = (struct web_options){0};
}
