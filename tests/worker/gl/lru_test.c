// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/lru.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

struct shelf {
    struct lru lru;
    int dropped[LRU_LIMIT]; // indices, in their order
    int dropped_count;
};

static void drop(void *user, int index)
{
    struct shelf *shelf = user;

    shelf->dropped[shelf->dropped_count++] = index;
}

static void make_key(char key[static HASH_TEXT_SIZE], int number)
{
    snprintf(key, HASH_TEXT_SIZE, "%032d", number);
}

static int find(struct shelf *shelf, int number)
{
    char key[HASH_TEXT_SIZE];

    make_key(key, number);
    return lru_find(&shelf->lru, key);
}

static int keep(struct shelf *shelf, int number, size_t size_bytes)
{
    char key[HASH_TEXT_SIZE];
    int index = lru_make_room(&shelf->lru, size_bytes, drop, shelf);

    make_key(key, number);
    lru_put(&shelf->lru, index, key, size_bytes);
    return index;
}

static void what_is_kept_is_found_by_its_key(void **state)
{
    struct shelf shelf = {.lru = {.capacity = 4, .idle_bytes_limit = 100}};
    int first, second;

    lru_begin(&shelf.lru);
    first = keep(&shelf, 1, 10);
    second = keep(&shelf, 2, 10);
    assert_int_not_equal(first, second);
    lru_begin(&shelf.lru);
    assert_int_equal(find(&shelf, 1), first);
    assert_int_equal(find(&shelf, 2), second);
    assert_int_equal(find(&shelf, 3), -1);
    assert_int_equal(shelf.dropped_count, 0);
}

static void a_full_shelf_drops_what_was_used_longest_ago(void **state)
{
    struct shelf shelf = {.lru = {.capacity = 3, .idle_bytes_limit = SIZE_MAX / 2}};
    int indices[3];

    for (int i = 0; i < 3; ++i) {
        lru_begin(&shelf.lru);
        indices[i] = keep(&shelf, i, 1);
    }
    lru_begin(&shelf.lru);
    (void)find(&shelf, 0);
    lru_begin(&shelf.lru);
    assert_int_equal(keep(&shelf, 3, 1), indices[1]);
    assert_int_equal(shelf.dropped_count, 1);
    assert_int_equal(shelf.dropped[0], indices[1]);
    assert_int_equal(find(&shelf, 1), -1);
    assert_int_equal(find(&shelf, 0), indices[0]);
}

static void idle_bytes_are_limited(void **state)
{
    struct shelf shelf = {.lru = {.capacity = 8, .idle_bytes_limit = 100}};

    for (int i = 0; i < 3; ++i) {
        lru_begin(&shelf.lru);
        (void)keep(&shelf, i, 40);
    }
    assert_int_equal(shelf.dropped_count, 1); // 40 + 40 are idle beside the 40 to come
    assert_int_equal(find(&shelf, 0), -1);
    assert_true(find(&shelf, 1) >= 0);
}

static void what_is_in_use_is_neither_dropped_nor_counted(void **state)
{
    struct shelf shelf = {.lru = {.capacity = 4, .idle_bytes_limit = 100}};

    lru_begin(&shelf.lru);
    (void)keep(&shelf, 1, 1000);
    lru_begin(&shelf.lru);
    (void)find(&shelf, 1);
    (void)keep(&shelf, 2, 1000);
    (void)keep(&shelf, 3, 1000);
    assert_int_equal(shelf.dropped_count, 0);
    lru_begin(&shelf.lru);
    (void)find(&shelf, 3);
    (void)keep(&shelf, 4, 50);
    assert_int_equal(shelf.dropped_count, 2);
    assert_true(find(&shelf, 3) >= 0);
}

static void clearing_drops_each_thing_once(void **state)
{
    struct shelf shelf = {.lru = {.capacity = 4, .idle_bytes_limit = 100}};

    lru_begin(&shelf.lru);
    (void)keep(&shelf, 1, 1);
    lru_remove(&shelf.lru, keep(&shelf, 2, 1), drop, &shelf);
    assert_int_equal(shelf.dropped_count, 1);
    lru_clear(&shelf.lru, drop, &shelf);
    lru_clear(&shelf.lru, drop, &shelf);
    assert_int_equal(shelf.dropped_count, 2);
    assert_int_equal(find(&shelf, 1), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_kept_is_found_by_its_key),
        cmocka_unit_test(a_full_shelf_drops_what_was_used_longest_ago),
        cmocka_unit_test(idle_bytes_are_limited),
        cmocka_unit_test(what_is_in_use_is_neither_dropped_nor_counted),
        cmocka_unit_test(clearing_drops_each_thing_once),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
