#include "core/job_later.h"

#include <string.h>

const struct job_later job_later_table[] = {
    {.key = "method", .text = "tracking"},
    {0},
};

static bool check_text(const struct job_later *later, const struct json_node *node, struct error *error)
{
    const char *text;

    if (json_node_type(node) != JSON_STRING || !json_read_string(node, &text, NULL) || strcmp(text, later->text) != 0)
        return true;
    return json_fail(node, error, "\"%s\" is not there yet", text);
}

bool job_later_check(const struct json_node *quality, struct error *error)
{
    for (const struct job_later *later = job_later_table; later->key; later++) {
        struct json_node node = json_node_child(quality, later->key);

        if (json_node_is_absent(&node)) continue;
        if (later->text && !check_text(later, &node, error)) return false;
        if (!later->text) return json_fail(&node, error, "%s is not there yet", later->key);
    }
    return true;
}
