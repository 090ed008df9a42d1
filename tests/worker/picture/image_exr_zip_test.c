// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr_zip.h"

#include "tests/support/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <zlib.h>

#include <cmocka.h>

enum { LARGEST = 5000 };

static const size_t sizes[] = {2, 4, 14, 16, 18, 30, 32, 34, 62, 64, 66, 4098, LARGEST};
enum { SIZE_COUNT = sizeof sizes / sizeof sizes[0] };

// Rising bytes with jumps of every size, which pack well.
static void fill(uint8_t *chunk, size_t count, uint32_t seed)
{
    struct random random = {seed};

    for (size_t i = 0; i < count; i++)
        chunk[i] = (uint8_t)(i % 8 ? chunk[i - 1] + (i % 2) : random_between(&random, 0, 256));
}

// The zlib stream of a chunk, byte by byte, as "Technical Introduction to OpenEXR" and its library define it.
static void filter(uint8_t *filtered, const uint8_t *chunk, size_t count)
{
    for (size_t i = 0; i < count; i++)
        filtered[i % 2 * (count / 2) + i / 2] = chunk[i];
    for (size_t i = count - 1; i > 0; i--)
        filtered[i] = (uint8_t)(filtered[i] - (filtered[i - 1] - 128));
}

// Returns what a file stores of a chunk that is added in pieces of `piece` bytes.
static const void *pack_pieces(struct image_exr_zip *zip, const uint8_t *chunk, size_t count, size_t piece,
                               size_t *packed_bytes)
{
    image_exr_zip_begin(zip, count);
    for (size_t at = 0; at < count; at += piece)
        image_exr_zip_add(zip, chunk + at, piece < count - at ? piece : count - at);
    return image_exr_zip_end(zip, packed_bytes);
}

static const void *pack(struct image_exr_zip *zip, const uint8_t *chunk, size_t count, size_t *packed_bytes)
{
    return pack_pieces(zip, chunk, count, count, packed_bytes);
}

static void a_chunk_is_packed_as_the_format_has_it(void **state)
{
    struct image_exr_zip *zip = image_exr_zip_create(LARGEST);
    uint8_t chunk[LARGEST], filtered[LARGEST], found[LARGEST];

    for (size_t i = 0; i < SIZE_COUNT; i++) {
        const void *packed;
        uLongf found_bytes = sizeof found;
        size_t packed_bytes;

        fill(chunk, sizes[i], (uint32_t)i);
        packed = pack(zip, chunk, sizes[i], &packed_bytes);
        if (packed_bytes == sizes[i] && sizes[i] < 64) continue;
        assert_in_range(packed_bytes, 1, sizes[i] - 1);
        assert_int_equal(uncompress(found, &found_bytes, packed, packed_bytes), Z_OK);
        filter(filtered, chunk, sizes[i]);
        assert_int_equal(found_bytes, sizes[i]);
        assert_memory_equal(found, filtered, sizes[i]);
    }
    image_exr_zip_destroy(zip);
}

static void pieces_are_packed_as_the_whole_chunk(void **state)
{
    struct image_exr_zip *zip = image_exr_zip_create(LARGEST);
    uint8_t chunk[LARGEST], expected[LARGEST];

    for (size_t i = 0; i < SIZE_COUNT; i++) {
        size_t expected_bytes, packed_bytes;
        const void *packed;

        fill(chunk, sizes[i], (uint32_t)i);
        packed = pack(zip, chunk, sizes[i], &expected_bytes);
        memcpy(expected, packed, expected_bytes);
        for (size_t piece = 2; piece < 100; piece += 2) {
            packed = pack_pieces(zip, chunk, sizes[i], piece, &packed_bytes);
            assert_int_equal(packed_bytes, expected_bytes);
            assert_memory_equal(packed, expected, packed_bytes);
        }
    }
    image_exr_zip_destroy(zip);
}

// A chunk's bytes follow from it alone: tables keep nothing of the chunks before it.
static void a_chunk_is_packed_alike_each_time(void **state)
{
    struct image_exr_zip *fresh = image_exr_zip_create(LARGEST), *used = image_exr_zip_create(LARGEST);
    uint8_t chunk[LARGEST], expected[LARGEST];

    for (uint32_t seed = 0; seed < 50; seed++) {
        const void *packed;
        size_t packed_bytes, again_bytes;

        fill(chunk, sizeof chunk, seed + 100);
        pack(used, chunk, sizeof chunk, &packed_bytes);
        fill(chunk, sizeof chunk, 1);
        packed = pack(fresh, chunk, sizeof chunk, &packed_bytes);
        assert_in_range(packed_bytes, 1, sizeof chunk - 1);
        memcpy(expected, packed, packed_bytes);
        packed = pack(used, chunk, sizeof chunk, &again_bytes);
        assert_int_equal(again_bytes, packed_bytes);
        assert_memory_equal(packed, expected, packed_bytes);
    }
    image_exr_zip_destroy(fresh);
    image_exr_zip_destroy(used);
}

static void what_is_not_smaller_is_stored_as_it_is(void **state)
{
    struct image_exr_zip *zip = image_exr_zip_create(LARGEST);
    struct random random = {7};
    uint8_t chunk[LARGEST];
    size_t stored_bytes;

    for (size_t i = 0; i < sizeof chunk; i++)
        chunk[i] = (uint8_t)random_between(&random, 0, 256);
    for (size_t i = 0; i < SIZE_COUNT; i++) {
        const void *stored = pack(zip, chunk, sizes[i], &stored_bytes);

        assert_int_equal(stored_bytes, sizes[i]);
        assert_memory_equal(stored, chunk, sizes[i]);
    }
    image_exr_zip_destroy(zip);
}

static void what_others_packed_is_unpacked(void **state)
{
    struct image_exr_zip *zip = image_exr_zip_create(LARGEST);
    uint8_t chunk[LARGEST], filtered[LARGEST], packed[2 * LARGEST], found[LARGEST];

    for (size_t i = 0; i < SIZE_COUNT; i++)
        for (int level = 0; level <= 9; level += 3) {
            uLongf packed_bytes = sizeof packed;

            fill(chunk, sizes[i], (uint32_t)i);
            filter(filtered, chunk, sizes[i]);
            assert_int_equal(compress2(packed, &packed_bytes, filtered, sizes[i], level), Z_OK);
            assert_true(image_exr_zip_unpack(zip, packed, packed_bytes, found, sizes[i]));
            assert_memory_equal(found, chunk, sizes[i]);
        }
    image_exr_zip_destroy(zip);
}

// Two chunks that differ in their last bytes alone, one after the other in every order.
static void equal_neighbours_and_others_are_unpacked(void **state)
{
    struct image_exr_zip *zip = image_exr_zip_create(LARGEST);
    uint8_t chunks[2][LARGEST] = {{0}}, packed[2][LARGEST], found[LARGEST];
    size_t packed_bytes[2];

    for (int i = 0; i < 2; i++) {
        memset(chunks[i] + LARGEST - 2, 50 + i, 2);
        memcpy(packed[i], pack(zip, chunks[i], LARGEST, &packed_bytes[i]), LARGEST);
    }
    assert_int_equal(packed_bytes[0], packed_bytes[1]);
    for (int turn = 0; turn < 32; turn++)
        for (int bit = 0; bit < 5; bit++) {
            int i = turn >> bit & 1;

            memset(found, 77, sizeof found);
            assert_true(image_exr_zip_unpack(zip, packed[i], packed_bytes[i], found, LARGEST));
            assert_memory_equal(found, chunks[i], LARGEST);
        }
    assert_false(image_exr_zip_unpack(zip, packed[0], packed_bytes[0], found, LARGEST - 2));
    image_exr_zip_destroy(zip);
}

// What is kept of a chunk is forgotten when the next one is packed, or is damaged.
static void nothing_is_left_of_a_chunk_before(void **state)
{
    struct image_exr_zip *zip = image_exr_zip_create(LARGEST);
    uint8_t chunk[LARGEST], packed[LARGEST], found[LARGEST];
    size_t packed_bytes, unwanted;

    fill(chunk, sizeof chunk, 1);
    memcpy(packed, pack(zip, chunk, LARGEST, &packed_bytes), LARGEST);
    assert_true(image_exr_zip_unpack(zip, packed, packed_bytes, found, LARGEST));
    assert_false(image_exr_zip_unpack(zip, packed, packed_bytes - 1, found, LARGEST));
    assert_true(image_exr_zip_unpack(zip, packed, packed_bytes, found, LARGEST));
    assert_memory_equal(found, chunk, LARGEST);
    packed[packed_bytes - 1] ^= 1; // of the checksum
    assert_false(image_exr_zip_unpack(zip, packed, packed_bytes, found, LARGEST));
    packed[packed_bytes - 1] ^= 1;
    fill(found, sizeof found, 2);
    pack(zip, found, LARGEST, &unwanted);
    assert_true(image_exr_zip_unpack(zip, packed, packed_bytes, found, LARGEST));
    assert_memory_equal(found, chunk, LARGEST);
    image_exr_zip_destroy(zip);
}

static void a_damaged_chunk_is_refused(void **state)
{
    struct image_exr_zip *zip = image_exr_zip_create(1000);
    uint8_t chunk[1002], packed[1000], found[1002];
    const void *borrowed;
    size_t packed_bytes;

    fill(chunk, sizeof chunk, 3);
    borrowed = pack(zip, chunk, 1000, &packed_bytes);
    assert_in_range(packed_bytes, 1, 999);
    memcpy(packed, borrowed, packed_bytes);
    assert_true(image_exr_zip_unpack(zip, packed, packed_bytes, found, 1000));
    assert_false(image_exr_zip_unpack(zip, packed, packed_bytes, found, 998));
    assert_false(image_exr_zip_unpack(zip, packed, packed_bytes, found, 999));
    assert_false(image_exr_zip_unpack(zip, packed, packed_bytes, found, 1002));
    assert_false(image_exr_zip_unpack(zip, packed, packed_bytes - 1, found, 1000));
    packed[packed_bytes - 1] ^= 1; // of the checksum
    assert_false(image_exr_zip_unpack(zip, packed, packed_bytes, found, 1000));
    image_exr_zip_destroy(zip);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chunk_is_packed_as_the_format_has_it),
        cmocka_unit_test(a_chunk_is_packed_alike_each_time),
        cmocka_unit_test(pieces_are_packed_as_the_whole_chunk),
        cmocka_unit_test(what_is_not_smaller_is_stored_as_it_is),
        cmocka_unit_test(what_others_packed_is_unpacked),
        cmocka_unit_test(equal_neighbours_and_others_are_unpacked),
        cmocka_unit_test(nothing_is_left_of_a_chunk_before),
        cmocka_unit_test(a_damaged_chunk_is_refused),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
