// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_device.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { GPU_LIMIT = 64, ENTRY_SIZE = 64 };

bool gl_device_read_turn(const char *text, int *turn)
{
    size_t length;

    if (strncmp(text, "turn:", 5) != 0) return false;
    text += 5;
    length = strlen(text);
    if (length < 1 || length > 4 || strspn(text, "0123456789") != length) return false;
    *turn = atoi(text);
    return true;
}

// CUDA takes the beginning of a UUID for it.
static bool begins_with(const char *uuid, const char *wanted)
{
    if (strncasecmp(wanted, "GPU-", 4) == 0) wanted += 4;
    return *wanted && strncasecmp(wanted, uuid, strlen(wanted)) == 0;
}

// The place in `gpus` of the one that the entry names; -1: none.
static int find(const struct gl_device *devices, const int *gpus, size_t count, const char *entry)
{
    bool is_number = *entry && strspn(entry, "0123456789") == strlen(entry);
    bool has_numbers = false;

    for (size_t i = 0; i < count; i++)
        has_numbers = has_numbers || devices[gpus[i]].cuda_number >= 0;
    for (size_t i = 0; i < count; i++) {
        int number = has_numbers ? devices[gpus[i]].cuda_number : (int)i;

        if (is_number ? number == atoi(entry) : begins_with(devices[gpus[i]].uuid, entry)) return (int)i;
    }
    return -1;
}

static bool has(const int *list, size_t count, int index)
{
    for (size_t i = 0; i < count; i++)
        if (list[i] == index) return true;
    return false;
}

// Puts those that `visible` names into `named`.
static size_t find_named(const struct gl_device *devices, const int *gpus, size_t count, const char *visible,
                         int named[static GPU_LIMIT])
{
    size_t found = 0;

    while (*visible && found < GPU_LIMIT) {
        size_t length = strcspn(visible, ",");
        char entry[ENTRY_SIZE] = "";
        int place;

        if (length < sizeof entry) memcpy(entry, visible, length);
        place = find(devices, gpus, count, entry);
        if (place >= 0 && !has(named, found, gpus[place])) named[found++] = gpus[place];
        visible += length + (visible[length] == ',');
    }
    return found;
}

size_t gl_device_order(const struct gl_device *devices, size_t count, int turn, const char *visible, int *order)
{
    int gpus[GPU_LIMIT], named[GPU_LIMIT];
    size_t gpu_count = 0, named_count, chosen_count;

    for (size_t i = 0; i < count && gpu_count < GPU_LIMIT; i++)
        if (!devices[i].is_software) gpus[gpu_count++] = (int)i;
    if (visible && (!*visible || strcmp(visible, "NoDevFiles") == 0)) return 0;
    named_count = visible ? find_named(devices, gpus, gpu_count, visible, named) : 0;
    chosen_count = named_count > 0 ? named_count : gpu_count;
    for (size_t i = 0; i < chosen_count; i++)
        order[i] = (named_count > 0 ? named : gpus)[((size_t)turn + i) % chosen_count];
    return chosen_count;
}
