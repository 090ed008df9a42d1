// SPDX-License-Identifier: Apache-2.0
#include "core/wire/frame_accuracy.h"

#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <limits.h>
#include <stdint.h>
#include <stdio.h>

static const double ERROR_LIMIT = 1e300;

bool frame_accuracy_is_over(const struct frame_accuracy *accuracy, double tolerance)
{
    return tolerance > 0.0 && accuracy->audit[0] && accuracy->error > tolerance;
}

void frame_accuracy_describe(const struct frame_accuracy *accuracy, char text[static FRAME_ACCURACY_PHRASE_SIZE])
{
    double error = 100.0 * accuracy->error, most = 100.0 * accuracy->error95;

    if (error > 0.0 || !(most > 0.0))
        snprintf(text, FRAME_ACCURACY_PHRASE_SIZE, "%.2g %% (95 %%: below %.2g %%)", error, most);
    else
        snprintf(text, FRAME_ACCURACY_PHRASE_SIZE, "at most %.2g %% (with 95 %%)", most);
}

void frame_accuracy_write(const struct frame_accuracy *accuracy, struct json_writer *writer)
{
    if (accuracy->audit[0]) {
        json_write_string_member(writer, "audit", accuracy->audit);
        json_write_number_member(writer, "measured_error", accuracy->error);
        json_write_number_member(writer, "error95", accuracy->error95);
        json_write_integer_member(writer, "audit_rays", accuracy->audit_rays);
        json_write_string_member(writer, "method", accuracy->method);
        if (accuracy->plan > 0) json_write_integer_member(writer, "plan", accuracy->plan);
        if (accuracy->is_missed) json_write_bool_member(writer, "missed", true);
    }
    if (accuracy->has_cut_share) json_write_number_member(writer, "cut_share", accuracy->cut_share);
    if (accuracy->traced > 0.0) json_write_number_member(writer, "traced", accuracy->traced);
}

static bool is_known(const struct json_node *node)
{
    return !json_node_is_absent(node) && json_node_type(node) != JSON_NULL;
}

static bool read_text(const struct json_node *object, const char *key, char text[static FRAME_ACCURACY_TEXT_SIZE],
                      struct error *error)
{
    struct json_node node = json_node_child(object, key);
    const char *found;

    if (!json_read_string(&node, &found, error)) return false;
    if (snprintf(text, FRAME_ACCURACY_TEXT_SIZE, "%s", found) < FRAME_ACCURACY_TEXT_SIZE) return true;
    return json_fail_expected(&node, error, "a short name");
}

static bool read_audit(struct frame_accuracy *accuracy, const struct json_node *object, struct error *error)
{
    static const char *const audits[] = {"reference", "step_halving", NULL};
    struct json_node audit = json_node_child(object, "audit");
    struct json_node measured = json_node_child(object, "measured_error"), bound = json_node_child(object, "error95");
    struct json_node rays = json_node_child(object, "audit_rays"), missed = json_node_child(object, "missed");
    struct json_node plan = json_node_child(object, "plan");
    int64_t ray_count;
    int choice;

    if (!is_known(&audit)) return true;
    if (!json_read_enum(&audit, audits, &choice, error) ||
        !json_read_number(&measured, 0, ERROR_LIMIT, &accuracy->error, error) ||
        !json_read_number(&bound, 0, ERROR_LIMIT, &accuracy->error95, error) ||
        !json_read_integer(&rays, 0, INT_MAX, &ray_count, error) ||
        !read_text(object, "method", accuracy->method, error) ||
        (is_known(&plan) && !json_read_integer(&plan, 1, INT64_MAX, &accuracy->plan, error)) ||
        (is_known(&missed) && !json_read_bool(&missed, &accuracy->is_missed, error)))
        return false;
    snprintf(accuracy->audit, sizeof accuracy->audit, "%s", audits[choice]);
    accuracy->audit_rays = (int)ray_count;
    return true;
}

bool frame_accuracy_read(struct frame_accuracy *accuracy, const struct json_node *object, struct error *error)
{
    struct json_node share = json_node_child(object, "cut_share"), traced = json_node_child(object, "traced");

    *accuracy = (struct frame_accuracy){.has_cut_share = is_known(&share)};
    if (read_audit(accuracy, object, error) &&
        (!is_known(&share) || json_read_number(&share, 0, 1, &accuracy->cut_share, error)) &&
        (!is_known(&traced) || json_read_number(&traced, 0, 1, &accuracy->traced, error)))
        return true;
    *accuracy = (struct frame_accuracy){0};
    return false;
}
