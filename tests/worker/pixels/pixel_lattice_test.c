// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_lattice.h"

#include "tests/support/assert_near.h"
#include "tests/support/lattice_picture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { STRIDE_MOST = 64 };

// A point of which all channels show one value.
static struct lattice_point grey(double value)
{
    float v = (float)value;

    return (struct lattice_point){.rgba = {v, v, v, 1},
                                  .transmittance = {0.5f, 0.5f, 0.5f, 0.5f},
                                  .paths = {0, 0, 1, 0},
                                  .depth = 3,
                                  .signature = 7};
}

static struct lattice_point flat(const void *user, int x, int y)
{
    (void)user;
    (void)x;
    (void)y;
    return grey(0.7);
}

static struct lattice_point slope(const void *user, int x, int y)
{
    (void)user;
    return grey(2 + x / 256.0 - y / 512.0);
}

// 1 from column *user on.
static struct lattice_point step(const void *user, int x, int y)
{
    (void)y;
    return grey(x >= *(const int *)user ? 1 : 0.25);
}

static struct lattice_point thin_line(const void *user, int x, int y)
{
    (void)y;
    return grey(x == *(const int *)user ? 5 : 0.25);
}

// Squares of *user pixels.
static struct lattice_point checker(const void *user, int x, int y)
{
    int side = *(const int *)user;

    return grey((x / side + y / side) % 2 == 1 ? 1 : 0.1);
}

// All channels differ, and surfaces at different depths.
static struct lattice_point everything(const void *user, int x, int y)
{
    double wave = sin(0.05 * x) * cos(0.04 * y), alpha = 0.5 + 0.5 * wave;
    int surface = x + y > 60 ? 1 : 0;

    (void)user;
    return (struct lattice_point){.rgba = {(float)alpha, (float)(alpha * alpha), (float)(0.1 + wave), (float)alpha},
                                  .transmittance = {(float)(1 - alpha), (float)fabs(wave), 0.25f, 0},
                                  .paths = {(float)surface, (float)alpha, (float)(1 + surface), 0},
                                  .depth = surface ? (float)(2 + 0.01 * x) : 0,
                                  .signature = (uint32_t)surface};
}

static struct lattice_point hole(const void *user, int x, int y)
{
    const int *at = user;
    struct lattice_point point = grey(1);

    if (x == at[0] && y == at[1]) point.rgba[1] = NAN;
    return point;
}

static struct lattice_made make(const struct lattice_case *of)
{
    struct lattice_made made = lattice_make(of);

    lattice_check_traced(of, &made);
    return made;
}

static size_t count_first(const struct lattice_case *of)
{
    return (size_t)((of->width_px + of->stride - 1) / of->stride) *
           (size_t)((of->height_px + of->stride - 1) / of->stride);
}

// Whatever the size and the stride, also one larger than the picture.
static void smooth_pictures_are_traced_on_the_first_level_only(void **state)
{
    static const int sizes[][2] = {{1, 1},   {1, 9},   {9, 1},   {2, 2},   {3, 5},
                                   {17, 16}, {16, 17}, {33, 65}, {64, 48}, {121, 67}};
    static lattice_picture *const pictures[] = {flat, slope};

    (void)state;
    for (int stride = 2; stride <= STRIDE_MOST; stride *= 2)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            for (int k = 0; k < 4; k++) {
                struct lattice_case of = {.width_px = sizes[i][0],
                                          .height_px = sizes[i][1],
                                          .stride = stride,
                                          .threshold = 0.01,
                                          .is_colour_only = k >= 2,
                                          .picture = pictures[k % 2]};
                struct lattice_made made = make(&of);

                assert_int_equal(made.traced, count_first(&of));
                assert_true(lattice_find_error(&of, &made) <= 1e-6);
                lattice_made_finish(&made);
            }
}

static void a_step_is_found_wherever_it_is(void **state)
{
    (void)state;
    for (int stride = 2; stride <= STRIDE_MOST; stride *= 4)
        for (int at = 1; at < 83; at++) {
            struct lattice_case of = {
                .width_px = 83, .height_px = 5, .stride = stride, .threshold = 0.01, .picture = step, .user = &at};
            struct lattice_made made = make(&of);

            assert_near(lattice_find_error(&of, &made), 0, 0);
            assert_true(made.traced < 83 * 5 * 2 / 3);
            // The pixels at its sides are no guesses.
            for (int row = 0; row < 5; row++)
                for (int x = at - 1; x <= at; x++)
                    assert_true(made.image.doubts[83 * row + x] == 0 || (x % 2 == 0 && row % 2 == 0));
            lattice_made_finish(&made);
        }
}

// One column of the first level is brighter, at index 4 of 9. Points bend up to two steps to each side of it, at index
// 5, 7, 9 and 11 of the second level; two points beside these are traced, and those of the rows between all of them.
static void points_beside_a_doubtful_one_are_traced(void **state)
{
    const int at = 64, stride = 16;
    struct lattice_case of = {
        .width_px = 129, .height_px = 17, .stride = stride, .threshold = 0.01, .picture = thin_line, .user = &at};
    struct lattice_made made = make(&of);

    (void)state;
    // Index 3 to 13: six of them in the two rows of the first level, which has the others, eleven in the row between.
    assert_int_equal(made.first_wanted, 6 + 11 + 6);
    lattice_made_finish(&made);
}

static void a_line_is_missed_between_points_and_found_by_a_guard(void **state)
{
    (void)state;
    for (int at = 0; at < 32; at++) {
        struct pixel_guard guard = {.from = {at, 0}, .to = {at, 47}, .reach = 1};
        struct lattice_case of = {
            .width_px = 65, .height_px = 48, .stride = 16, .threshold = 0.01, .picture = thin_line, .user = &at};
        struct lattice_made made = make(&of);

        if (at % 16 == 0)
            assert_near(lattice_find_error(&of, &made), 0, 0);
        else
            assert_int_equal(made.traced, count_first(&of));
        lattice_made_finish(&made);
        of.guards = &guard;
        of.guard_count = 1;
        made = make(&of);
        assert_near(lattice_find_error(&of, &made), 0, 0);
        assert_true(made.traced < 65 * 48 / 2);
        lattice_made_finish(&made);
    }
}

static void a_checker_of_the_lattice_is_traced_throughout(void **state)
{
    (void)state;
    for (int stride = 2; stride <= 16; stride *= 2) {
        struct lattice_case of = {
            .width_px = 97, .height_px = 51, .stride = stride, .threshold = 0.01, .picture = checker, .user = &stride};
        struct lattice_made made = make(&of);

        assert_near(lattice_find_error(&of, &made), 0, 0);
        lattice_made_finish(&made);
    }
}

// Light of the media says nothing here; what rays meet and how far they go does.
struct sides {
    int x, y;            // the right side begins at x in row 0, and each row further on by y
    double value, depth; // of the right one
    uint32_t signature;  // of the right one
};

static struct lattice_point sides(const void *user, int x, int y)
{
    const struct sides *sides = user;
    struct lattice_point point = grey(1);

    if (x < sides->x + y * sides->y) return point;
    point = grey(sides->value);
    point.depth = (float)sides->depth;
    point.signature = sides->signature;
    return point;
}

static void check_sides(const struct sides *user, int stride)
{
    struct lattice_case of = {
        .width_px = 61, .height_px = 37, .stride = stride, .threshold = 0.5, .picture = sides, .user = user};
    struct lattice_made made = make(&of);

    for (int i = 0; i < 61 * 37; i++) {
        struct lattice_point point = sides(user, i % 61, i / 61);

        assert_int_equal(made.signatures[i], point.signature);
        assert_memory_equal(&made.image.depth[i], &point.depth, sizeof point.depth);
    }
    assert_true(made.traced < 61 * 37 * 2 / 3);
    lattice_made_finish(&made);
}

static void what_rays_meet_is_right_at_every_pixel(void **state)
{
    (void)state;
    for (int stride = 4; stride <= STRIDE_MOST; stride *= 4)
        for (int x = 1; x < 40; x++)
            for (int y = 0; y < 2; y++)
                check_sides(&(struct sides){x, y, 1.01, 3, 8}, stride);
}

// Surfaces of which one is in front of the other have no depth between.
static void depths_apart_are_not_mixed(void **state)
{
    static const double depths[] = {0, 2.5, 3.1, 1e9};

    (void)state;
    for (size_t i = 0; i < sizeof depths / sizeof *depths; i++)
        for (int x = 1; x < 40; x += 3)
            check_sides(&(struct sides){x, 1, 1, depths[i], 7}, 16);
}

// 2 % of 3 m.
static void depths_that_are_nearly_equal_are_interpolated(void **state)
{
    static const double depths[] = {3.055, 3.065};

    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct sides user = {21, 0, 1, depths[i], 7};
        struct lattice_case of = {
            .width_px = 61, .height_px = 37, .stride = 16, .threshold = 0.5, .picture = sides, .user = &user};
        struct lattice_made made = make(&of);

        assert_true((made.traced == count_first(&of)) == (i == 0));
        for (int k = 0; k < 61 * 37; k++)
            assert_true((double)made.image.depth[k] >= 3 && (double)made.image.depth[k] <= depths[i] + 1e-6);
        lattice_made_finish(&made);
    }
}

static void every_channel_follows(void **state)
{
    (void)state;
    for (int stride = 2; stride <= STRIDE_MOST; stride *= 2) {
        struct lattice_case of = {
            .width_px = 121, .height_px = 67, .stride = stride, .threshold = 0.01, .picture = everything};
        struct lattice_made made = make(&of);

        for (int i = 0; i < 121 * 67; i++) {
            struct lattice_point point = everything(NULL, i % 121, i / 121);
            const float *transmittance = made.image.transmittance + 4 * (size_t)i, *paths = made.paths + 4 * (size_t)i;

            // The RMS of the colours is below 1. |wave| has an edge: half way between points, a line across it is off
            // by up to four times the bend.
            for (int c = 0; c < 4; c++)
                assert_near(made.image.rgba[4 * i + c], point.rgba[c], 0.01);
            for (int c = 0; c < 3; c++)
                assert_near(transmittance[c], point.transmittance[c], 0.04);
            assert_near(paths[0], point.paths[0], 0);
            assert_near(paths[1], point.paths[1], 0.1);
            assert_near(paths[2], point.paths[2], 0);
            assert_near(made.image.depth[i], point.depth, 1e-5);
        }
        lattice_made_finish(&made);
    }
}

// Only alpha and transmittance tell of an edge here.
static struct lattice_point veil(const void *user, int x, int y)
{
    const int *channel = user;
    struct lattice_point point = grey(100);

    (void)y;
    *(*channel == 3 ? &point.rgba[3] : &point.transmittance[*channel]) = x > 40 ? 0.75f : 0.8f;
    return point;
}

static void alpha_and_transmittance_are_doubted_as_they_are(void **state)
{
    (void)state;
    for (int channel = 0; channel < 4; channel++)
        for (int i = 0; i < 2; i++) { // an eighth of the step of 0.05
            struct lattice_case of = {.width_px = 81,
                                      .height_px = 33,
                                      .stride = 16,
                                      .threshold = i == 0 ? 0.006 : 0.0065,
                                      .picture = veil,
                                      .user = &channel};
            struct lattice_made made = make(&of);

            assert_true((made.traced == count_first(&of)) == (i == 1));
            lattice_made_finish(&made);
        }
}

static struct lattice_point bowl(const void *user, int x, int y)
{
    double scale = *(const double *)user;

    (void)y;
    return grey(scale * (1 + 1e-4 * x * x));
}

// Half way between points `stride` apart, a line is off x² by stride² / 4.
static void doubts_are_shares_of_the_threshold(void **state)
{
    static const double scales[] = {1, 1e-12, 1e12};

    (void)state;
    for (size_t i = 0; i < 3; i++) {
        struct lattice_case of = {
            .width_px = 257, .height_px = 3, .stride = 8, .threshold = 2e-3, .picture = bowl, .user = &scales[i]};
        struct lattice_made made = make(&of);
        double squares = 0.0, rms, share;

        for (int x = 0; x < 257; x += 8)
            squares += (1 + 1e-4 * x * x) * (1 + 1e-4 * x * x);
        rms = sqrt(squares / 33);
        share = 1e-4 * 16 / (2e-3 * rms); // of the first level that is refined: 8² / 4
        assert_true(share < 1);
        assert_int_equal(made.traced, 33);
        assert_int_equal(made.image.doubts[32], 0);
        assert_in_range(made.image.doubts[36], (int)(254 * share), (int)(254 * share) + 2);
        assert_in_range(made.image.doubts[34], (int)(254 * share / 4), (int)(254 * share / 4) + 2);
        assert_in_range(made.image.doubts[33], (int)(254 * share / 16), (int)(254 * share / 16) + 2);
        lattice_made_finish(&made);
        of.threshold *= 0.99 * share; // and now it is too much
        made = make(&of);
        assert_true(made.traced > 33);
        lattice_made_finish(&made);
    }
}

// A frame with such light fails; it must be there to be found.
static void light_that_is_not_finite_stays(void **state)
{
    (void)state;
    for (int i = 0; i < 33 * 33; i++) {
        int at[2] = {i % 33, i / 33};
        struct lattice_case of = {
            .width_px = 33, .height_px = 33, .stride = 16, .threshold = 0.01, .picture = hole, .user = at};
        struct lattice_made made = lattice_make(&of);
        bool is_traced = made.image.doubts[i] == 0;

        assert_true(is_traced || at[0] % 16 != 0 || at[1] % 16 != 0);
        assert_true(isnan(made.image.rgba[4 * i + 1]) == is_traced);
        lattice_made_finish(&made);
    }
}

// Bright, but in the columns of the first level.
static struct lattice_point comb(const void *user, int x, int y)
{
    (void)user;
    (void)y;
    return grey(x % 16 == 0 ? 0.1 : 1);
}

// A guard has column 56 traced on the second level. Only on the third does the picture bend beside column 40, which was
// interpolated on the second.
static void an_interpolated_point_is_traced_where_a_later_level_doubts_it(void **state)
{
    const struct pixel_guard guard = {.from = {50, 0}, .to = {50, 16}, .reach = 1};
    struct lattice_case of = {.width_px = 113,
                              .height_px = 17,
                              .stride = 16,
                              .threshold = 0.01,
                              .guards = &guard,
                              .guard_count = 1,
                              .picture = comb};
    struct lattice_made made = make(&of);

    (void)state;
    for (int row = 0; row < 17; row++)
        assert_near(made.image.rgba[4 * (113 * row + 40)], 1, 0);
    lattice_made_finish(&made);
}

// Six times the threshold brighter in the last corner.
static struct lattice_point corner(const void *user, int x, int y)
{
    (void)user;
    return grey(x >= 53 && y >= 53 ? 1.06 : 1);
}

// A guard has the last point of the second level traced. Three points that end there bend by an eighth of its error
// only, which is below the threshold.
static void points_around_one_that_was_wrongly_expected_are_traced(void **state)
{
    const struct pixel_guard guard = {.from = {49, 49}, .to = {49, 49}, .reach = 1};
    struct lattice_case of = {.width_px = 57,
                              .height_px = 57,
                              .stride = 16,
                              .threshold = 0.01,
                              .guards = &guard,
                              .guard_count = 1,
                              .picture = corner};
    struct lattice_made made = make(&of);

    (void)state;
    assert_int_equal(made.image.doubts[57 * 56 + 56], 0);
    assert_int_equal(made.image.doubts[57 * 52 + 56], 0);
    assert_int_equal(made.image.doubts[57 * 56 + 52], 0);
    lattice_made_finish(&made);
}

static struct lattice_point black(const void *user, int x, int y)
{
    (void)user;
    (void)x;
    (void)y;
    return grey(0);
}

static void a_black_picture_is_black(void **state)
{
    struct lattice_case of = {.width_px = 40, .height_px = 30, .stride = 16, .threshold = 1e-6, .picture = black};
    struct lattice_made made = make(&of);

    (void)state;
    assert_int_equal(made.traced, count_first(&of));
    assert_near(lattice_find_error(&of, &made), 0, 0);
    lattice_made_finish(&made);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smooth_pictures_are_traced_on_the_first_level_only),
        cmocka_unit_test(a_step_is_found_wherever_it_is),
        cmocka_unit_test(points_beside_a_doubtful_one_are_traced),
        cmocka_unit_test(a_line_is_missed_between_points_and_found_by_a_guard),
        cmocka_unit_test(a_checker_of_the_lattice_is_traced_throughout),
        cmocka_unit_test(what_rays_meet_is_right_at_every_pixel),
        cmocka_unit_test(depths_apart_are_not_mixed),
        cmocka_unit_test(depths_that_are_nearly_equal_are_interpolated),
        cmocka_unit_test(every_channel_follows),
        cmocka_unit_test(alpha_and_transmittance_are_doubted_as_they_are),
        cmocka_unit_test(doubts_are_shares_of_the_threshold),
        cmocka_unit_test(light_that_is_not_finite_stays),
        cmocka_unit_test(an_interpolated_point_is_traced_where_a_later_level_doubts_it),
        cmocka_unit_test(points_around_one_that_was_wrongly_expected_are_traced),
        cmocka_unit_test(a_black_picture_is_black),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
