// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_twins.h"

#include "core/job/frame_range.h"
#include "core/job/frame_set.h"
#include "core/job/output_path.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct output_path parse_path(const char *pattern)
{
    struct output_path path;

    assert_true(output_path_parse(&path, pattern, NULL));
    return path;
}

static struct frame_range parse_range(const char *text)
{
    struct frame_range range;

    assert_true(frame_range_parse(&range, text, NULL));
    return range;
}

// -1: none.
static int32_t find(const char *pattern, const char *frames, const char *other_pattern, const char *other_frames)
{
    struct output_path path = parse_path(pattern), other_path = parse_path(other_pattern);
    struct frame_range range = parse_range(frames), other = parse_range(other_frames);
    struct frame_twins twins[FRAME_TWINS_LIMIT];
    size_t count = frame_twins_list(&path, &other_path, twins);
    struct frame_set marks = {0};
    int32_t frame = -1;

    if (!frame_twins_find(twins, count, &range, &marks, &other, &frame)) frame = -1;
    frame_set_finish(&marks);
    frame_range_finish(&range);
    frame_range_finish(&other);
    output_path_finish(&path);
    output_path_finish(&other_path);
    return frame;
}

static void frames_in_common_are_found(void **state)
{
    static const struct {
        const char *range, *other;
        bool has_common;
    } cases[] = {{"0-9", "10-19", false},
                 {"0-9", "9-19", true},
                 {"0-100x2", "1-101x2", false},
                 {"100-0x2", "1-99x7", true},
                 {"5,1,9", "2-4,6-8,0,9", true},
                 {"0-1999999", "2000000-3999999", false},
                 {"7", "7", true},
                 {"9999999", "0-3999998", false},
                 {"9999999,64", "64-127", true}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(find("x.#.exr", cases[i].range, "x.#.exr", cases[i].other) >= 0, cases[i].has_common);
        assert_int_equal(find("x.#.exr", cases[i].other, "x.#.exr", cases[i].range) >= 0, cases[i].has_common);
    }
}

static void frames_of_other_patterns_are_found(void **state)
{
    assert_int_equal(find("x#.exr", "0-999999", "x1##.exr", "0-9"), 100);
    assert_int_equal(find("x##.exr", "0-9", "x#.exr", "0-9"), -1); // x00.exr, x0.exr
    assert_int_equal(find("x##.exr", "0-12", "x#.exr", "0-12"), 10);
    assert_int_equal(find("x#_0001.exr", "5", "x5_#.exr", "1"), -1); // x5_1.exr
    assert_int_equal(find("x#_0001.exr", "5", "x5_####.exr", "1"), 5);
    assert_int_equal(find("x#0.exr", "3999999-0x2", "x#.exr", "0-3999999x20"), -1); // odd tens
}

static unsigned pick(unsigned limit)
{
    static uint64_t random = 88172645463325252;

    random ^= random << 13;
    random ^= random >> 7;
    random ^= random << 17;
    return (unsigned)(random % limit);
}

static void make_pattern(char *pattern, size_t size)
{
    static const char *const parts[] = {"", "", "", "", "1", "0"}, *const pads[] = {"#", "##", "####", "%03d"};

    snprintf(pattern, size, "x%s%s%s.exr", parts[pick(6)], pads[pick(4)], parts[pick(6)]);
}

// Some have more spans than are compared span by span.
static void make_range(char *text, size_t size)
{
    static const unsigned limits[] = {10, 130, 1300, 130000};
    size_t length = 0;

    for (unsigned left = pick(3) ? 1 + pick(3) : 12 + pick(8); left > 0; left--) {
        unsigned first = pick(limits[pick(4)]);

        length += (size_t)snprintf(text + length, size - length, "%s%u-%ux%u", length > 0 ? "," : "", first,
                                   pick(3) ? first + pick(300) : first / 2, 1 + pick(12));
    }
}

static bool is_twin(const struct output_path *path, int32_t frame, const struct output_path *other,
                    const struct frame_range *range)
{
    char name[OUTPUT_NAME_SIZE];
    int32_t twin;

    output_path_format_name(path, frame, name);
    twin = output_path_frame_of(other, name);
    return twin >= 0 && frame_range_index(range, twin) >= 0;
}

static void all_agree_with_the_names(void **state)
{
    int found_count = 0;

    for (int round = 0; round < 1000; round++) {
        char pattern[64], other_pattern[64], frames[1024], other_frames[1024];
        struct output_path path, other_path;
        struct frame_range range, other;
        bool has_twin = false;
        int32_t found;

        make_pattern(pattern, sizeof pattern);
        make_pattern(other_pattern, sizeof other_pattern);
        make_range(frames, sizeof frames);
        make_range(other_frames, sizeof other_frames);
        found = find(pattern, frames, other_pattern, other_frames);
        path = parse_path(pattern);
        other_path = parse_path(other_pattern);
        range = parse_range(frames);
        other = parse_range(other_frames);
        for (int64_t i = 0; i < frame_range_count(&range) && !has_twin; i++)
            has_twin = is_twin(&path, frame_range_at(&range, i), &other_path, &other);
        if (has_twin != (found >= 0) ||
            (has_twin && (frame_range_index(&range, found) < 0 || !is_twin(&path, found, &other_path, &other))))
            fail_msg("%s %s and %s %s: %d", pattern, frames, other_pattern, other_frames, found);
        found_count += has_twin;
        frame_range_finish(&range);
        frame_range_finish(&other);
        output_path_finish(&path);
        output_path_finish(&other_path);
    }
    assert_in_range(found_count, 100, 900);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_in_common_are_found),
        cmocka_unit_test(frames_of_other_patterns_are_found),
        cmocka_unit_test(all_agree_with_the_names),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
