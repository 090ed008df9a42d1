// A set of frames, by number or by index, with a bit for each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct frame_range;

// The zero value is empty and takes no member.
struct frame_set {
    uint64_t *words; // owned
    int64_t limit;   // members are in [0, limit)
};

void frame_set_init(struct frame_set *set, int64_t limit);
void frame_set_finish(struct frame_set *set); // accepts the zero value
// The numbers of a range as frame_range_parse reads it. On failure the set is empty.
bool frame_set_parse(struct frame_set *set, const char *text, struct error *error);
int64_t frame_set_next(const struct frame_set *set, int64_t from); // the first member at or after `from`; else limit
int64_t frame_set_count_from(const struct frame_set *set, int64_t from); // members at or after `from`

// `member` in [0, limit).
static inline void frame_set_add(struct frame_set *set, int64_t member)
{
    set->words[member / 64] |= UINT64_C(1) << (member % 64);
}

static inline bool frame_set_has(const struct frame_set *set, int64_t number)
{
    return number >= 0 && number < set->limit && (set->words[number / 64] >> (number % 64) & 1);
}
