// SPDX-License-Identifier: Apache-2.0
#include "node/node_line.h"

#include "core/base/error.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *text;
    bool has_worker;
} words[NODE_WORD_COUNT] = {
    [NODE_HELLO] = {"marchd-node", false}, [NODE_WELCOME] = {"welcome", false}, [NODE_REFUSED] = {"refused", false},
    [NODE_PROBE] = {"probe", false},       [NODE_PROBED] = {"probed", false},   [NODE_START] = {"start", true},
    [NODE_STARTED] = {"started", true},    [NODE_FAILED] = {"failed", true},    [NODE_TO] = {"to", true},
    [NODE_FROM] = {"from", true},          [NODE_LOG] = {"log", true},          [NODE_KILL] = {"kill", true},
    [NODE_ENDED] = {"ended", true},        [NODE_BEAT] = {"beat", false},
};

// The bytes up to the next blank, which are cut off the rest with it.
static size_t cut_word(struct node_line *line)
{
    const char *blank = memchr(line->rest, ' ', line->length);
    size_t length = blank ? (size_t)(blank - line->rest) : line->length;
    size_t cut = blank ? length + 1 : length;

    line->rest += cut;
    line->length -= cut;
    return length;
}

static bool cut_number(struct node_line *line)
{
    const char *digits = line->rest;
    size_t count = cut_word(line);
    long number = 0;

    for (size_t i = 0; i < count; i++) {
        if (digits[i] < '0' || digits[i] > '9' || number > (INT_MAX - 9) / 10) return false;
        number = number * 10 + (digits[i] - '0');
    }
    line->worker = (int)number;
    return count > 0;
}

bool node_line_read(struct node_line *line, const char *bytes, size_t length, struct error *error)
{
    size_t count;

    *line = (struct node_line){.worker = NODE_NO_WORKER, .rest = bytes, .length = length};
    count = cut_word(line);
    for (int i = 0; i < NODE_WORD_COUNT; i++) {
        if (strlen(words[i].text) != count || memcmp(words[i].text, bytes, count) != 0) continue;
        line->word = i;
        if (!words[i].has_worker || cut_number(line)) return true;
        error_set(error, "expected the number of a worker after \"%s\"", words[i].text);
        return false;
    }
    error_set(error, "expected a line of a node, got \"%.*s\"", (int)(length < 60 ? length : 60), bytes);
    return false;
}

size_t node_line_write_head(char head[static NODE_LINE_HEAD_SIZE], enum node_word word, int worker)
{
    int length = words[word].has_worker ? snprintf(head, NODE_LINE_HEAD_SIZE, "%s %d ", words[word].text, worker)
                                        : snprintf(head, NODE_LINE_HEAD_SIZE, "%s ", words[word].text);

    return (size_t)length;
}
