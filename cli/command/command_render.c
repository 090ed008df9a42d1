// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/job/job_document.h"
#include "cli/job/json_set.h"
#include "cli/program/interrupt.h"
#include "cli/program/options.h"
#include "cli/render/output_root.h"
#include "cli/render/preview_path.h"
#include "cli/render/render_session.h"
#include "cli/terminal/print.h"
#include "cli/terminal/progress.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_write.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The output while frames end, and at the end.
struct telling {
    const struct options *options; // borrowed
    const struct job *job;         // borrowed
    struct progress_display display;
    struct json_writer frames; // an array that is closed at the end
    int64_t counts[RENDER_FAILED + 1];
    int64_t missed_count; // published although over the tolerance
    int64_t began_ms;
    // When the first and the latest frame were done, and plans_ms then; 0: none is.
    int64_t first_ms, first_plans_ms, last_ms, last_plans_ms;
    bool knows_worker; // the renderer has been printed
    char phase[16];    // of the frame that is worked on; empty: unknown
    double phase_progress;
    int64_t plan_began_ms;        // of the plan that is being made; 0: none is
    int64_t plans_ms, plan_count; // of the plans that are made
    int64_t planned_frames;       // that one of them serves; 0: unknown
    double foretold_s;            // of a frame's rendering, by the latest plan; 0: unknown
    int64_t foretold_ms;          // when that was known
};

static const double SHORT_S = 0.1;  // no shorter time is foretold
static const double LONG_S = 600.0; // of a frame: from here on it is said what helps

static const char *const outcome_names[] = {"succeeded", "skipped", "failed"};

// Milliseconds of a frame, without plans. Once there are two frames, the first does not count: the worker started and
// linked programs for it.
static double find_frame_ms(const struct telling *telling)
{
    int64_t rendered = telling->counts[RENDER_SUCCEEDED];

    if (rendered == 1) return (double)(telling->first_ms - telling->began_ms - telling->first_plans_ms);
    return (double)(telling->last_ms - telling->first_ms - (telling->last_plans_ms - telling->first_plans_ms)) /
           (double)(rendered - 1);
}

// By the plan, before a frame is done; negative: unknown, as it is when audits take longer than what was foretold.
static double find_foretold_s(const struct telling *telling, int64_t left)
{
    double passed_s = (double)(progress_now_ms() - telling->foretold_ms) / 1000;

    if (!(telling->foretold_s * (double)left > passed_s)) return -1;
    return telling->foretold_s * (double)left - passed_s;
}

// Frames as they went so far, and the plans of the segments that are not begun; negative: unknown.
static double find_eta_s(const struct telling *telling, int64_t total, int64_t left)
{
    int64_t each = telling->planned_frames, plans = 0;
    double plan_ms = 0;

    if (left <= 0) return -1;
    if (telling->counts[RENDER_SUCCEEDED] == 0) return find_foretold_s(telling, left);
    if (telling->plan_count > 0) plan_ms = (double)telling->plans_ms / (double)telling->plan_count;
    if (each > 0) plans = (total + each - 1) / each - (total - left + each - 1) / each;
    return (find_frame_ms(telling) * (double)left + plan_ms * (double)plans) / 1000;
}

static void draw(struct telling *telling, bool is_final)
{
    int64_t total = frame_range_count(&telling->job->frames), rendered = telling->counts[RENDER_SUCCEEDED];
    int64_t left = total - rendered - telling->counts[RENDER_SKIPPED] - telling->counts[RENDER_FAILED];
    double seconds = rendered > 0 ? find_frame_ms(telling) / 1000 : -1;
    const struct progress progress = {.label = telling->job->name,
                                      .total = total,
                                      .done = rendered + telling->counts[RENDER_SKIPPED],
                                      .failed = telling->counts[RENDER_FAILED],
                                      .seconds_per_frame = seconds,
                                      .eta_s = find_eta_s(telling, total, left),
                                      .phase = left > 0 && telling->phase[0] ? telling->phase : NULL,
                                      .phase_progress = telling->phase_progress};

    progress_display_draw(&telling->display, &progress, 1, progress_now_ms(), is_final);
}

static void on_tick(void *user)
{
    draw(user, false);
}

static void on_phase(void *user, const char *phase, double progress)
{
    struct telling *telling = user;

    if (strcmp(phase, "plan") == 0 && telling->plan_began_ms == 0) telling->plan_began_ms = progress_now_ms();
    snprintf(telling->phase, sizeof telling->phase, "%s", phase);
    telling->phase_progress = progress;
}

// Frames whose light was scattered often may take minutes: that is told before. What is left of noise falls with the
// root of the time at most.
static void foretell(struct telling *telling, double plan_s, double render_s)
{
    char *planned = progress_format_duration(plan_s), *frame = progress_format_duration(render_s);

    telling->foretold_s = render_s;
    telling->foretold_ms = progress_now_ms();
    progress_display_clear(&telling->display);
    if (render_s < SHORT_S)
        fprintf(stderr, "planned in %s: a frame's rendering takes less than %g s here\n", planned, SHORT_S);
    else
        fprintf(stderr, "planned in %s: a frame's rendering takes about %s here%s\n", planned, frame,
                render_s < LONG_S ? "" : "; a fourth of that, or less, at twice the tolerance");
    free(planned);
    free(frame);
}

static void on_planned(void *user, int64_t frame_count, double render_s)
{
    struct telling *telling = user;
    int64_t plan_ms = progress_now_ms() - telling->plan_began_ms;

    telling->plans_ms += plan_ms;
    if (render_s > 0) foretell(telling, (double)plan_ms / 1000, render_s);
    telling->plan_began_ms = 0;
    telling->plan_count++;
    if (frame_count > telling->planned_frames) telling->planned_frames = frame_count; // the last segment may be short
    on_phase(telling, "render", 0.0);
}

static void on_worker(void *user, const char *backend, const char *renderer)
{
    struct telling *telling = user;

    if (telling->knows_worker) return;
    telling->knows_worker = true;
    progress_display_clear(&telling->display);
    fprintf(stderr, "rendering with %s: %s\n", backend, renderer);
}

static void on_worker_lost(void *user, const char *why)
{
    struct telling *telling = user;

    progress_display_clear(&telling->display);
    fprintf(stderr, "%s; its frames are tried again\n", why);
}

static void write_result(struct json_writer *writer, const struct render_result *result)
{
    json_write_begin_object(writer);
    json_write_integer_member(writer, "frame", result->frame);
    json_write_string_member(writer, "state", outcome_names[result->outcome]);
    json_write_string_member(writer, "path", result->name);
    if (result->outcome == RENDER_SUCCEEDED) {
        json_write_number_member(writer, "render_s", result->render_s);
        json_write_number_member(writer, "encode_s", result->encode_s);
    }
    if (result->outcome != RENDER_FAILED) {
        json_write_integer_member(writer, "size_bytes", result->size_bytes);
        json_write_string_member(writer, "hash", result->hash);
        frame_accuracy_write(&result->accuracy, writer);
    }
    if (result->error) json_write_string_member(writer, "error", result->error);
    json_write_end_object(writer);
}

static void print_accuracy(const struct frame_accuracy *accuracy)
{
    char text[FRAME_ACCURACY_PHRASE_SIZE];

    frame_accuracy_describe(accuracy, text);
    if (accuracy->audit[0]) printf("  error %s  %s", text, accuracy->method);
    if (accuracy->is_missed) printf("  over the tolerance");
    if (accuracy->has_cut_share) printf("  cut %.3g %%", 100 * accuracy->cut_share);
    if (accuracy->traced > 0.0) printf("  traced %.3g %%", 100 * accuracy->traced);
    putchar('\n');
}

static void print_succeeded(const struct render_result *result)
{
    printf("%s  rendered %.3f s  encoded %.3f s", result->name, result->render_s, result->encode_s);
    print_accuracy(&result->accuracy);
}

static void print_skipped(const struct render_result *result)
{
    printf("%s  was there already", result->name);
    print_accuracy(&result->accuracy);
}

static void note_time(struct telling *telling)
{
    telling->last_ms = progress_now_ms();
    telling->last_plans_ms = telling->plans_ms;
    if (telling->first_ms > 0) return;
    telling->first_ms = telling->last_ms;
    telling->first_plans_ms = telling->last_plans_ms;
}

static void on_result(void *user, const struct render_result *result)
{
    struct telling *telling = user;

    telling->counts[result->outcome]++;
    if (result->outcome == RENDER_SUCCEEDED) note_time(telling);
    telling->missed_count += result->accuracy.is_missed;
    progress_display_clear(&telling->display);
    if (telling->options->json)
        write_result(&telling->frames, result);
    else if (result->outcome == RENDER_SUCCEEDED)
        print_succeeded(result);
    else if (result->outcome == RENDER_SKIPPED)
        print_skipped(result);
    if (result->outcome == RENDER_FAILED) fprintf(stderr, "frame %d failed: %s\n", result->frame, result->error);
    fflush(stdout);
}

static void print_end(struct telling *telling, const char *root)
{
    double wall_s = (double)(progress_now_ms() - telling->began_ms) / 1000;
    struct json_writer writer = {0};

    draw(telling, true);
    json_write_end_array(&telling->frames);
    if (!telling->options->json) return;
    json_write_begin_object(&writer);
    json_write_string_member(&writer, "root", root);
    for (int i = 0; i <= RENDER_FAILED; i++)
        json_write_integer_member(&writer, outcome_names[i], telling->counts[i]);
    json_write_integer_member(&writer, "missed", telling->missed_count);
    json_write_number_member(&writer, "wall_s", wall_s);
    json_write_key(&writer, "frames");
    json_write_raw(&writer, telling->frames.text, telling->frames.length);
    json_write_end_object(&writer);
    print_json_text(&writer);
    json_writer_finish(&writer);
}

// The absolute path of --plan-of; NULL without it.
static bool find_plan_of(const struct options *options, char **path, struct error *error)
{
    if (!options->plan_of) return true;
    if (options->draft) {
        error_set(error, "--plan-of: expected no --draft beside it: a draft has settings of its own");
        return false;
    }
    *path = realpath(options->plan_of, NULL);
    if (*path) return true;
    error_set_errno(error, errno, "--plan-of: %s", options->plan_of);
    return false;
}

// Absolute paths, owned; `plan_of` and `preview` may be NULL.
struct places {
    char *root, *plan_of, *preview;
};

static enum exit_status render(const struct options *options, const struct job *job, const char *document,
                               const struct places *places, struct error *error)
{
    struct telling telling = {.options = options, .job = job, .began_ms = progress_now_ms()};
    struct interrupt interrupt;
    const struct render_session_params params = {.options = options,
                                                 .job = job,
                                                 .document = document,
                                                 .root = places->root,
                                                 .plan_of = places->plan_of,
                                                 .preview = places->preview,
                                                 .interrupt = &interrupt,
                                                 .on_result = on_result,
                                                 .on_tick = on_tick,
                                                 .on_phase = on_phase,
                                                 .on_planned = on_planned,
                                                 .on_worker = on_worker,
                                                 .on_worker_lost = on_worker_lost,
                                                 .user = &telling};
    enum exit_status status;

    progress_display_init(&telling.display, stderr);
    interrupt_init(&interrupt);
    json_write_begin_array(&telling.frames);
    status = render_session_run(&params, error);
    if (!error->message[0]) print_end(&telling, places->root);
    json_writer_finish(&telling.frames);
    interrupt_finish(&interrupt);
    return status;
}

enum exit_status command_render(const struct options *options, struct error *error)
{
    const char *path = options->operands[0];
    char *document = job_document_load(path, options->sets, options->set_count, error);
    enum exit_status status = EXIT_STATUS_USAGE;
    struct job job = {0};
    struct places places = {0};

    if (!document || !find_plan_of(options, &places.plan_of, error)) goto out;
    if (options->preview && !(places.preview = preview_path_check(options->preview, error))) goto out;
    if (options->range && !json_set_text(&document, "frames", options->range, error)) goto out;
    if (options->draft && !json_set_text(&document, "quality", "draft", error)) goto out;
    places.root = output_root_choose(options->out, true, &document, error);
    if (places.root && job_document_check(path, document, places.root, &job, error))
        status = render(options, &job, document, &places, error);
out:
    job_finish(&job);
    free(document);
    free(places.root);
    free(places.plan_of);
    free(places.preview);
    return status;
}
