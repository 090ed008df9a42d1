// An EXR file that is open for reading, and the first thing that the library finds wrong with it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/openexr.h>
#include <pthread.h>
#include <stdbool.h>

struct error;

struct image_exr_source {
    exr_context_t context;
    int fd;               // borrowed
    pthread_mutex_t lock; // guards what follows
    char message[256];    // the library's first error
};

// Reads the header, with sides up to IMAGE_SIDE_LIMIT. To be closed in any case.
bool image_exr_source_open(struct image_exr_source *source, int fd, struct error *error);
void image_exr_source_close(struct image_exr_source *source);
// Sets `error` to the library's first message or, if it gave none, to that of `result`. Returns false.
bool image_exr_source_fail(struct image_exr_source *source, exr_result_t result, struct error *error);
