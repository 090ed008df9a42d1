// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_range.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum {
    SHOWN_BYTES = 40,
    POSITIONS_FROM_SPANS = 8 // with fewer spans a linear search is as fast
};

// One part of the text between commas, without the spaces around it.
struct part {
    const char *text;
    size_t length;
};

// The state of parsing. `seen` has a bit for each frame number and exists from the second part on.
struct reader {
    struct frame_range *range;
    size_t span_capacity;
    int64_t written_count;
    int32_t count;
    uint64_t *seen;
};

static const char expected_form[] = "\"1-100x2\"";

static bool fail_part(struct part part, struct error *error, const char *expected, const char *hint)
{
    char shown[SHOWN_BYTES + 1];
    size_t length = part.length < SHOWN_BYTES ? part.length : SHOWN_BYTES;

    for (size_t i = 0; i < length; i++)
        shown[i] = (char)(isprint((unsigned char)part.text[i]) ? part.text[i] : '?');
    shown[length] = '\0';
    error_set(error, "expected %s, got \"%s%s\"%s", expected, shown, length < part.length ? "..." : "", hint);
    return false;
}

// Reads a run of digits at `*at`, which moves past it. False when there is none, or, with `*is_large` set, when the
// number is FRAME_NUMBER_LIMIT or more.
static bool read_number(struct part part, size_t *at, int32_t *number, bool *is_large)
{
    size_t start = *at;
    int32_t value = 0;

    for (; *at < part.length && isdigit((unsigned char)part.text[*at]); (*at)++) {
        value = value * 10 + (part.text[*at] - '0');
        if (value >= FRAME_NUMBER_LIMIT) {
            *is_large = true;
            return false;
        }
    }
    *number = value;
    return *at > start;
}

static bool read_part(struct part part, struct frame_span *span, struct error *error)
{
    size_t at = 0;
    int32_t last, step = 1;
    bool is_large = false;

    if (part.length > 0 && part.text[0] == '-') goto out_of_range;
    if (!read_number(part, &at, &span->first, &is_large)) goto wrong;
    last = span->first;
    if (at < part.length) {
        if (part.text[at] != '-') goto wrong;
        at++;
        if (!read_number(part, &at, &last, &is_large)) goto wrong;
    }
    if (at < part.length) {
        if (part.text[at] != 'x') goto wrong;
        at++;
        if (!read_number(part, &at, &step, &is_large)) goto wrong;
        if (step == 0) return fail_part(part, error, "a step of at least 1", "");
    }
    if (at < part.length) goto wrong;
    span->count = abs(last - span->first) / step + 1;
    span->step = last < span->first ? -step : step;
    if (span->count == 1) span->step = 1;
    return true;
wrong:
    if (!is_large) {
        bool has_colon = part.length > 0 && memchr(part.text, ':', part.length) != NULL;

        return fail_part(part, error, expected_form, has_colon ? " (a step is written with x, not with a colon)" : "");
    }
out_of_range:
    return fail_part(part, error, "numbers from 0 to 9999999", "");
}

// True on the first call for `frame`.
static bool take_frame(uint64_t *seen, int32_t frame)
{
    uint64_t bit = UINT64_C(1) << (frame % 64);
    bool is_new = !(seen[frame / 64] & bit);

    seen[frame / 64] |= bit;
    return is_new;
}

static struct frame_span *append_span(struct reader *reader, struct frame_span span)
{
    struct frame_range *range = reader->range;

    range->spans = xgrow(range->spans, &reader->span_capacity, range->span_count + 1, sizeof range->spans[0]);
    span.before = reader->count;
    range->spans[range->span_count] = span;
    return &range->spans[range->span_count++];
}

// Appends the frames of `span` that are new, in as few spans of constant step as possible.
static void append_new_frames(struct reader *reader, const struct frame_span *span)
{
    struct frame_span *current = NULL;

    for (int32_t i = 0; i < span->count; i++) {
        int32_t frame = span->first + i * span->step;

        if (!take_frame(reader->seen, frame)) continue;
        if (current && current->count == 1) current->step = frame - current->first;
        if (current && frame == current->first + current->count * current->step)
            current->count++;
        else
            current = append_span(reader, (struct frame_span){.first = frame, .step = 1, .count = 1});
        reader->count++;
    }
}

static void mark_span(uint64_t *seen, const struct frame_span *span)
{
    for (int32_t i = 0; i < span->count; i++)
        take_frame(seen, span->first + i * span->step);
}

static bool add_part(struct reader *reader, struct part part, struct error *error)
{
    struct frame_span span = {0};

    if (!read_part(part, &span, error)) return false;
    reader->written_count += span.count;
    if (reader->written_count > FRAME_COUNT_LIMIT) return fail_part(part, error, "at most 4000000 frames in all", "");
    if (reader->range->span_count == 0) {
        append_span(reader, span);
        reader->count = span.count;
        return true;
    }
    if (!reader->seen) {
        reader->seen = xcalloc((FRAME_NUMBER_LIMIT + 63) / 64, sizeof reader->seen[0]);
        mark_span(reader->seen, &reader->range->spans[0]);
    }
    append_new_frames(reader, &span);
    return true;
}

// Radix sort in two passes: by the lower half of the frame number, then by the upper half.
static struct frame_position *sort_positions(struct frame_position *positions, size_t count)
{
    enum { DIGIT_BITS = 12, DIGIT_COUNT = 1 << DIGIT_BITS };
    struct frame_position *sorted = xmalloc(count * sizeof sorted[0]);
    uint32_t *starts = xmalloc(DIGIT_COUNT * sizeof starts[0]);

    _Static_assert(FRAME_NUMBER_LIMIT <= 1 << (2 * DIGIT_BITS), "two digits hold every frame number");
    for (int shift = 0; shift <= DIGIT_BITS; shift += DIGIT_BITS) {
        struct frame_position *swap = positions;
        uint32_t start = 0;

        memset(starts, 0, DIGIT_COUNT * sizeof starts[0]);
        for (size_t i = 0; i < count; i++)
            starts[(positions[i].frame >> shift) % DIGIT_COUNT]++;
        for (size_t digit = 0; digit < DIGIT_COUNT; digit++) {
            uint32_t size = starts[digit];

            starts[digit] = start;
            start += size;
        }
        for (size_t i = 0; i < count; i++)
            sorted[starts[(positions[i].frame >> shift) % DIGIT_COUNT]++] = positions[i];
        positions = sorted;
        sorted = swap;
    }
    free(starts);
    free(sorted);
    return positions;
}

static void index_positions(struct frame_range *range)
{
    size_t count = (size_t)frame_range_count(range);
    struct frame_position *positions;
    int32_t index = 0;

    if (range->span_count < POSITIONS_FROM_SPANS) return;
    positions = xmalloc(count * sizeof positions[0]);
    for (const struct frame_span *span = range->spans; span < range->spans + range->span_count; span++)
        for (int32_t i = 0; i < span->count; i++, index++)
            positions[index] = (struct frame_position){.frame = span->first + i * span->step, .index = index};
    range->positions = sort_positions(positions, count);
}

bool frame_range_parse(struct frame_range *range, const char *text, struct error *error)
{
    struct reader reader = {.range = range};
    bool ok = false;

    *range = (struct frame_range){0};
    for (const char *start = text;;) {
        size_t length = strcspn(start, ",");
        struct part part = {start, length};

        while (part.length > 0 && isspace((unsigned char)part.text[0])) {
            part.text++;
            part.length--;
        }
        while (part.length > 0 && isspace((unsigned char)part.text[part.length - 1]))
            part.length--;
        if (!add_part(&reader, part, error)) goto out;
        if (start[length] == '\0') break;
        start += length + 1;
    }
    index_positions(range);
    ok = true;
out:
    free(reader.seen);
    if (!ok) frame_range_finish(range);
    return ok;
}

void frame_range_finish(struct frame_range *range)
{
    free(range->spans);
    free(range->positions);
    *range = (struct frame_range){0};
}

int64_t frame_range_count(const struct frame_range *range)
{
    const struct frame_span *last;

    if (range->span_count == 0) return 0;
    last = &range->spans[range->span_count - 1];
    return (int64_t)last->before + last->count;
}

int32_t frame_range_at(const struct frame_range *range, int64_t index)
{
    size_t low = 0, high = range->span_count;

    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;

        if (range->spans[middle].before <= index)
            low = middle;
        else
            high = middle;
    }
    return range->spans[low].first + (int32_t)(index - range->spans[low].before) * range->spans[low].step;
}

static int compare_positions(const void *a, const void *b)
{
    const struct frame_position *left = a, *right = b;

    return (left->frame > right->frame) - (left->frame < right->frame);
}

int64_t frame_range_index(const struct frame_range *range, int32_t frame)
{
    struct frame_position wanted = {.frame = frame};

    if (range->positions) {
        const struct frame_position *found = bsearch(&wanted, range->positions, (size_t)frame_range_count(range),
                                                     sizeof range->positions[0], compare_positions);

        return found ? found->index : -1;
    }
    for (const struct frame_span *span = range->spans; span < range->spans + range->span_count; span++) {
        int64_t distance = (int64_t)frame - span->first;

        if (distance % span->step == 0 && distance / span->step >= 0 && distance / span->step < span->count)
            return span->before + distance / span->step;
    }
    return -1;
}

// Writes `number` in decimal to `text`; returns its length.
static size_t format_number(char *text, int32_t number)
{
    char digits[12];
    size_t count = 0;

    do {
        digits[count++] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    for (size_t i = 0; i < count; i++)
        text[i] = digits[count - 1 - i];
    return count;
}

char *frame_range_format(const struct frame_range *range)
{
    enum { SPAN_TEXT_SIZE = 32 };
    char *text = NULL;
    size_t length = 0, capacity = 0;

    text = xgrow(text, &capacity, SPAN_TEXT_SIZE, 1);
    for (const struct frame_span *span = range->spans; span < range->spans + range->span_count; span++) {
        text = xgrow(text, &capacity, length + SPAN_TEXT_SIZE, 1);
        if (length > 0) text[length++] = ',';
        length += format_number(text + length, span->first);
        if (span->count > 1) {
            text[length++] = '-';
            length += format_number(text + length, span->first + (span->count - 1) * span->step);
        }
        if (span->count > 1 && abs(span->step) != 1) {
            text[length++] = 'x';
            length += format_number(text + length, abs(span->step));
        }
    }
    text[length] = '\0';
    return text;
}
