// SPDX-License-Identifier: Apache-2.0
#include "cli/program/options.h"

#include "cli/program/moment.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "core/job/frame_range.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum option_kind { KIND_FLAG, KIND_TEXT, KIND_LIST, KIND_INTEGER, KIND_NUMBER, KIND_FRAMES, KIND_BACKEND, KIND_MOMENT };

struct option_rule {
    const char *name;
    enum option_kind kind;
    size_t offset;
    const char *value; // its name in the help; NULL for a flag
    int64_t min, max;  // for integers
    const char *help;
};

#define FIELD(member) offsetof(struct options, member)

static const struct option_rule rules[OPTION_COUNT] = {
    [OPTION_HELP] = {"help", KIND_FLAG, FIELD(help), NULL, 0, 0, "show this help"},
    [OPTION_JSON] = {"json", KIND_FLAG, FIELD(json), NULL, 0, 0, "print JSON"},
    [OPTION_SOCKET] = {"socket", KIND_TEXT, FIELD(socket), "PATH", 0, 0,
                       "the daemon's socket (default: $MARCHD_SOCKET, else the system's, else your own)"},
    [OPTION_WAIT] = {"wait", KIND_FLAG, FIELD(wait), NULL, 0, 0,
                     "wait until the job has ended, exit code 1 unless it succeeded (drain: until no frame runs)"},
    [OPTION_WATCH] = {"watch", KIND_FLAG, FIELD(watch), NULL, 0, 0, "like --wait, and show progress"},
    [OPTION_DRY_RUN] = {"dry-run", KIND_FLAG, FIELD(dry_run), NULL, 0, 0, "check the job and say what would be done"},
    [OPTION_PAUSED] = {"paused", KIND_FLAG, FIELD(paused), NULL, 0, 0, "queue the job paused"},
    [OPTION_PRIORITY] = {"priority", KIND_INTEGER, FIELD(priority), "N", 0, 200,
                         "0 to 100, and to 200 for administrators; higher goes first"},
    [OPTION_POOL] = {"pool", KIND_TEXT, FIELD(pool), "NAME", 0, 0,
                     "only the workers of this pool, or of those with this tag, render the job"},
    [OPTION_SET] = {"set", KIND_LIST, FIELD(sets), "PATH=VALUE", 0, 0,
                    "change the job, as in camera.position=[0,0,-3]"},
    [OPTION_STATE] = {"state", KIND_TEXT, FIELD(state), "STATE[,STATE]", 0, 0, "only jobs or frames in these states"},
    [OPTION_RANGE] = {"range", KIND_FRAMES, FIELD(range), "RANGE", 0, 0, "the same as --frames"},
    [OPTION_FRAME] = {"frame", KIND_INTEGER, FIELD(frame), "N", 0, INT32_MAX,
                      "only this frame; --frames N is the same"},
    [OPTION_FRAMES] = {"frames", KIND_FRAMES, FIELD(range), "RANGE", 0, 0, "only these frames, as in 1-100x2,140"},
    [OPTION_OUT] = {"out", KIND_TEXT, FIELD(out), "PATH", 0, 0, "where to write (verify: what to check)"},
    [OPTION_BACKEND] = {"backend", KIND_BACKEND, FIELD(backend), "NAME", 0, 0, "auto, egl, osmesa or software"},
    [OPTION_DEVICE] = {"device", KIND_TEXT, FIELD(device), "DEVICE", 0, 0, "EGL device by UUID or index"},
    [OPTION_ENCODE_THREADS] = {"encode-threads", KIND_INTEGER, FIELD(encode_threads), "N", 1, 64,
                               "threads that compress a frame"},
    [OPTION_PROGRESS_LIMIT] = {"progress-limit", KIND_INTEGER, FIELD(progress_limit_s), "SECONDS", 1, 86400,
                               "end a worker that makes no progress for so long (default 120)"},
    [OPTION_WORKER_PROGRAM] = {"worker-program", KIND_TEXT, FIELD(worker_program), "PATH", 0, 0,
                               "march-worker (default: $MARCH_WORKER, else beside march)"},
    [OPTION_SHADER] = {"shader", KIND_FLAG, FIELD(shader), NULL, 0, 0, "print only the shader"},
    [OPTION_SHADER_DIR] = {"shader-dir", KIND_TEXT, FIELD(shader_dir), "FOLDER", 0, 0,
                           "shader modules in place of the built-in ones"},
    [OPTION_COLUMNS] = {"columns", KIND_INTEGER, FIELD(columns), "N", 1, 1000, "pictures in a row"},
    [OPTION_TILE_WIDTH] = {"tile-width", KIND_INTEGER, FIELD(tile_width_px), "PIXELS", 8, 8192, "width of a picture"},
    [OPTION_EXPOSURE] = {"exposure", KIND_NUMBER, FIELD(exposure), "STOPS", 0, 0,
                         "exposure (default: chosen once for all pictures)"},
    [OPTION_FPS] = {"fps", KIND_NUMBER, FIELD(fps), "N", 0, 0,
                    "frames a second of a film (default: the sequence's own)"},
    [OPTION_TOLERANCE] = {"tolerance", KIND_NUMBER, FIELD(tolerance), "E", 0, 0,
                          "largest relative RMSE of a frame (default: what its job states)"},
    [OPTION_METHODS] = {"methods", KIND_TEXT, FIELD(methods), "NAME[,NAME]", 0, 0,
                        "only these methods; NAME:N is only rung N of its ladder"},
    [OPTION_SIZE] = {"size", KIND_TEXT, FIELD(size), "WIDTHxHEIGHT", 0, 0, "pixels (default 320x180)"},
    [OPTION_FILES] = {"files", KIND_FLAG, FIELD(files), NULL, 0, 0, "also remove the files that the jobs published"},
    [OPTION_QUICK] = {"quick", KIND_FLAG, FIELD(quick), NULL, 0, 0, "end within 5 minutes"},
    [OPTION_PLAN] = {"plan", KIND_FLAG, FIELD(plan), NULL, 0, 0,
                     "also plan for the job's tolerance, which renders and takes a while"},
    [OPTION_DRAFT] = {"draft", KIND_FLAG, FIELD(draft), NULL, 0, 0,
                      "a quick look in place of the job's quality: no plan, no measured error"},
    [OPTION_PLAN_OF] = {"plan-of", KIND_TEXT, FIELD(plan_of), "FILE", 0, 0,
                        "plan nothing: render with the settings of this frame of the job, and get the same pixels"},
    [OPTION_PREVIEW] = {"preview", KIND_TEXT, FIELD(preview), "FILE", 0, 0,
                        "show each frame in this .png as it refines, and whole at its end"},
    [OPTION_RECONNECT] = {"reconnect", KIND_INTEGER, FIELD(reconnect_s), "SECONDS", 0, 86400,
                          "wait so long for a daemon that was restarted (default 300; 0: not at all)"},
    [OPTION_ALL] = {"all", KIND_FLAG, FIELD(all), NULL, 0, 0, "all jobs, of all owners"},
    [OPTION_OWNER] = {"owner", KIND_TEXT, FIELD(owner), "NAME", 0, 0, "the jobs of this user"},
    [OPTION_YES] = {"yes", KIND_FLAG, FIELD(yes), NULL, 0, 0, "do it without a question"},
    [OPTION_NODES] = {"nodes", KIND_FLAG, FIELD(nodes), NULL, 0, 0, "a line for each node, not for each worker"},
    [OPTION_NAME] = {"name", KIND_TEXT, FIELD(name), "TEXT", 0, 0, "only jobs with this in their names"},
    [OPTION_SINCE] = {"since", KIND_MOMENT, FIELD(since_s), "AGE|DATE", 0, 0,
                      "only jobs submitted since: 12h, 30d, 2026-03-01, 2026-03-01T18:30"},
    [OPTION_LIMIT] = {"limit", KIND_INTEGER, FIELD(limit), "N", 1, 1000000, "only the N newest, these first"},
    [OPTION_OVER] = {"over", KIND_MOMENT, FIELD(over_s), "AGE|DATE", 0, 0,
                     "only jobs that ended before: 30d, 12h, 2026-03-01"},
    [OPTION_SCOPE] = {"scope", KIND_TEXT, FIELD(scope), "read|submit|admin", 0, 0,
                      "what a token is for: to look; to submit, too; or all that you may"},
    [OPTION_EXPIRES] = {"expires", KIND_TEXT, FIELD(expires), "TIME", 0, 0,
                        "how long a token holds: 12h, 30d, never (default 90d)"},
    [OPTION_URL] = {"url", KIND_TEXT, FIELD(url), "ADDRESS", 0, 0,
                    "where march-web is (default http://127.0.0.1:8470)"},
    [OPTION_PRINT] = {"print", KIND_FLAG, FIELD(print), NULL, 0, 0, "print the address and open nothing"},
    [OPTION_AFTER] = {"after", KIND_TEXT, FIELD(after), "ID[,ID]", 0, 0, "begin the job when these have succeeded"},
    [OPTION_CHAIN] = {"chain", KIND_FLAG, FIELD(chain), NULL, 0, 0,
                      "submit several jobs, each to begin when the one before has succeeded"},
    [OPTION_FORCE] = {"force", KIND_FLAG, FIELD(force), NULL, 0, 0,
                      "render also frames whose files are there, whole and of this job"},
    [OPTION_NOTIFY] = {"notify", KIND_TEXT, FIELD(notify), "NAME:EVENT[,EVENT]", 0, 0,
                       "tell this target of the farm when the job is done, failed, waiting or missed"},
    [OPTION_POINT_LIMIT] = {"point-limit", KIND_INTEGER, FIELD(point_limit_s), "SECONDS", 1, 86400,
                            "longest time of a picture (default 60; with --quick 8)"},
};

// Of a verb that takes one frame, --frames names it, too.
static bool find_rule(const char *name, size_t length, uint64_t accepted, enum option *found)
{
    static const char frames[] = "frames";
    bool takes_one = accepted & OPTION_BIT(OPTION_FRAME) && !(accepted & OPTION_BIT(OPTION_FRAMES));

    if (takes_one && strlen(frames) == length && strncmp(frames, name, length) == 0) length--;
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (!(accepted & OPTION_BIT(i))) continue;
        if (strlen(rules[i].name) != length || strncmp(rules[i].name, name, length) != 0) continue;
        *found = (enum option)i;
        return true;
    }
    return false;
}

static void fail_unknown(const char *argument, size_t length, uint64_t accepted, struct error *error)
{
    const char *names[OPTION_COUNT + 1] = {NULL};
    char *name = xstrndup(argument, length);
    const char *nearest;
    size_t count = 0;

    for (int i = 0; i < OPTION_COUNT; i++)
        if (accepted & OPTION_BIT(i)) names[count++] = rules[i].name;
    nearest = nearest_name_find(name, names);
    if (nearest)
        error_set(error, "unknown option --%s, did you mean --%s?", name, nearest);
    else
        error_set(error, "unknown option --%s", name);
    free(name);
}

static bool set_integer(struct options *options, const struct option_rule *rule, const char *value, struct error *error)
{
    int64_t *field = (int64_t *)((char *)options + rule->offset);
    char *end = NULL;
    long long number;

    errno = 0;
    number = strtoll(value, &end, 10);
    if (errno || end == value || *end || number < rule->min || number > rule->max) {
        error_set(error, "--%s: expected an integer in [%lld, %lld], got \"%s\"", rule->name, (long long)rule->min,
                  (long long)rule->max, value);
        return false;
    }
    *field = number;
    return true;
}

static bool set_number(struct options *options, const struct option_rule *rule, const char *value, struct error *error)
{
    double *field = (double *)((char *)options + rule->offset);
    char *end = NULL;

    *field = strtod(value, &end);
    if (end != value && !*end && isfinite(*field)) return true;
    error_set(error, "--%s: expected a number, got \"%s\"", rule->name, value);
    return false;
}

static bool set_frames(struct options *options, const struct option_rule *rule, const char *value, struct error *error)
{
    struct frame_range range;
    bool ok = frame_range_parse(&range, value, error);

    frame_range_finish(&range);
    if (!ok) error_prefix(error, "--%s", rule->name);
    options->range = value;
    return ok;
}

static bool set_backend(struct options *options, const char *value, struct error *error)
{
    static const char *const names[] = {"auto", "egl", "osmesa", "software"};

    options->backend = value;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(value, names[i]) == 0) return true;
    error_set(error, "--backend: expected auto, egl, osmesa or software, got \"%s\"", value);
    return false;
}

static bool set_moment(struct options *options, const struct option_rule *rule, const char *value, struct error *error)
{
    if (moment_parse(value, time(NULL), (int64_t *)((char *)options + rule->offset), error)) return true;
    error_prefix(error, "--%s", rule->name);
    return false;
}

static bool set_value(struct options *options, const struct option_rule *rule, const char *value, struct error *error)
{
    char *field = (char *)options + rule->offset;

    switch (rule->kind) {
    case KIND_FLAG:
        *(bool *)field = true;
        return true;
    case KIND_TEXT:
        *(const char **)field = value;
        return true;
    case KIND_LIST:
        options->sets[options->set_count++] = value;
        return true;
    case KIND_INTEGER:
        return set_integer(options, rule, value, error);
    case KIND_NUMBER:
        return set_number(options, rule, value, error);
    case KIND_FRAMES:
        return set_frames(options, rule, value, error);
    case KIND_BACKEND:
        return set_backend(options, value, error);
    case KIND_MOMENT:
        return set_moment(options, rule, value, error);
    }
    return false;
}

// Reads the option at arguments[*at] and moves *at to its last argument.
static bool parse_option(struct options *options, uint64_t accepted, const char *const arguments[], size_t count,
                         size_t *at, struct error *error)
{
    const char *name = arguments[*at] + 2;
    size_t length = strcspn(name, "=");
    const char *value = name[length] ? name + length + 1 : NULL;
    enum option option;

    if (strcmp(arguments[*at], "-h") == 0) {
        options->help = true;
        return true;
    }
    if (arguments[*at][1] != '-') {
        error_set(error, "unknown option %s", arguments[*at]);
        return false;
    }
    if (!find_rule(name, length, accepted, &option)) {
        fail_unknown(name, length, accepted, error);
        return false;
    }
    if (rules[option].kind == KIND_FLAG) {
        if (!value) return set_value(options, &rules[option], NULL, error);
        error_set(error, "--%s takes no value", rules[option].name);
        return false;
    }
    if (!value) {
        if (*at + 1 == count) {
            error_set(error, "--%s: expected %s after it", rules[option].name, rules[option].value);
            return false;
        }
        value = arguments[++*at];
    }
    return set_value(options, &rules[option], value, error);
}

bool options_parse(struct options *options, uint64_t accepted, const char *const arguments[], size_t count,
                   struct error *error)
{
    bool has_ended = false;

    *options = (struct options){.priority = -1,
                                .frame = -1,
                                .encode_threads = -1,
                                .progress_limit_s = -1,
                                .columns = -1,
                                .tile_width_px = -1,
                                .point_limit_s = -1,
                                .reconnect_s = -1,
                                .limit = -1,
                                .since_s = -1,
                                .over_s = -1};
    options->exposure = options->fps = options->tolerance = NAN;
    options->sets = xcalloc(count + 1, sizeof *options->sets);
    options->operands = xcalloc(count + 1, sizeof *options->operands);
    for (size_t i = 0; i < count; i++) {
        const char *argument = arguments[i];

        if (has_ended || argument[0] != '-' || !argument[1]) {
            options->operands[options->operand_count++] = argument;
        } else if (strcmp(argument, "--") == 0) {
            has_ended = true;
        } else if (!parse_option(options, accepted, arguments, count, &i, error)) {
            options_finish(options);
            return false;
        }
    }
    return true;
}

void options_finish(struct options *options)
{
    free(options->sets);
    free(options->operands);
    memset(options, 0, sizeof *options);
}

const char *option_name(enum option option)
{
    return rules[option].name;
}

const char *option_value(enum option option)
{
    return rules[option].value;
}

const char *option_help(enum option option)
{
    return rules[option].help;
}

void options_print_help(FILE *out, uint64_t accepted)
{
    for (int i = 0; i < OPTION_COUNT; i++) {
        char left[64];

        if (!(accepted & OPTION_BIT(i))) continue;
        snprintf(left, sizeof left, "--%s%s%s", rules[i].name, rules[i].value ? " " : "",
                 rules[i].value ? rules[i].value : "");
        fprintf(out, "  %-24s  %s\n", left, rules[i].help);
    }
}

bool options_parse_id(const char *text, int64_t *id, struct error *error)
{
    size_t digits = strspn(text, "0123456789");

    *id = digits > 0 && digits < 19 && !text[digits] ? strtoll(text, NULL, 10) : 0;
    if (*id > 0) return true;
    error_set(error, "expected a job id such as 7, got \"%s\"", text);
    return false;
}
