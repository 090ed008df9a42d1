// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_set.h"

#include "core/base/alloc.h"
#include "core/job/frame_range.h"

#include <stdlib.h>

enum { WORD_BITS = 64 };

static int64_t count_words(const struct frame_set *set)
{
    return (set->limit + WORD_BITS - 1) / WORD_BITS;
}

void frame_set_init(struct frame_set *set, int64_t limit)
{
    *set = (struct frame_set){.limit = limit};
    set->words = xcalloc((size_t)count_words(set) + 1, sizeof set->words[0]);
}

void frame_set_finish(struct frame_set *set)
{
    free(set->words);
    *set = (struct frame_set){0};
}

bool frame_set_parse(struct frame_set *set, const char *text, struct error *error)
{
    struct frame_range range;

    *set = (struct frame_set){0};
    if (!frame_range_parse(&range, text, error)) return false;
    frame_set_init(set, FRAME_NUMBER_LIMIT);
    for (const struct frame_span *span = range.spans; span < range.spans + range.span_count; span++)
        for (int32_t i = 0; i < span->count; i++)
            frame_set_add(set, span->first + i * span->step);
    frame_range_finish(&range);
    return true;
}

// The bits of the word that are `from` or later.
static uint64_t word_from(const struct frame_set *set, int64_t word, int64_t from)
{
    int64_t before = from - word * WORD_BITS;

    return before > 0 ? set->words[word] & UINT64_MAX << before : set->words[word];
}

int64_t frame_set_next(const struct frame_set *set, int64_t from)
{
    for (int64_t word = from / WORD_BITS; word < count_words(set); word++) {
        uint64_t bits = word_from(set, word, from);

        if (bits) return word * WORD_BITS + __builtin_ctzll(bits);
    }
    return set->limit;
}

int64_t frame_set_count_from(const struct frame_set *set, int64_t from)
{
    int64_t count = 0;

    for (int64_t word = from / WORD_BITS; word < count_words(set); word++)
        count += __builtin_popcountll(word_from(set, word, from));
    return count;
}
