// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_twins.h"

#include "core/job/frame_range.h"
#include "core/job/frame_set.h"
#include "core/job/output_path.h"

#include <assert.h>
#include <ctype.h>
#include <string.h>

enum {
    NUMBER_DIGITS = 7,     // of a frame's number
    POWER_LIMIT = 10,      // higher powers of ten count as this one, for they are above any number
    FRAMES_OF_A_PAIR = 100 // so many are looked up while two spans are compared
};

// A pattern whose number has `digits` digits, as a name: characters, and the place of the digits.
struct shape {
    const struct output_path *path;
    int prefix, digits, length;
    int64_t fixed; // value of the digits that the other pattern demands
};

static int64_t power_of_ten(int exponent)
{
    int64_t power = 1;

    for (int i = 0; i < exponent && i < POWER_LIMIT; i++)
        power *= 10;
    return power;
}

static struct shape make_shape(const struct output_path *path, int digits)
{
    int prefix = (int)strlen(path->prefix);

    return (struct shape){
        .path = path, .prefix = prefix, .digits = digits, .length = prefix + digits + (int)strlen(path->suffix)};
}

static bool is_digit_at(const struct shape *shape, int at)
{
    return at >= shape->prefix && at < shape->prefix + shape->digits;
}

static char character_at(const struct shape *shape, int at)
{
    return at < shape->prefix ? shape->path->prefix[at] : shape->path->suffix[at - shape->prefix - shape->digits];
}

static bool demand_digit(struct shape *shape, int at, char character)
{
    if (!isdigit((unsigned char)character)) return false;
    shape->fixed += (character - '0') * power_of_ten(shape->prefix + shape->digits - 1 - at);
    return true;
}

// False when no digits make the names equal. Digits of both are free.
static bool compare_shapes(struct shape *shape, struct shape *other)
{
    for (int at = 0; at < shape->length; at++) {
        bool is_free = is_digit_at(shape, at), is_other_free = is_digit_at(other, at);

        if (is_free && !is_other_free && !demand_digit(shape, at, character_at(other, at))) return false;
        if (!is_free && is_other_free && !demand_digit(other, at, character_at(shape, at))) return false;
        if (!is_free && !is_other_free && character_at(shape, at) != character_at(other, at)) return false;
    }
    return true;
}

static int64_t floor_divide(int64_t a, int64_t b)
{
    assert(b > 0);
    return a / b - (a % b < 0);
}

static int64_t ceil_divide(int64_t a, int64_t b)
{
    return -floor_divide(-a, b);
}

// Limits the free value `t` so that the number, fixed + t x step, is one that has so many digits.
static void limit_free(const struct shape *shape, int64_t step, int64_t *least, int64_t *most)
{
    int64_t low = shape->digits > 1 && shape->digits > shape->path->pad ? power_of_ten(shape->digits - 1) : 0;
    int64_t from = ceil_divide(low - shape->fixed, step);
    int64_t to = floor_divide(FRAME_NUMBER_LIMIT - 1 - shape->fixed, step);

    if (from > *least) *least = from;
    if (to < *most) *most = to;
}

static bool pair_shapes(struct shape *shape, struct shape *other, struct frame_twins *twins)
{
    int ends = shape->prefix + shape->digits, other_ends = other->prefix + other->digits;
    int begin = shape->prefix > other->prefix ? shape->prefix : other->prefix;
    int end = ends < other_ends ? ends : other_ends;
    int64_t step = power_of_ten(ends - end), other_step = power_of_ten(other_ends - end), least = 0, most;

    if (other->digits < 1 || other->digits < other->path->pad || !compare_shapes(shape, other)) return false;
    most = end > begin ? power_of_ten(end - begin) - 1 : 0;
    limit_free(shape, step, &least, &most);
    limit_free(other, other_step, &least, &most);
    *twins = (struct frame_twins){.first = shape->fixed + least * step,
                                  .step = step,
                                  .other_first = other->fixed + least * other_step,
                                  .other_step = other_step,
                                  .count = most - least + 1};
    return twins->count > 0;
}

// The latest pairs may go on where those before end.
static bool goes_on(const struct frame_twins *before, const struct frame_twins *twins)
{
    return before->step == twins->step && before->other_step == twins->other_step &&
           before->first + before->count * before->step == twins->first &&
           before->other_first + before->count * before->other_step == twins->other_first;
}

size_t frame_twins_list(const struct output_path *path, const struct output_path *other,
                        struct frame_twins twins[static FRAME_TWINS_LIMIT])
{
    int around = (int)strlen(other->prefix) + (int)strlen(other->suffix), digits = path->pad > 1 ? path->pad : 1;
    size_t count = 0;

    do {
        struct shape shape = make_shape(path, digits), twin = make_shape(other, shape.length - around);
        struct frame_twins found;

        if (!pair_shapes(&shape, &twin, &found)) continue;
        if (count > 0 && goes_on(&twins[count - 1], &found))
            twins[count - 1].count += found.count;
        else
            twins[count++] = found;
    } while (++digits <= NUMBER_DIGITS && count < FRAME_TWINS_LIMIT);
    return count;
}

// Numbers t = rest + k x modulus within [least, most].
struct progression {
    int64_t rest, modulus, least, most;
};

static int64_t find_common_divisor(int64_t a, int64_t b)
{
    while (b != 0) {
        int64_t rest = a % b;

        a = b;
        b = rest;
    }
    return a;
}

// x in [0, modulus) with a x = 1 modulo it; `a` and `modulus` have no common divisor. Euclid's algorithm, extended.
static int64_t invert(int64_t a, int64_t modulus)
{
    int64_t r = modulus, next_r = a % modulus, x = 0, next_x = 1;

    while (next_r != 0) {
        int64_t quotient = r / next_r, swap = r - quotient * next_r;

        r = next_r;
        next_r = swap;
        swap = x - quotient * next_x;
        x = next_x;
        next_x = swap;
    }
    return x < 0 ? x + modulus : x;
}

static int64_t remainder_of(int64_t a, int64_t modulus)
{
    return a - floor_divide(a, modulus) * modulus;
}

// The t for which first + t x step is in the span. False: none.
static bool solve_span(int64_t first, int64_t step, const struct frame_span *span, struct progression *found)
{
    int64_t end = span->first + (int64_t)(span->count - 1) * span->step;
    int64_t low = span->first < end ? span->first : end, high = span->first < end ? end : span->first;
    int64_t stride = span->step < 0 ? -span->step : span->step, divisor = find_common_divisor(step, stride);

    if (remainder_of(low - first, divisor) != 0) return false;
    found->modulus = stride / divisor;
    found->rest =
        remainder_of((low - first) / divisor, found->modulus) * invert(step / divisor, found->modulus) % found->modulus;
    found->least = ceil_divide(low - first, step);
    found->most = floor_divide(high - first, step);
    return true;
}

// The least t of [0, count) in both; negative: none. The Chinese remainder theorem.
static int64_t find_least(const struct progression *a, const struct progression *b, int64_t count)
{
    int64_t divisor = find_common_divisor(a->modulus, b->modulus), rest = b->rest - a->rest;
    int64_t least = a->least > b->least ? a->least : b->least, most = a->most < b->most ? a->most : b->most;
    int64_t modulus = b->modulus / divisor, t;

    if (remainder_of(rest, divisor) != 0) return -1;
    if (least < 0) least = 0;
    if (most > count - 1) most = count - 1;
    t = a->rest +
        a->modulus * (remainder_of(rest / divisor, modulus) * invert(a->modulus / divisor, modulus) % modulus);
    if (t < least) t += ceil_divide(least - t, a->modulus * modulus) * a->modulus * modulus;
    if (t > least) t -= floor_divide(t - least, a->modulus * modulus) * a->modulus * modulus;
    return t <= most ? t : -1;
}

static bool find_by_spans(const struct frame_twins *twins, const struct frame_range *range,
                          const struct frame_range *other, int32_t *frame)
{
    for (size_t i = 0; i < range->span_count; i++) {
        struct progression own, its;

        if (!solve_span(twins->first, twins->step, &range->spans[i], &own)) continue;
        for (size_t k = 0; k < other->span_count; k++) {
            int64_t t;

            if (!solve_span(twins->other_first, twins->other_step, &other->spans[k], &its)) continue;
            t = find_least(&own, &its, twins->count);
            if (t < 0) continue;
            *frame = (int32_t)(twins->first + t * twins->step);
            return true;
        }
    }
    return false;
}

// The frame that has the name of the other pattern's frame `number`; -1: none.
static int64_t find_twin(const struct frame_twins *twins, size_t count, int64_t number)
{
    for (size_t i = 0; i < count; i++) {
        int64_t distance = number - twins[i].other_first, steps;

        if (distance < 0) continue;
        steps = twins[i].other_step == 1 ? distance : distance / twins[i].other_step;
        if (steps < twins[i].count && steps * twins[i].other_step == distance)
            return twins[i].first + steps * twins[i].step;
    }
    return -1;
}

static void mark_frames(struct frame_set *marks, const struct frame_range *range)
{
    frame_set_init(marks, FRAME_NUMBER_LIMIT);
    for (const struct frame_span *span = range->spans; span < range->spans + range->span_count; span++)
        for (int32_t i = 0; i < span->count; i++)
            frame_set_add(marks, span->first + i * span->step);
}

static bool find_by_frames(const struct frame_twins *twins, size_t count, const struct frame_set *marks,
                           const struct frame_range *other, int32_t *frame)
{
    for (const struct frame_span *span = other->spans; span < other->spans + other->span_count; span++)
        for (int32_t i = 0; i < span->count; i++) {
            int64_t twin = find_twin(twins, count, span->first + i * span->step);

            if (!frame_set_has(marks, twin)) continue;
            *frame = (int32_t)twin;
            return true;
        }
    return false;
}

bool frame_twins_find(const struct frame_twins *twins, size_t count, const struct frame_range *range,
                      struct frame_set *marks, const struct frame_range *other, int32_t *frame)
{
    bool found = false;

    if (range->span_count * other->span_count > (size_t)frame_range_count(other) / FRAMES_OF_A_PAIR) {
        if (!marks->words) mark_frames(marks, range);
        return find_by_frames(twins, count, marks, other, frame);
    }
    for (size_t i = 0; i < count && !found; i++)
        found = find_by_spans(&twins[i], range, other, frame);
    return found;
}
