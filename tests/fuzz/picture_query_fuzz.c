// What a browser asks of a frame: a path, and behind the first '?' the query.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/json/json_write.h"
#include "web/pictures/picture_query.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { PAIR_LIMIT = 16 };

static void check_values(const struct picture_query *query)
{
    struct json_writer writer = {0};

    if (query->job < 0 || query->frame < 0 || query->x < 0 || query->y < 0 || query->width < 0 || query->height < 0)
        abort();
    if (query->size < 0 || query->size > 4096 || !(fabs(query->exposure) <= 60)) abort();
    if (memchr(query->channel, '\0', sizeof query->channel) == NULL) abort();
    json_write_begin_object(&writer);
    picture_query_write(query, &writer);
    json_write_end_object(&writer);
    json_writer_finish(&writer);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    char *text = malloc(size + 1), *rest;
    const char *pairs[PAIR_LIMIT];
    struct picture_query query;
    struct error error = {{0}};
    size_t count = 0;

    if (size > 0) memcpy(text, bytes, size);
    text[size] = '\0';
    rest = strchr(text, '?');
    if (rest) *rest++ = '\0';
    while (rest && count < PAIR_LIMIT)
        pairs[count++] = strsep(&rest, "&");
    if (picture_query_parse(&query, text, pairs, count, &error))
        check_values(&query);
    else if (!error.message[0])
        abort();
    free(text);
    return 0;
}
