// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/half_row.h"

#define IMATH_HALF_NO_LOOKUP_TABLE
#include <Imath/half.h>
#include <stdbool.h>

// Converts from pixel `first` on.
static void split(uint16_t *const planes[HALF_ROW_PLANES], const float *pixels, size_t count, size_t first)
{
    for (size_t x = first; x < count; x++)
        for (size_t i = 0; i < HALF_ROW_PLANES; i++)
            if (planes[i]) planes[i][x] = imath_float_to_half(pixels[x * HALF_ROW_PLANES + i]);
}

#ifdef __x86_64__
#include <immintrin.h>

// Not all compilers know F16C by name. Every processor with AVX2 has it.
static bool has_conversion(void)
{
    return __builtin_cpu_supports("avx2");
}

// Two pixels.
__attribute__((target("avx,f16c"))) static __m128i convert_two(const float *pixels)
{
    return _mm256_cvtps_ph(_mm256_loadu_ps(pixels), _MM_FROUND_TO_NEAREST_INT);
}

static void store(uint16_t *plane, size_t x, __m128i eight)
{
    if (plane) _mm_storeu_si128((__m128i *)(void *)(plane + x), eight);
}

// Eight pixels at a time are a matrix of halves, which is transposed.
__attribute__((target("avx,f16c"))) static void split_by_processor(uint16_t *const planes[HALF_ROW_PLANES],
                                                                   const float *pixels, size_t count)
{
    size_t x = 0;

    for (; x + 8 <= count; x += 8) {
        const float *from = pixels + x * HALF_ROW_PLANES;
        __m128i p01 = convert_two(from), p23 = convert_two(from + 8);
        __m128i p45 = convert_two(from + 16), p67 = convert_two(from + 24);
        __m128i p02 = _mm_unpacklo_epi16(p01, p23), p13 = _mm_unpackhi_epi16(p01, p23);
        __m128i p46 = _mm_unpacklo_epi16(p45, p67), p57 = _mm_unpackhi_epi16(p45, p67);
        __m128i rg_low = _mm_unpacklo_epi16(p02, p13), ba_low = _mm_unpackhi_epi16(p02, p13);
        __m128i rg_high = _mm_unpacklo_epi16(p46, p57), ba_high = _mm_unpackhi_epi16(p46, p57);

        store(planes[0], x, _mm_unpacklo_epi64(rg_low, rg_high));
        store(planes[1], x, _mm_unpackhi_epi64(rg_low, rg_high));
        store(planes[2], x, _mm_unpacklo_epi64(ba_low, ba_high));
        store(planes[3], x, _mm_unpackhi_epi64(ba_low, ba_high));
    }
    split(planes, pixels, count, x);
}
#else
static bool has_conversion(void)
{
    return false;
}

static void split_by_processor(uint16_t *const planes[HALF_ROW_PLANES], const float *pixels, size_t count)
{
    split(planes, pixels, count, 0);
}
#endif

void half_row_split(uint16_t *const planes[static HALF_ROW_PLANES], const float *pixels, size_t count)
{
    if (has_conversion())
        split_by_processor(planes, pixels, count);
    else
        split(planes, pixels, count, 0);
}
