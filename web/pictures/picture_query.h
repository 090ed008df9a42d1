// What a browser asks of a frame, and how it is shown: /frame/JOB/N.png or /frame/JOB/N.json; or /job/JOB/explain.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct json_writer;

enum picture_form { PICTURE_FORM_PNG, PICTURE_FORM_HEADER, PICTURE_FORM_EXPLANATION };

enum { PICTURE_CHANNEL_LIMIT = 255 }; // bytes of a channel's name

struct picture_query {
    int64_t job;
    int32_t frame; // 0 for a job's explanation
    enum picture_form form;
    char channel[PICTURE_CHANNEL_LIMIT + 1]; // empty: colour
    bool has_exposure;
    double exposure;         // stops
    int x, y, width, height; // px, of a part; width and height 0: up to the edge
    int size;                // px, of the PNG's longest side; 0: as large as it may be
};

// Reads the path, and what stands behind its question mark: decoded texts NAME=VALUE. A name that is not known, or
// comes twice, is an error; only pictures have any.
bool picture_query_parse(struct picture_query *query, const char *path, const char *const pairs[], size_t pair_count,
                         struct error *error);
// Writes the members of worker.picture that the query has, in one order: equal pictures have equal texts.
void picture_query_write(const struct picture_query *query, struct json_writer *writer);
