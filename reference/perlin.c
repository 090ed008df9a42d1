// SPDX-License-Identifier: Apache-2.0
#include "reference/perlin.h"

#include <assert.h>
#include <math.h>

// Perlin's table.
static const unsigned char PERMUTATION[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,  69,  142,
    8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,  94,  252, 219, 203,
    117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136, 171, 168, 68,  175, 74,  165,
    71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,
    55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,
    18,  169, 200, 196, 135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250,
    124, 123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189,
    28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,
    129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,
    242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114,
    67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180,
};

// Gradients towards the middles of a cube's edges; four of the twelve come twice.
static const double GRADIENT[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, //
    {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, //
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, //
    {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1},
};

// The table's entry for any integer, by its remainder.
static int permuted(int number)
{
    return PERMUTATION[(unsigned)number % 256];
}

// Along one axis: the lower lattice points, the distances from them and the weights of the upper ones.
struct sides {
    int point[PERLIN_BATCH];
    double away[PERLIN_BATCH], weight[PERLIN_BATCH];
};

// Inlined functions are compiled for their caller's instruction set.
#define INLINED static inline __attribute__((always_inline))

INLINED void find_sides(struct sides *sides, size_t count, const double *coordinates)
{
    for (size_t i = 0; i < count; i++) {
        double whole = floor(coordinates[i]), t = coordinates[i] - whole;

        // Exact: 256 is a power of two.
        sides->point[i] = (int)(whole - 256.0 * floor(whole / 256.0));
        sides->away[i] = t;
        sides->weight[i] = ((6.0 * t - 15.0) * t + 10.0) * t * t * t;
    }
}

// Corner n lies towards x, y and z by its bits 2, 1 and 0.
INLINED double ramp(int n, const double gradient[static 3], double x, double y, double z)
{
    return gradient[0] * (x - (n >> 2)) + gradient[1] * (y - (n >> 1 & 1)) + gradient[2] * (z - (n & 1));
}

INLINED void find_noise(size_t count, const double *x, const double *y, const double *z, double *values)
{
    struct sides sx, sy, sz;
    double gradient[8][3][PERLIN_BATCH];

    assert(count <= PERLIN_BATCH);
    find_sides(&sx, count, x);
    find_sides(&sy, count, y);
    find_sides(&sz, count, z);
    for (size_t i = 0; i < count; i++) {
        for (int n = 0; n < 8; n++) {
            int plane = permuted(sx.point[i] + (n >> 2)), column = permuted(plane + sy.point[i] + (n >> 1 & 1));
            const double *found = GRADIENT[permuted(column + sz.point[i] + (n & 1)) % 16];

            for (int a = 0; a < 3; a++)
                gradient[n][a][i] = found[a];
        }
    }
    for (size_t i = 0; i < count; i++) {
        double corner[8];

        for (int n = 0; n < 8; n++) {
            const double own[3] = {gradient[n][0][i], gradient[n][1][i], gradient[n][2][i]};

            corner[n] = ramp(n, own, sx.away[i], sy.away[i], sz.away[i]);
        }
        for (int n = 0; n < 8; n += 2)
            corner[n] += sz.weight[i] * (corner[n + 1] - corner[n]);
        for (int n = 0; n < 8; n += 4)
            corner[n] += sy.weight[i] * (corner[n + 2] - corner[n]);
        values[i] = corner[0] + sx.weight[i] * (corner[4] - corner[0]);
    }
}

void perlin_noise_plain(size_t count, const double *x, const double *y, const double *z, double *values)
{
    find_noise(count, x, y, z, values);
}

#ifdef __x86_64__
// AVX2 has no fused multiplication and addition, which would round differently.
__attribute__((target("avx2"))) static void find_noise_avx2(size_t count, const double *x, const double *y,
                                                            const double *z, double *values)
{
    find_noise(count, x, y, z, values);
}

void perlin_noise(size_t count, const double *x, const double *y, const double *z, double *values)
{
    if (__builtin_cpu_supports("avx2")) {
        find_noise_avx2(count, x, y, z, values);
    } else {
        perlin_noise_plain(count, x, y, z, values);
    }
}
#else
void perlin_noise(size_t count, const double *x, const double *y, const double *z, double *values)
{
    perlin_noise_plain(count, x, y, z, values);
}
#endif
