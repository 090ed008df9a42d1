// Four floats that are computed with at once, such as the values of a pixel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string.h>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

// Compilers use SIMD units for it.
typedef float four __attribute__((vector_size(16)));

static inline four four_load(const float *from)
{
    four loaded;

    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

static inline void four_store(float *to, four stored)
{
    memcpy(to, &stored, sizeof stored);
}

// Of each pair the smaller and the larger one: a < b ? a : b, and a > b ? a : b. The largest of four.
#ifdef __SSE__
// Compilers do not see that SSE has an instruction for each of these, of the same bits, NaN and signed zeros included.
static inline four four_least(four a, four b)
{
    return (four)_mm_min_ps((__m128)a, (__m128)b);
}

static inline four four_most(four a, four b)
{
    return (four)_mm_max_ps((__m128)a, (__m128)b);
}

static inline float four_largest(four a)
{
    four pair = four_most(a, (four)_mm_movehl_ps((__m128)a, (__m128)a));

    return pair[0] > pair[1] ? pair[0] : pair[1];
}
#else
typedef int four_mask __attribute__((vector_size(16)));

static inline four four_choose(four_mask first, four a, four b)
{
    return (four)((first & (four_mask)a) | (~first & (four_mask)b));
}

static inline four four_least(four a, four b)
{
    return four_choose(a < b, a, b);
}

static inline four four_most(four a, four b)
{
    return four_choose(a > b, a, b);
}

static inline float four_largest(four a)
{
    float first = a[0] > a[2] ? a[0] : a[2], second = a[1] > a[3] ? a[1] : a[3];

    return first > second ? first : second;
}
#endif
