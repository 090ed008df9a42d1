// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_beyond.h"

#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/scene/scene.h"

#include <stdio.h>
#include <string.h>

bool job_beyond_is_told(const struct job_beyond *beyond)
{
    return beyond->is_known || beyond->why[0];
}

bool job_beyond_is_over(const struct job_beyond *beyond, double tolerance)
{
    return beyond->is_known && tolerance > 0.0 && beyond->error > tolerance;
}

void job_beyond_write(const struct job_beyond *beyond, struct json_writer *writer)
{
    if (!job_beyond_is_told(beyond)) return;
    json_write_key(writer, "beyond");
    json_write_begin_object(writer);
    if (beyond->is_known) {
        json_write_number_member(writer, "error", beyond->error);
        json_write_number_member(writer, "error95", beyond->error95);
    } else {
        json_write_string_member(writer, "why", beyond->why);
    }
    json_write_end_object(writer);
}

static bool read(struct job_beyond *beyond, const struct json_node *node, struct error *error)
{
    static const char *const keys[] = {"error", "error95", "why", NULL};
    struct json_node why = json_node_child(node, "why"), value = json_node_child(node, "error");
    struct json_node bound = json_node_child(node, "error95");
    const char *text;

    if (!json_check_object(node, error) || !json_check_keys(node, keys, error)) return false;
    if (json_node_is_absent(&why)) {
        beyond->is_known = true;
        return json_read_number(&value, 0.0, 1.0, &beyond->error, error) &&
               json_read_number(&bound, beyond->error, 1.0, &beyond->error95, error);
    }
    if (!json_node_is_absent(&value) || !json_node_is_absent(&bound))
        return json_fail_expected(&why, error, "a reason, or numbers");
    if (!json_read_string(&why, &text, error)) return false;
    if (!text[0] || strlen(text) >= sizeof beyond->why) return json_fail_expected(&why, error, "a short sentence");
    snprintf(beyond->why, sizeof beyond->why, "%s", text);
    return true;
}

bool job_beyond_read(struct job_beyond *beyond, const struct json_node *object, struct error *error)
{
    struct json_node node = json_node_child(object, "beyond");

    *beyond = (struct job_beyond){0};
    if (json_node_is_absent(&node) || json_node_type(&node) == JSON_NULL || read(beyond, &node, error)) return true;
    *beyond = (struct job_beyond){0};
    return false;
}

void job_beyond_percent(double share, char text[static JOB_BEYOND_PERCENT_SIZE])
{
    snprintf(text, JOB_BEYOND_PERCENT_SIZE, "%.*g", share < 0.995 ? 2 : 3, 100.0 * share);
}

void job_beyond_describe(const struct job_beyond *beyond, int orders, char text[static JOB_BEYOND_TEXT_SIZE])
{
    char modelled[64] = "single scattering leaves", error[JOB_BEYOND_PERCENT_SIZE], bound[JOB_BEYOND_PERCENT_SIZE];

    text[0] = 0;
    if (!job_beyond_is_told(beyond)) return;
    if (orders > 1) snprintf(modelled, sizeof modelled, "%d orders of scattering leave", orders);
    job_beyond_percent(beyond->error, error);
    job_beyond_percent(beyond->error95, bound);
    if (beyond->is_known)
        snprintf(text, JOB_BEYOND_TEXT_SIZE,
                 "%s out %s %% of the picture's light, at most %s %%; scene.scattering.orders \"all\" models it",
                 modelled, error, bound);
    else
        snprintf(text, JOB_BEYOND_TEXT_SIZE, "how much light %s out is not known: %s", modelled, beyond->why);
}
