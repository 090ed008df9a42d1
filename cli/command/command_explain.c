// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/job/job_document.h"
#include "cli/peer/worker_child.h"
#include "cli/program/options.h"
#include "cli/render/beyond_report.h"
#include "cli/render/plan_report.h"
#include "cli/render/unseen_report.h"
#include "cli/terminal/print.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_warnings.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FEATURE_WIDTH = 28 }; // the least

static const char *text_of(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    const char *text;

    return json_read_string(&node, &text, NULL) ? text : "";
}

static void print_features(const struct json_node *result, const char *key, const char *title)
{
    struct json_node features = json_node_child(result, key), feature = {0}, line = {0};
    size_t width = FEATURE_WIDTH;

    if (json_node_count(&features) == 0) return;
    printf("%s\n", title);
    while (json_node_next(&features, &feature))
        if (strlen(text_of(&feature, "feature")) > width) width = strlen(text_of(&feature, "feature"));
    while (json_node_next(&features, &line))
        printf("  %-*s %s\n", (int)width, text_of(&line, "feature"), text_of(&line, "why"));
    printf("\n");
}

static void print_modules(const struct json_node *result)
{
    struct json_node modules = json_node_child(result, "modules"), module = {0};
    const char *name;

    if (json_node_count(&modules) == 0) return;
    printf("Shader modules\n");
    while (json_node_next(&modules, &module))
        if (json_read_string(&module, &name, NULL)) printf("  %s\n", name);
    printf("\n");
}

static double number_of(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    double number = 0.0;

    return json_read_number(&node, -HUGE_VAL, HUGE_VAL, &number, NULL) ? number : 0.0;
}

// What is known of the cost without rendering anything.
static void print_count(const struct json_node *result, const struct job *job)
{
    struct json_node counted = json_node_child(result, "counted"), quality = json_node_child(&counted, "quality");
    struct json_node methods = json_node_child(&counted, "methods"), method = {0};
    double each = number_of(&counted, "evaluations"), pixels = number_of(&counted, "pixels");

    printf("Counted, not measured\n");
    if (job->quality.method == JOB_METHOD_AUTO)
        printf("  a tolerance of %g: its method is planned when frames are rendered, or here with --plan;\n"
               "  below stands what a draft takes\n",
               job->quality.tolerance);
    if (!json_node_is_absent(&quality)) {
        printf("  ");
        plan_report_print_quality(&quality);
    }
    if (each > 0.0)
        printf("  %.2g evaluations of densities a pixel, %.2g a frame, %.2g for all %.0f frames, at most\n", each,
               each * pixels, each * pixels * number_of(&counted, "frames"), number_of(&counted, "frames"));
    if (json_node_count(&methods) > 0)
        printf("  evaluations for one sample, by method, in 64 steps through the media:");
    for (const char *gap = " "; json_node_next(&methods, &method); gap = ", ")
        printf("%s%s %.2g", gap, text_of(&method, "method"), number_of(&method, "evaluations"));
    printf("\n\n");
}

static void print_explanation(const struct json_node *result, const struct job *job)
{
    struct json_node bytes = json_node_child(result, "uniform_bytes"), plan = json_node_child(result, "plan");
    int64_t uniform_bytes = 0;

    if (json_node_is_absent(&plan))
        print_count(result, job);
    else
        plan_report_print(&plan, job->scene.orders);
    print_features(result, "modelled", "Modelled");
    print_features(result, "not_modelled", "Not modelled");
    print_modules(result);
    json_read_integer(&bytes, 0, INT32_MAX, &uniform_bytes, NULL);
    printf("Shader %s, %zu bytes, %" PRId64 " bytes of uniforms a frame (--shader prints it)\n",
           text_of(result, "shader_hash"), strlen(text_of(result, "shader")), uniform_bytes);
}

static enum exit_status ask(const struct options *options, const char *document, bool is_planned, struct message *reply,
                            struct error *error)
{
    struct json_writer params = {0};
    enum exit_status status;

    json_write_begin_object(&params);
    json_write_key(&params, "document");
    json_write_raw(&params, document, strlen(document));
    json_write_string_member(&params, "root", "/");
    json_write_bool_member(&params, "plan", is_planned);
    json_write_end_object(&params);
    status = worker_child_ask(options,
                              &(struct worker_question){.method = "worker.explain",
                                                        .params = params.text,
                                                        .needs_gl = is_planned,
                                                        .label = is_planned ? "planning" : NULL},
                              reply, error);
    json_writer_finish(&params);
    return status;
}

// Before a plan, which takes a while, what is known at once is printed.
static enum exit_status explain(const struct options *options, const struct job *job, const char *document,
                                struct error *error)
{
    bool is_planned = options->plan && job->quality.method == JOB_METHOD_AUTO;
    enum exit_status status = EXIT_STATUS_DONE;
    struct job_beyond beyond;
    struct message reply;

    if (is_planned && !options->json && !options->shader) {
        status = ask(options, document, false, &reply, error);
        if (status != EXIT_STATUS_DONE) return status;
        print_count(&reply.body, job);
        fflush(stdout);
        message_finish(&reply);
    }
    status = ask(options, document, is_planned, &reply, error);
    if (status != EXIT_STATUS_DONE) return status;
    if (options->json)
        print_json(&reply.body);
    else if (options->shader)
        fputs(text_of(&reply.body, "shader"), stdout);
    else
        print_explanation(&reply.body, job);
    beyond_report_read(&reply.body, &beyond);
    beyond_report_warn(&beyond, job);
    message_finish(&reply);
    return status;
}

static void print_warning(void *user, const char *text)
{
    (void)user;
    fprintf(stderr, "warning: %s\n", text);
}

enum exit_status command_explain(const struct options *options, struct error *error)
{
    char *document = job_document_load(options->operands[0], options->sets, options->set_count, error);
    enum exit_status status = EXIT_STATUS_USAGE;
    struct job job = {0};

    if (document && job_document_check(options->operands[0], document, "/", &job, error)) {
        job_warnings_find(&job, print_warning, NULL);
        unseen_report_find(options, &job, document, print_warning, NULL);
        status = explain(options, &job, document, error);
    }
    job_finish(&job);
    free(document);
    return status;
}
