// Lines of a node, or of a daemon: each is read whole and within its bounds, or refused with a reason.
// SPDX-License-Identifier: Apache-2.0
#include "node/node_line.h"

#include "core/base/error.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void require(bool condition)
{
    if (!condition) abort();
}

// What was read and is written again reads as the same.
static void check_round_trip(const struct node_line *line)
{
    char *text = malloc(NODE_LINE_HEAD_SIZE + line->length);
    size_t head = node_line_write_head(text, line->word, line->worker);
    struct node_line again;

    require(head <= NODE_LINE_HEAD_SIZE);
    memcpy(text + head, line->rest, line->length);
    require(node_line_read(&again, text, head + line->length, NULL));
    require(again.word == line->word && again.worker == line->worker && again.length == line->length);
    require(memcmp(again.rest, line->rest, line->length) == 0);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    // A copy of its own, so that a byte read behind the line is noticed.
    char *copy = malloc(size > 0 ? size : 1);
    struct node_line line;
    struct error error = {0};

    memcpy(copy, bytes, size);
    if (node_line_read(&line, copy, size, &error)) {
        require(line.rest >= copy && line.rest + line.length == copy + size);
        require(line.worker >= NODE_NO_WORKER);
        check_round_trip(&line);
    } else {
        require(error.message[0] != '\0');
    }
    free(copy);
    return 0;
}
