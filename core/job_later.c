#include "core/job_later.h"

#include <string.h>

const struct job_later job_later_table[] = {
    {JOB_LATER_SCENE, .key = "objects"},
    {JOB_LATER_QUALITY, .key = "tolerance"},
    {JOB_LATER_QUALITY, .key = "method", .text = "jittered"},
    {JOB_LATER_QUALITY, .key = "method", .text = "adaptive"},
    {JOB_LATER_QUALITY, .key = "method", .text = "gauss"},
    {JOB_LATER_QUALITY, .key = "method", .text = "cached"},
    {JOB_LATER_QUALITY, .key = "method", .text = "preintegrated"},
    {JOB_LATER_QUALITY, .key = "method", .text = "tracking"},
    {JOB_LATER_QUALITY, .key = "method", .text = "auto"},
    {JOB_LATER_QUALITY, .key = "max_depth"},
    {JOB_LATER_QUALITY, .key = "min_throughput"},
    {0},
};

static bool check_text(const struct job_later *later, const struct json_node *node, struct error *error)
{
    const char *text;

    if (json_node_type(node) != JSON_STRING || !json_read_string(node, &text, NULL) || strcmp(text, later->text) != 0)
        return true;
    return json_fail(node, error, "\"%s\" is not there yet", text);
}

bool job_later_check(const struct json_node *object, enum job_later_place place, struct error *error)
{
    for (const struct job_later *later = job_later_table; later->key; later++) {
        struct json_node node = json_node_child(object, later->key);

        if (later->place != place || json_node_is_absent(&node)) continue;
        if (later->text && !check_text(later, &node, error)) return false;
        if (!later->text) return json_fail(&node, error, "%s is not there yet", later->key);
    }
    return true;
}
