// SPDX-License-Identifier: Apache-2.0
#include "cli/render/plan_report.h"

#include "cli/peer/worker_child.h"
#include "cli/render/beyond_report.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double number_of(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    double number = 0.0;

    return json_read_number(&node, -HUGE_VAL, HUGE_VAL, &number, NULL) ? number : 0.0;
}

static const char *text_of(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    const char *text;

    return json_read_string(&node, &text, NULL) ? text : "";
}

enum exit_status plan_report_ask(const struct options *options, const char *document, struct message *reply,
                                 struct error *error)
{
    struct json_writer params = {0};
    enum exit_status status;

    json_write_begin_object(&params);
    json_write_key(&params, "document");
    json_write_raw(&params, document, strlen(document));
    json_write_string_member(&params, "root", "/");
    json_write_end_object(&params);
    status =
        worker_child_ask(options,
                         &(struct worker_question){
                             .method = "worker.plan", .params = params.text, .needs_gl = true, .label = "planning"},
                         reply, error);
    json_writer_finish(&params);
    return status;
}

// `folder` goes before the keys: those of an object within the object are told as --set names them.
static void print_numbers(const struct json_node *object, const char *folder)
{
    struct json_node member = {0};

    while (json_node_next(object, &member)) {
        double number;

        if (json_read_number(&member, -HUGE_VAL, HUGE_VAL, &number, NULL))
            printf(", %s%s%s %.3g", folder, folder[0] ? "." : "", member.key, number);
        else if (json_node_type(&member) == JSON_OBJECT)
            print_numbers(&member, member.key);
    }
}

void plan_report_print_quality(const struct json_node *quality)
{
    printf("%s", text_of(quality, "method"));
    print_numbers(quality, "");
    printf("\n");
}

static void print_segment(const struct json_node *plan, int orders)
{
    char left[JOB_BEYOND_TEXT_SIZE];
    struct job_beyond beyond;
    struct json_node quality = json_node_child(plan, "quality");

    printf("  frames %.0f to %.0f   %.3g s a frame (rendering %.2g, audit %.2g, file %.2g), planned in %.2g s; error "
           "%.2g\n    ",
           number_of(plan, "first_frame"), number_of(plan, "last_frame"), number_of(plan, "frame_s"),
           number_of(plan, "render_s"), number_of(plan, "audit_s"), number_of(plan, "encode_s"),
           number_of(plan, "plan_s"), number_of(plan, "error"));
    plan_report_print_quality(&quality);
    printf("    %s\n", text_of(plan, "why"));
    beyond_report_read(plan, &beyond);
    job_beyond_describe(&beyond, orders, left);
    if (left[0]) printf("    %s\n", left);
}

static void print_duration(double seconds)
{
    if (seconds < 120.0)
        printf("%.3g s", seconds);
    else if (seconds < 7200.0)
        printf("%.3g min", seconds / 60.0);
    else
        printf("%.3g h", seconds / 3600.0);
}

void plan_report_find_beyond(const struct json_node *plan, struct job_beyond *beyond)
{
    struct json_node plans = json_node_child(plan, "plans"), first = json_node_element(&plans, 0);

    beyond_report_read(&first, beyond);
}

void plan_report_print(const struct json_node *plan, int orders)
{
    struct json_node plans = json_node_child(plan, "plans"), segment = {0};
    double segments = number_of(plan, "segments");

    printf("Plan for a tolerance of %g\n", number_of(plan, "tolerance"));
    while (json_node_next(&plans, &segment))
        print_segment(&segment, orders);
    if (segments > (double)json_node_count(&plans))
        printf("  (%zu of %.0f segments, each planned when its first frame is rendered)\n", json_node_count(&plans),
               segments);
    printf("  %.3g s a frame and ", number_of(plan, "frame_s"));
    print_duration(number_of(plan, "total_s"));
    printf(" for %.0f frame%s with their plans on one worker like this one; error %.2g\n\n", number_of(plan, "frames"),
           number_of(plan, "frames") == 1.0 ? "" : "s", number_of(plan, "error"));
}
