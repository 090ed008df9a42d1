// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_query.h"

#include "core/base/error.h"
#include "core/base/utf8.h"
#include "core/job/frame_range.h"
#include "core/json/json_write.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_LIMIT = 16384, SIZE_LIMIT = 4096 };
static const double EXPOSURE_LIMIT_STOPS = 60;
static const char frame_prefix[] = "/frame/", job_prefix[] = "/job/";

// Reads digits, and returns what follows; NULL: there are none, or the number is over the limit.
static const char *read_digits(const char *text, int64_t limit, int64_t *number)
{
    const char *at = text;

    *number = 0;
    for (; *at >= '0' && *at <= '9'; at++) {
        *number = 10 * *number + (*at - '0');
        if (*number > limit) return NULL;
    }
    return at > text ? at : NULL;
}

static const char *read_job(struct picture_query *query, const char *path, const char *prefix)
{
    size_t length = strlen(prefix);

    return strncmp(path, prefix, length) ? NULL : read_digits(path + length, INT64_C(1) << 53, &query->job);
}

static bool read_job_path(struct picture_query *query, const char *path, struct error *error)
{
    const char *at = read_job(query, path, job_prefix);

    query->form = PICTURE_FORM_EXPLANATION;
    if (at && !strcmp(at, "/explain")) return true;
    error_set(error, "expected /job/JOB/explain");
    return false;
}

static bool read_path(struct picture_query *query, const char *path, struct error *error)
{
    const char *at = read_job(query, path, frame_prefix);
    int64_t frame = 0;

    if (!strncmp(path, job_prefix, strlen(job_prefix))) return read_job_path(query, path, error);

    if (at && *at == '/') {
        at = read_digits(at + 1, FRAME_NUMBER_LIMIT - 1, &frame);
        query->frame = (int32_t)frame;
        if (at && !strcmp(at, ".png")) return true;
        query->form = PICTURE_FORM_HEADER;
        if (at && !strcmp(at, ".json")) return true;
    }
    error_set(error, "expected /frame/JOB/N.png or /frame/JOB/N.json");
    return false;
}

static bool read_pixels(const char *name, const char *value, int min, int max, int *pixels, struct error *error)
{
    int64_t number;
    const char *end = read_digits(value, max, &number);

    *pixels = (int)number;
    if (end && *end == '\0' && number >= min) return true;
    error_set(error, "%s: expected a number of pixels from %d to %d", name, min, max);
    return false;
}

static bool read_exposure(struct picture_query *query, const char *value, struct error *error)
{
    char *end = NULL;

    errno = 0;
    query->has_exposure = true;
    // strtod also knows "inf", "nan" and hexadecimal numbers, which have letters.
    query->exposure = value[strspn(value, "+-.0123456789eE")] == '\0' ? strtod(value, &end) : NAN;
    if (end && end != value && *end == '\0' && !errno && fabs(query->exposure) <= EXPOSURE_LIMIT_STOPS) return true;
    error_set(error, "exposure: expected a number of stops from -%g to %g", EXPOSURE_LIMIT_STOPS, EXPOSURE_LIMIT_STOPS);
    return false;
}

static bool read_channel(struct picture_query *query, const char *value, struct error *error)
{
    bool is_name = *value != '\0' && strlen(value) <= PICTURE_CHANNEL_LIMIT;

    for (const char *at = value; *at;) {
        size_t length = utf8_character_length(at, strlen(at));

        is_name = is_name && length > 0;
        at += length > 0 ? length : 1;
    }
    if (!is_name || utf8_find_hidden(value)) {
        error_set(error, "channel: expected the name of a channel, of at most %d bytes", PICTURE_CHANNEL_LIMIT);
        return false;
    }
    // Colour is what is shown without a channel: both are one picture.
    if (strcmp(value, "color") != 0) strcpy(query->channel, value);
    return true;
}

static const char *const names[] = {"channel", "exposure", "x", "y", "w", "h", "size"};
enum { NAME_COUNT = sizeof names / sizeof names[0] };

static bool read_value(struct picture_query *query, const char *name, const char *value, struct error *error)
{
    switch (name[0]) {
    case 'c':
        return read_channel(query, value, error);
    case 'e':
        return read_exposure(query, value, error);
    case 'x':
        return read_pixels(name, value, 0, SIDE_LIMIT, &query->x, error);
    case 'y':
        return read_pixels(name, value, 0, SIDE_LIMIT, &query->y, error);
    case 'w':
        return read_pixels(name, value, 1, SIDE_LIMIT, &query->width, error);
    case 'h':
        return read_pixels(name, value, 1, SIDE_LIMIT, &query->height, error);
    default:
        return read_pixels(name, value, 1, SIZE_LIMIT, &query->size, error);
    }
}

static int find_name(const char *text, size_t length)
{
    for (int i = 0; i < NAME_COUNT; i++)
        if (strlen(names[i]) == length && !strncmp(names[i], text, length)) return i;
    return -1;
}

// Reads "NAME=VALUE".
static bool read_pair(struct picture_query *query, const char *pair, unsigned *seen, struct error *error)
{
    size_t length = strcspn(pair, "=");
    int name = find_name(pair, length);

    if (name < 0 || pair[length] == '\0') {
        error_set(error, "expected channel, exposure, x, y, w, h or size, each with =VALUE");
        return false;
    }
    if (*seen & 1U << name) {
        error_set(error, "%s: expected once", names[name]);
        return false;
    }
    *seen |= 1U << name;
    return read_value(query, names[name], pair + length + 1, error);
}

bool picture_query_parse(struct picture_query *query, const char *path, const char *const pairs[], size_t pair_count,
                         struct error *error)
{
    unsigned seen = 0;

    *query = (struct picture_query){0};
    if (!read_path(query, path, error)) return false;
    if (query->form != PICTURE_FORM_PNG && pair_count > 0) {
        error_set(error, "expected nothing after the question mark: only a picture has parts");
        return false;
    }
    for (size_t i = 0; i < pair_count; i++)
        if (!read_pair(query, pairs[i], &seen, error)) return false;
    return true;
}

static void write_pixels(struct json_writer *writer, const char *key, int pixels)
{
    if (pixels > 0) json_write_integer_member(writer, key, pixels);
}

void picture_query_write(const struct picture_query *query, struct json_writer *writer)
{
    if (query->channel[0]) json_write_string_member(writer, "channel", query->channel);
    if (query->has_exposure) json_write_number_member(writer, "exposure", query->exposure);
    write_pixels(writer, "x", query->x);
    write_pixels(writer, "y", query->y);
    write_pixels(writer, "width", query->width);
    write_pixels(writer, "height", query->height);
    write_pixels(writer, "size", query->size);
}
