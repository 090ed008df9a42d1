// SPDX-License-Identifier: Apache-2.0
#include "tests/support/volume_maker_nifti.h"

#include "tests/support/volume_maker.h"

#include <stdlib.h>
#include <string.h>

// 'b', 's', 'i', 'l': integers of 1, 2, 4, 8 bytes; 'f', 'd': floats of 4, 8.
static const struct {
    const char *name;
    size_t offsets[2];
    char kinds[3];
} fields[] = {
    {"sizeof_hdr", {0, 0}, "ii"},     {"dim", {40, 16}, "sl"},          {"datatype", {70, 12}, "ss"},
    {"bitpix", {72, 14}, "ss"},       {"pixdim", {76, 104}, "fd"},      {"vox_offset", {108, 168}, "fl"},
    {"scl_slope", {112, 176}, "fd"},  {"scl_inter", {116, 184}, "fd"},  {"xyzt_units", {123, 500}, "bi"},
    {"qform_code", {252, 344}, "si"}, {"sform_code", {254, 348}, "si"}, {"quatern_b", {256, 352}, "fd"},
    {"quatern_c", {260, 360}, "fd"},  {"quatern_d", {264, 368}, "fd"},  {"qoffset_x", {268, 376}, "fd"},
    {"qoffset_y", {272, 384}, "fd"},  {"qoffset_z", {276, 392}, "fd"},  {"srow_x", {280, 400}, "fd"},
    {"srow_y", {296, 432}, "fd"},     {"srow_z", {312, 464}, "fd"},
};

static size_t encode(char kind, double number, unsigned char bytes[8])
{
    int8_t b = kind == 'b' ? (int8_t)number : 0;
    int16_t s = kind == 's' ? (int16_t)number : 0;
    int32_t i = kind == 'i' ? (int32_t)number : 0;
    int64_t l = kind == 'l' ? (int64_t)number : 0;
    float f = (float)number;

    switch (kind) {
    case 'b':
        memcpy(bytes, &b, sizeof b);
        return sizeof b;
    case 's':
        memcpy(bytes, &s, sizeof s);
        return sizeof s;
    case 'i':
        memcpy(bytes, &i, sizeof i);
        return sizeof i;
    case 'l':
        memcpy(bytes, &l, sizeof l);
        return sizeof l;
    case 'f':
        memcpy(bytes, &f, sizeof f);
        return sizeof f;
    default:
        memcpy(bytes, &number, sizeof number);
        return sizeof number;
    }
}

void volume_maker_nifti_set(struct volume_maker_nifti *nifti, const char *field, size_t index, double number)
{
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        unsigned char bytes[8];
        size_t size;

        if (strcmp(fields[i].name, field) != 0) continue;
        size = encode(fields[i].kinds[nifti->version - 1], number, bytes);
        for (size_t byte = 0; byte < size; byte++)
            nifti->bytes[fields[i].offsets[nifti->version - 1] + index * size + byte] =
                bytes[nifti->is_big_endian ? size - 1 - byte : byte];
        return;
    }
    abort();
}

void volume_maker_nifti_init(struct volume_maker_nifti *nifti, int version, bool is_big_endian, const int size[3],
                             enum volume_stored stored)
{
    static const double datatypes[] = {2, 256, 512, 4, 768, 8, 1280, 1024, 16, 64};
    size_t offset = version == 1 ? 352 : 544;
    size_t voxel_bytes;
    unsigned char *voxels = volume_maker_voxels(size, stored, is_big_endian, &voxel_bytes);

    *nifti = (struct volume_maker_nifti){.version = version, .is_big_endian = is_big_endian};
    nifti->size_bytes = offset + voxel_bytes;
    nifti->bytes = calloc(1, nifti->size_bytes);
    if (!nifti->bytes) abort();
    memcpy(nifti->bytes + offset, voxels, voxel_bytes);
    free(voxels);
    if (version == 1)
        memcpy(nifti->bytes + 344, "n+1", 4);
    else
        memcpy(nifti->bytes + 4, "n+2\0\r\n\032\n", 8);
    volume_maker_nifti_set(nifti, "sizeof_hdr", 0, version == 1 ? 348 : 540);
    volume_maker_nifti_set(nifti, "dim", 0, 3);
    for (size_t axis = 0; axis < 3; axis++) {
        volume_maker_nifti_set(nifti, "dim", axis + 1, size[axis]);
        volume_maker_nifti_set(nifti, "pixdim", axis + 1, 1);
    }
    volume_maker_nifti_set(nifti, "datatype", 0, datatypes[stored]);
    volume_maker_nifti_set(nifti, "bitpix", 0, 8 * (double)volume_stored_size(stored));
    volume_maker_nifti_set(nifti, "vox_offset", 0, (double)offset);
    volume_maker_nifti_set(nifti, "xyzt_units", 0, 2);
}

void volume_maker_nifti_finish(struct volume_maker_nifti *nifti)
{
    free(nifti->bytes);
    *nifti = (struct volume_maker_nifti){0};
}
