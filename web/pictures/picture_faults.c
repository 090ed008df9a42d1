// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_faults.h"

#include <stdio.h>
#include <string.h>

void picture_faults_note(struct picture_faults *faults, const char *key, enum picture_status status,
                         const struct error *error, int64_t now_ms)
{
    struct picture_fault *fault = &faults->faults[faults->next];

    if (status != PICTURE_UNREADABLE && status != PICTURE_FAULT && status != PICTURE_SLOW && status != PICTURE_WRONG)
        return;
    faults->next = (faults->next + 1) % PICTURE_FAULT_COUNT;
    *fault = (struct picture_fault){.status = status, .error = *error, .until_ms = now_ms + PICTURE_FAULT_MS};
    snprintf(fault->key, sizeof fault->key, "%s", key);
}

const struct picture_fault *picture_faults_find(const struct picture_faults *faults, const char *key, int64_t now_ms)
{
    for (size_t i = 0; i < PICTURE_FAULT_COUNT; i++)
        if (faults->faults[i].until_ms > now_ms && !strcmp(faults->faults[i].key, key)) return &faults->faults[i];
    return NULL;
}
