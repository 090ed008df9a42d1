// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/options.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/settings/options_file.h"
#include "core/settings/options_value.h"
#include "daemon/settings/options_amount.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum option_code {
    OPTION_CONFIG = 256,
    OPTION_CHECK_CONFIG,
    OPTION_SYSTEM,
    OPTION_STATE,
    OPTION_SOCKET,
    OPTION_OUTPUT_ROOT,
    OPTION_INPUT_ROOT,
    OPTION_WORKERS,
    OPTION_THREADS,
    OPTION_BACKEND,
    OPTION_WORKER_PROGRAM,
    OPTION_SHADER_DIR,
    OPTION_MAX_ATTEMPTS,
    OPTION_PROGRESS_LIMIT,
    OPTION_FRAME_LIMIT,
    OPTION_STOP_TIMEOUT,
    OPTION_ADMIN_GROUP,
    OPTION_WEB_USER,
    OPTION_USER_JOBS,
    OPTION_USER_FRAMES,
    OPTION_USER_PIXELS,
    OPTION_USER_DISK,
    OPTION_KEEP_JOBS,
    OPTION_KEEP_DAYS,
    OPTION_KEEP_BYTES,
    OPTION_USER_WEIGHT,
    OPTION_POOL,
    OPTION_LAUNCH_SOCKET,
    OPTION_NOTIFY,
    OPTION_HALF_LIFE,
    OPTION_LONGEST_WAIT,
    OPTION_WORKER_MEMORY,
    OPTION_SANDBOX,
    OPTION_LOG_LEVEL,
    OPTION_NEW_STORE,
    OPTION_BACKUP,
    OPTION_RESTORE,
    OPTION_OPENRPC,
    OPTION_HELP,
    OPTION_VERSION
};

static const struct option long_options[] = {
    {"config", required_argument, NULL, OPTION_CONFIG},
    {"check-config", no_argument, NULL, OPTION_CHECK_CONFIG},
    {"system", no_argument, NULL, OPTION_SYSTEM},
    {"state", required_argument, NULL, OPTION_STATE},
    {"socket", required_argument, NULL, OPTION_SOCKET},
    {"output-root", required_argument, NULL, OPTION_OUTPUT_ROOT},
    {"input-root", required_argument, NULL, OPTION_INPUT_ROOT},
    {"workers", required_argument, NULL, OPTION_WORKERS},
    {"threads", required_argument, NULL, OPTION_THREADS},
    {"backend", required_argument, NULL, OPTION_BACKEND},
    {"worker-program", required_argument, NULL, OPTION_WORKER_PROGRAM},
    {"shader-dir", required_argument, NULL, OPTION_SHADER_DIR},
    {"max-attempts", required_argument, NULL, OPTION_MAX_ATTEMPTS},
    {"progress-limit", required_argument, NULL, OPTION_PROGRESS_LIMIT},
    {"frame-limit", required_argument, NULL, OPTION_FRAME_LIMIT},
    {"stop-timeout", required_argument, NULL, OPTION_STOP_TIMEOUT},
    {"admin-group", required_argument, NULL, OPTION_ADMIN_GROUP},
    {"web-user", required_argument, NULL, OPTION_WEB_USER},
    {"user-jobs", required_argument, NULL, OPTION_USER_JOBS},
    {"user-frames", required_argument, NULL, OPTION_USER_FRAMES},
    {"user-pixels", required_argument, NULL, OPTION_USER_PIXELS},
    {"user-disk", required_argument, NULL, OPTION_USER_DISK},
    {"keep-jobs", required_argument, NULL, OPTION_KEEP_JOBS},
    {"keep-days", required_argument, NULL, OPTION_KEEP_DAYS},
    {"keep-bytes", required_argument, NULL, OPTION_KEEP_BYTES},
    {"user-weight", required_argument, NULL, OPTION_USER_WEIGHT},
    {"pool", required_argument, NULL, OPTION_POOL},
    {"launch-socket", required_argument, NULL, OPTION_LAUNCH_SOCKET},
    {"notify", required_argument, NULL, OPTION_NOTIFY},
    {"half-life", required_argument, NULL, OPTION_HALF_LIFE},
    {"longest-wait", required_argument, NULL, OPTION_LONGEST_WAIT},
    {"worker-memory", required_argument, NULL, OPTION_WORKER_MEMORY},
    {"sandbox", required_argument, NULL, OPTION_SANDBOX},
    {"log-level", required_argument, NULL, OPTION_LOG_LEVEL},
    {"new-store", no_argument, NULL, OPTION_NEW_STORE},
    {"backup", required_argument, NULL, OPTION_BACKUP},
    {"restore", required_argument, NULL, OPTION_RESTORE},
    {"openrpc", no_argument, NULL, OPTION_OPENRPC},
    {"help", no_argument, NULL, OPTION_HELP},
    {"version", no_argument, NULL, OPTION_VERSION},
    {NULL, 0, NULL, 0},
};

// Whom mistakes are told to.
struct mistakes {
    options_on_mistake *tell;
    void *user;
    size_t count;
};

// A source of options: the command line or the file.
struct setter {
    struct options *options;
    struct mistakes *mistakes;
    const char *current_folder; // NULL: paths must be absolute
    bool has_output_roots, has_input_roots, has_weights, has_pools,
        has_notify; // the source has set such values: it adds more to them
};

static bool set_path(const struct setter *setter, char **path, const char *name, const char *text, struct error *error)
{
    char *made = options_value_path(name, text, setter->current_folder, error);

    if (!made) return false;
    free(*path);
    *path = made;
    return true;
}

// The first path of a source replaces the paths of the sources before it.
static bool add_path(const struct setter *setter, struct path_list *list, bool *has_given, const char *name,
                     const char *text, struct error *error)
{
    char *made = options_value_path(name, text, setter->current_folder, error);

    if (!made) return false;
    if (!*has_given) path_list_finish(list);
    *has_given = true;
    path_list_add(list, made);
    return true;
}

// The first weight of a source replaces the weights of the sources before it.
static bool add_weight(struct setter *setter, const char *text, struct error *error)
{
    if (!setter->has_weights) user_weights_finish(&setter->options->user_weights);
    setter->has_weights = true;
    return user_weights_add(&setter->options->user_weights, text, error);
}

// The first pool of a source replaces the pools of the sources before it.
static bool add_pool(struct setter *setter, const char *text, struct error *error)
{
    if (!setter->has_pools) pool_table_finish(&setter->options->pools);
    setter->has_pools = true;
    return pool_table_add(&setter->options->pools, text, error);
}

// The first rule of a source replaces the rules of the sources before it.
static bool add_notify(struct setter *setter, const char *text, struct error *error)
{
    if (!setter->has_notify) job_notify_finish(&setter->options->notify);
    setter->has_notify = true;
    if (job_notify_parse(&setter->options->notify, text, error)) return true;
    error_prefix(error, "--notify");
    return false;
}

static bool set_folder(struct setter *setter, int code, const char *text, struct error *error)
{
    struct options *options = setter->options;

    switch (code) {
    case OPTION_STATE:
        return set_path(setter, &options->state_folder, "state", text, error);
    case OPTION_SOCKET:
        return set_path(setter, &options->socket_path, "socket", text, error);
    case OPTION_OUTPUT_ROOT:
        return add_path(setter, &options->output_roots, &setter->has_output_roots, "output-root", text, error);
    case OPTION_INPUT_ROOT:
        return add_path(setter, &options->input_roots, &setter->has_input_roots, "input-root", text, error);
    case OPTION_WORKER_PROGRAM:
        return set_path(setter, &options->worker_program, "worker-program", text, error);
    case OPTION_LAUNCH_SOCKET:
        return set_path(setter, &options->launch_socket, "launch-socket", text, error);
    case OPTION_BACKUP:
        return set_path(setter, &options->backup_file, "backup", text, error);
    case OPTION_RESTORE:
        return set_path(setter, &options->restore_file, "restore", text, error);
    default:
        return set_path(setter, &options->shader_folder, "shader-dir", text, error);
    }
}

#define AMOUNT(field) offsetof(struct options, field)

static const struct options_amount amounts[] = {
    {OPTION_USER_JOBS, "user-jobs", AMOUNT(user_jobs), 1000},
    {OPTION_USER_FRAMES, "user-frames", AMOUNT(user_frames), 1000},
    {OPTION_USER_PIXELS, "user-pixels", AMOUNT(user_pixels), 1000},
    {OPTION_USER_DISK, "user-disk", AMOUNT(user_disk_bytes), 1024},
    {OPTION_KEEP_JOBS, "keep-jobs", AMOUNT(keep_jobs), 1000},
    {OPTION_KEEP_DAYS, "keep-days", AMOUNT(keep_ms), 0},
    {OPTION_KEEP_BYTES, "keep-bytes", AMOUNT(keep_bytes), 1024},
};

static bool set_option(struct setter *setter, int code, const char *text, struct error *error)
{
    struct options *options = setter->options;

    switch (code) {
    case OPTION_NEW_STORE:
        options->may_be_new = true;
        return true;
    case OPTION_CHECK_CONFIG:
        options->wants_check = true;
        return true;
    case OPTION_WORKERS:
        return options_value_workers(text, &options->worker_count, error);
    case OPTION_THREADS:
        return options_value_count("threads", text, 1024, &options->thread_count, error);
    case OPTION_MAX_ATTEMPTS:
        return options_value_count("max-attempts", text, 100, &options->max_attempts, error);
    case OPTION_STOP_TIMEOUT:
        return options_value_seconds("stop-timeout", text, 0, &options->stop_timeout_ms, error);
    case OPTION_FRAME_LIMIT:
        return options_value_seconds("frame-limit", text, 1, &options->frame_limit_ms, error);
    case OPTION_PROGRESS_LIMIT:
        return options_value_seconds("progress-limit", text, 1, &options->progress_limit_ms, error);
    case OPTION_BACKEND:
        return options_value_backend(text, &options->backend, error);
    case OPTION_ADMIN_GROUP:
        return options_value_name("admin-group", text, false, &options->admin_group, error);
    case OPTION_WEB_USER:
        return options_value_name("web-user", text, true, &options->web_user, error);
    case OPTION_USER_JOBS:
    case OPTION_USER_FRAMES:
    case OPTION_USER_PIXELS:
    case OPTION_USER_DISK:
    case OPTION_KEEP_JOBS:
    case OPTION_KEEP_DAYS:
    case OPTION_KEEP_BYTES:
        return options_amount_read(amounts, code, text, options, error);
    case OPTION_USER_WEIGHT:
        return add_weight(setter, text, error);
    case OPTION_POOL:
        return add_pool(setter, text, error);
    case OPTION_NOTIFY:
        return add_notify(setter, text, error);
    case OPTION_HALF_LIFE:
        return options_value_seconds("half-life", text, 1, &options->half_life_ms, error);
    case OPTION_LONGEST_WAIT:
        return options_value_seconds("longest-wait", text, 1, &options->longest_wait_ms, error);
    case OPTION_WORKER_MEMORY:
        return options_value_memory("worker-memory", text, &options->worker_memory_bytes, error);
    case OPTION_SANDBOX:
        return options_value_switch("sandbox", text, &options->has_sandbox, error);
    case OPTION_LOG_LEVEL:
        return options_value_level(text, &options->log_level, error);
    default:
        return set_folder(setter, code, text, error);
    }
}

static void set_default_roots(struct options *options, bool is_system, const char *home)
{
    if (options->output_roots.count == 0)
        path_list_add(&options->output_roots, is_system ? xstrdup("/srv/marchd") : xasprintf("%s/marchd", home));
    if (options->input_roots.count > 0) return;
    path_list_add(&options->input_roots, xstrdup(is_system ? "/srv/marchd-input" : "/"));
    if (is_system) path_list_add(&options->input_roots, xstrdup("/usr/share"));
}

static bool set_defaults(struct options *options, const struct options_surroundings *surroundings, bool is_system,
                         struct error *error)
{
    const char *home = surroundings->home;

    if (!options->worker_program) options->worker_program = xasprintf("%s/march-worker", surroundings->program_folder);
    if (!options->admin_group) options->admin_group = xstrdup(OPTIONS_ADMIN_GROUP);
    if (!options->web_user) options->web_user = xstrdup(OPTIONS_WEB_USER);
    if (!is_system && !home && (!options->state_folder || options->output_roots.count == 0)) {
        error_set(error, "HOME is not set: expected --state and --output-root");
        return false;
    }
    set_default_roots(options, is_system, home);
    if (!options->state_folder) {
        options->state_folder = is_system                      ? xstrdup("/var/lib/marchd")
                                : surroundings->xdg_state_home ? xasprintf("%s/marchd", surroundings->xdg_state_home)
                                                               : xasprintf("%s/.local/state/marchd", home);
    }
    if (!options->socket_path) {
        options->socket_path = is_system ? xstrdup("/run/marchd/marchd.sock")
                               : surroundings->xdg_runtime_dir
                                   ? xasprintf("%s/marchd.sock", surroundings->xdg_runtime_dir)
                                   : xasprintf("%s/marchd.sock", options->state_folder);
    }
    return true;
}

static bool is_setting(const struct option *option)
{
    return option->has_arg == required_argument && option->val != OPTION_CONFIG && option->val != OPTION_BACKUP &&
           option->val != OPTION_RESTORE;
}

static void fail_unknown(const char *key, struct error *error)
{
    const char *names[OPTION_VERSION - OPTION_CONFIG + 1] = {NULL};
    size_t count = 0;

    for (const struct option *option = long_options; option->name; option++)
        if (is_setting(option)) names[count++] = option->name;
    options_file_fail_key(key, names, "marchd", error);
}

// Sets the option that has the name `key`.
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

static bool read_file(const struct setter *line, const struct options_surroundings *surroundings, const char *named,
                      bool is_system, struct error *error)
{
    // Paths in a file must be absolute: the current folder may be any.
    struct setter setter = {.options = line->options, .mistakes = line->mistakes};
    struct options_file_handlers handlers = {.on_setting = on_setting, .on_mistake = on_mistake, .user = &setter};
    const struct options_file_place place = {.name = "marchd.conf",
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
    struct options *options = setter->options;
    int code;

    optind = 0;
    opterr = 0;
    while ((code = getopt_long(argc, argv, "+:", long_options, NULL)) != -1) {
        if (code == OPTION_HELP) options->wants_help = true;
        if (code == OPTION_VERSION) options->wants_version = true;
        if (code == OPTION_OPENRPC) options->wants_openrpc = true;
        if (code == OPTION_HELP || code == OPTION_VERSION || code == OPTION_OPENRPC) return true;
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

static bool read_all(struct setter *setter, int argc, char **argv, const struct options_surroundings *surroundings,
                     struct error *error)
{
    struct options *options = setter->options;
    struct first_pass first = {.is_system = surroundings->is_root};
    const char *socket = surroundings->marchd_socket;

    if (!parse_line(setter, argc, argv, &first, error)) return false;
    if (options->wants_help || options->wants_version || options->wants_openrpc) return true;
    if (!read_file(setter, surroundings, first.config, first.is_system, error)) return false;
    if (socket && *socket && !set_path(setter, &options->socket_path, "socket", socket, error)) return false;
    if (!parse_line(setter, argc, argv, NULL, error)) return false;
    return set_defaults(options, surroundings, first.is_system, error);
}

bool options_read(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                  options_on_mistake *tell, void *user)
{
    struct mistakes mistakes = {.tell = tell, .user = user};
    struct setter setter = {.options = options, .mistakes = &mistakes, .current_folder = surroundings->current_folder};
    struct error error = {0};

    *options = (struct options){.thread_count = 1,
                                .max_attempts = 3,
                                .stop_timeout_ms = 30000,
                                .progress_limit_ms = 120000,
                                .frame_limit_ms = 24 * 3600 * 1000,
                                .user_jobs = 1000,
                                .half_life_ms = 3600 * 1000,
                                .longest_wait_ms = 24 * 3600 * 1000,
                                .user_frames = 1000000,
                                .has_sandbox = true,
                                .log_level = LOG_INFO,
                                .backend = xstrdup("auto")};
    if (!read_all(&setter, argc, argv, surroundings, &error)) on_mistake(&setter, error.message);
    if (mistakes.count == 0) return true;
    options_finish(options);
    return false;
}

// What options_parse keeps of the mistakes.
struct first_mistake {
    struct error error;
    size_t more;
};

static void keep_first(void *user, const char *mistake)
{
    struct first_mistake *first = user;

    if (first->error.message[0])
        first->more++;
    else
        error_set(&first->error, "%s", mistake);
}

bool options_parse(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                   struct error *error)
{
    struct first_mistake first = {0};

    if (options_read(options, argc, argv, surroundings, keep_first, &first)) return true;
    if (first.more > 0)
        error_set(error, "%s (and %zu more: marchd --check-config)", first.error.message, first.more);
    else
        error_set(error, "%s", first.error.message);
    return false;
}

void options_finish(struct options *options)
{
    free(options->state_folder);
    free(options->socket_path);
    free(options->launch_socket);
    path_list_finish(&options->output_roots);
    path_list_finish(&options->input_roots);
    free(options->worker_program);
    free(options->shader_folder);
    free(options->backend);
    free(options->admin_group);
    free(options->web_user);
    free(options->backup_file);
    free(options->restore_file);
    free(options->config_file);
    user_weights_finish(&options->user_weights);
    pool_table_finish(&options->pools);
    job_notify_finish(&options->notify);
    *options = (struct options){0};
}
