// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_calm.h"

#include "tests/support/random.h"
#include "worker/pixels/pixel_planes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { COLUMNS = 23, ROWS = 14, COUNT = COLUMNS * ROWS, FINER_MOST = 4 * COUNT, AWAY = 3 };

struct stand {
    uint8_t roughness[COUNT], forced[FINER_MOST];
    uint32_t signatures[COUNT];
    float depth[COUNT];
    struct pixel_planes planes;
    struct pixel_calm_params params;
};

// A level of which nothing is known that would ask for rays.
static void make(struct stand *stand, int finer_columns, int finer_rows)
{
    memset(stand, 0, sizeof *stand);
    memset(stand->roughness, PIXEL_CALM_MOST, sizeof stand->roughness);
    for (int i = 0; i < COUNT; i++)
        stand->depth[i] = 5.0f;
    stand->planes = (struct pixel_planes){.signatures = stand->signatures, .depth = stand->depth};
    stand->params = (struct pixel_calm_params){.planes = &stand->planes,
                                               .roughness = stand->roughness,
                                               .columns = COLUMNS,
                                               .rows = ROWS,
                                               .forced = stand->forced,
                                               .finer_columns = finer_columns,
                                               .finer_rows = finer_rows};
}

static bool is_rough_near(const struct stand *stand, int column, int row)
{
    for (int y = row - AWAY; y <= row + 1 + AWAY; y++)
        for (int x = column - AWAY; x <= column + 1 + AWAY; x++)
            if (x >= 0 && x < COLUMNS && y >= 0 && y < ROWS && stand->roughness[y * COLUMNS + x] > PIXEL_CALM_MOST)
                return true;
    return false;
}

// A cell of the last column or row has what there is of it.
static bool is_mixed(const struct stand *stand, int column, int row)
{
    int first = row * COLUMNS + column;

    for (int y = row; y <= row + 1 && y < ROWS; y++)
        for (int x = column; x <= column + 1 && x < COLUMNS; x++) {
            int at = y * COLUMNS + x;

            if (stand->signatures[at] != stand->signatures[first]) return true;
            if (stand->params.planes->depth && stand->depth[at] != stand->depth[first]) return true;
        }
    return false;
}

static bool is_guarded(const struct stand *stand, int column, int row)
{
    const struct pixel_calm_params *params = &stand->params;

    for (int y = 2 * row; params->forced && y < 2 * row + 2 && y < params->finer_rows; y++)
        for (int x = 2 * column; x < 2 * column + 2 && x < params->finer_columns; x++)
            if (stand->forced[y * params->finer_columns + x] != 0) return true;
    return false;
}

static void check(const struct stand *stand)
{
    struct pixel_calm calm;

    pixel_calm_init(&calm, &stand->params);
    for (int row = 0; row < ROWS; row++) {
        size_t run = 0;

        pixel_calm_find(&calm, row);
        for (int x = 0; x < COLUMNS; x++) {
            while (run < calm.run_count && calm.runs[run].end <= x)
                run++;
            assert_int_equal(run < calm.run_count && calm.runs[run].first <= x,
                             is_rough_near(stand, x, row) || is_mixed(stand, x, row) || is_guarded(stand, x, row));
        }
        for (size_t i = 0; i < calm.run_count; i++)
            assert_true(calm.runs[i].first < calm.runs[i].end && calm.runs[i].end <= COLUMNS &&
                        (i == 0 || calm.runs[i - 1].end < calm.runs[i].first));
    }
    pixel_calm_finish(&calm);
}

static void cells_are_calm_where_nothing_asks_for_a_ray(void **state)
{
    struct random random = {5};
    struct stand stand;

    (void)state;
    for (int trial = 0; trial < 400; trial++) {
        make(&stand, 2 * COLUMNS - 1 - trial % 2, 2 * ROWS - 1 - trial / 2 % 2);
        for (int i = 0; i < 3; i++) {
            int at = (int)(random_between(&random, 0.0, 1.0) * COUNT);

            if (random_between(&random, 0.0, 1.0) < 0.4) stand.roughness[at] = PIXEL_CALM_MOST + 1;
            if (random_between(&random, 0.0, 1.0) < 0.2) stand.signatures[at] = 7;
            if (random_between(&random, 0.0, 1.0) < 0.2) stand.depth[at] = 5.2f;
            if (random_between(&random, 0.0, 1.0) < 0.4)
                stand.forced[(int)(random_between(&random, 0.0, 1.0) * stand.params.finer_columns *
                                   stand.params.finer_rows)] = 1;
        }
        if (trial % 5 == 0) stand.params.forced = NULL;
        if (trial % 7 == 0) stand.planes.depth = NULL;
        check(&stand);
    }
}

static void a_single_column_and_row_is_one_cell(void **state)
{
    uint8_t roughness = PIXEL_CALM_MOST;
    uint32_t signature = 3;
    const struct pixel_planes planes = {.signatures = &signature};
    struct pixel_calm calm;

    (void)state;
    pixel_calm_init(
        &calm,
        &(struct pixel_calm_params){
            .planes = &planes, .roughness = &roughness, .columns = 1, .rows = 1, .finer_columns = 1, .finer_rows = 1});
    pixel_calm_find(&calm, 0);
    assert_int_equal(calm.run_count, 0);
    roughness++;
    pixel_calm_find(&calm, 0);
    assert_int_equal(calm.run_count, 1);
    assert_int_equal(calm.runs[0].end, 1);
    pixel_calm_finish(&calm);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_calm_where_nothing_asks_for_a_ray),
        cmocka_unit_test(a_single_column_and_row_is_one_cell),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
