// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_voxels.h"

#include <string.h>

static const struct {
    const char *name;
    size_t size_bytes;
    enum volume_type type;
} kinds[] = {
    [VOLUME_STORED_UINT8] = {"uint8", 1, VOLUME_UINT8},       [VOLUME_STORED_INT8] = {"int8", 1, VOLUME_FLOAT32},
    [VOLUME_STORED_UINT16] = {"uint16", 2, VOLUME_UINT16},    [VOLUME_STORED_INT16] = {"int16", 2, VOLUME_INT16},
    [VOLUME_STORED_UINT32] = {"uint32", 4, VOLUME_FLOAT32},   [VOLUME_STORED_INT32] = {"int32", 4, VOLUME_FLOAT32},
    [VOLUME_STORED_UINT64] = {"uint64", 8, VOLUME_FLOAT32},   [VOLUME_STORED_INT64] = {"int64", 8, VOLUME_FLOAT32},
    [VOLUME_STORED_FLOAT32] = {"float32", 4, VOLUME_FLOAT32}, [VOLUME_STORED_FLOAT64] = {"float64", 8, VOLUME_FLOAT32},
};

size_t volume_type_size(enum volume_type type)
{
    static const size_t sizes[] = {[VOLUME_UINT8] = 1, [VOLUME_UINT16] = 2, [VOLUME_INT16] = 2, [VOLUME_FLOAT32] = 4};

    return sizes[type];
}

size_t volume_stored_size(enum volume_stored stored)
{
    return kinds[stored].size_bytes;
}

const char *volume_stored_name(enum volume_stored stored)
{
    return kinds[stored].name;
}

enum volume_type volume_stored_type(enum volume_stored stored)
{
    return kinds[stored].type;
}

void volume_voxels_swap(void *values, size_t count, enum volume_stored stored)
{
    switch (volume_stored_size(stored)) {
    case 2:
        for (uint16_t *value = values; count > 0; count--, value++)
            *value = __builtin_bswap16(*value);
        break;
    case 4:
        for (uint32_t *value = values; count > 0; count--, value++)
            *value = __builtin_bswap32(*value);
        break;
    case 8:
        for (uint64_t *value = values; count > 0; count--, value++)
            *value = __builtin_bswap64(*value);
        break;
    default:
        break;
    }
}

// Compares bits, without a branch in the loop, so that it is as fast as memory.
static size_t find_not_finite(const float *values, size_t count)
{
    const uint32_t exponent = 0x7f800000;
    uint32_t found = 0;
    uint32_t bits;

    for (size_t i = 0; i < count; i++) {
        memcpy(&bits, values + i, sizeof bits);
        found |= (bits & exponent) == exponent;
    }
    for (size_t i = 0; found && i < count; i++) {
        memcpy(&bits, values + i, sizeof bits);
        if ((bits & exponent) == exponent) return i;
    }
    return count;
}

#define CONVERT(type)                                                                                                  \
    for (size_t i = 0; i < count; i++)                                                                                 \
        values[i] = (float)((const type *)from)[i];                                                                    \
    break

static void convert_to_float(float *values, const void *from, size_t count, enum volume_stored stored)
{
    switch (stored) {
    case VOLUME_STORED_INT8:
        CONVERT(int8_t);
    case VOLUME_STORED_UINT32:
        CONVERT(uint32_t);
    case VOLUME_STORED_INT32:
        CONVERT(int32_t);
    case VOLUME_STORED_UINT64:
        CONVERT(uint64_t);
    case VOLUME_STORED_INT64:
        CONVERT(int64_t);
    case VOLUME_STORED_FLOAT64:
        CONVERT(double);
    default:
        break;
    }
}

size_t volume_voxels_convert(void *to, const void *from, size_t count, enum volume_stored stored)
{
    if (volume_stored_type(stored) != VOLUME_FLOAT32 || stored == VOLUME_STORED_FLOAT32) {
        if (to != from) memcpy(to, from, count * volume_stored_size(stored));
    } else {
        convert_to_float(to, from, count, stored);
    }
    return volume_stored_type(stored) == VOLUME_FLOAT32 ? find_not_finite(to, count) : count;
}
