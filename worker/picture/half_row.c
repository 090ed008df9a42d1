// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/half_row.h"

#define IMATH_HALF_NO_LOOKUP_TABLE
#include <Imath/half.h>
#include <stdbool.h>

static void convert(uint16_t *halves, const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        halves[i] = imath_float_to_half(values[i]);
}

#ifdef __x86_64__
#include <immintrin.h>

// Not all compilers know F16C by name. Every processor with AVX2 has it.
static bool has_conversion(void)
{
    return __builtin_cpu_supports("avx2");
}

__attribute__((target("avx,f16c"))) static void convert_by_processor(uint16_t *halves, const float *values,
                                                                     size_t count)
{
    size_t i = 0;

    for (; i + 8 <= count; i += 8)
        _mm_storeu_si128((__m128i *)(void *)(halves + i),
                         _mm256_cvtps_ph(_mm256_loadu_ps(values + i), _MM_FROUND_TO_NEAREST_INT));
    convert(halves + i, values + i, count - i);
}
#else
static bool has_conversion(void)
{
    return false;
}

static void convert_by_processor(uint16_t *halves, const float *values, size_t count)
{
    convert(halves, values, count);
}
#endif

void half_row_from_floats(uint16_t *halves, const float *values, size_t count)
{
    if (has_conversion())
        convert_by_processor(halves, values, count);
    else
        convert(halves, values, count);
}
