// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/wire/metrics_text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

// Each line is a comment of the two kinds or a sample: a name, labels with both their quotes, one blank, a number.
static void check_line(const char *line, size_t length)
{
    const char *end = line + length, *number;
    char *rest;

    if (length > 7 && (memcmp(line, "# HELP ", 7) == 0 || memcmp(line, "# TYPE ", 7) == 0)) return;
    for (number = line; number < end && *number != ' ' && *number != '{'; number++)
        if (!(*number >= 'a' && *number <= 'z') && !(*number >= 'A' && *number <= 'Z') && *number != '_' &&
            (number == line || *number < '0' || *number > '9'))
            abort();
    if (number < end && *number == '{') {
        for (bool is_quoted = false; number < end && (is_quoted || *number != '}'); number++) {
            if (*number == '\\')
                number++;
            else if (*number == '"')
                is_quoted = !is_quoted;
        }
        number++;
    }
    if (number >= end || *number != ' ') abort();
    strtod(number + 1, &rest);
    if (rest != end || rest == number + 1) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct error error = {0};
    struct cJSON *root = NULL;
    struct json_node node;
    char *text;

    if (!json_parse(&root, (const char *)bytes, size, &error)) return 0;
    node = json_node_root(root);
    text = metrics_text_format(&node, &error);
    if (!text && !error.message[0]) abort();
    for (const char *line = text; line && *line;) {
        const char *end = strchr(line, '\n');

        if (!end) abort(); // each line ends
        check_line(line, (size_t)(end - line));
        line = end + 1;
    }
    free(text);
    json_delete(root);
    return 0;
}
