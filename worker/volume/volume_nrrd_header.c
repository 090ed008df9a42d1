// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_nrrd_header.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "worker/volume/volume_stream.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    LINE_LIMIT = 64 * 1024,    // bytes; other tools put long tables into one line
    HEADER_LIMIT = 1024 * 1024 // bytes
};

// Both spellings where a field has two. The fields from NRRD_OTHER_FIRST on are in any order.
static const struct {
    const char *name, *other_name;
} fields[] = {
    [NRRD_TYPE] = {"type", NULL},
    [NRRD_DIMENSION] = {"dimension", NULL},
    [NRRD_SIZES] = {"sizes", NULL},
    [NRRD_ENCODING] = {"encoding", NULL},
    [NRRD_ENDIAN] = {"endian", NULL},
    [NRRD_DATA_FILE] = {"data file", "datafile"},
    [NRRD_LINE_SKIP] = {"line skip", "lineskip"},
    [NRRD_BYTE_SKIP] = {"byte skip", "byteskip"},
    [NRRD_SPACINGS] = {"spacings", NULL},
    [NRRD_AXIS_MINS] = {"axis mins", "axismins"},
    [NRRD_AXIS_MAXS] = {"axis maxs", "axismaxs"},
    [NRRD_UNITS] = {"units", NULL},
    [NRRD_KINDS] = {"kinds", NULL},
    [NRRD_SPACE] = {"space", NULL},
    [NRRD_SPACE_DIMENSION] = {"space dimension", NULL},
    [NRRD_SPACE_UNITS] = {"space units", NULL},
    [NRRD_SPACE_ORIGIN] = {"space origin", NULL},
    [NRRD_SPACE_DIRECTIONS] = {"space directions", NULL},
    [NRRD_OTHER_FIRST] = {"content", NULL},
    {"centers", "centerings"},
    {"labels", NULL},
    {"thicknesses", NULL},
    {"measurement frame", NULL},
    {"block size", "blocksize"},
    {"number", NULL},
    {"min", NULL},
    {"max", NULL},
    {"old min", "oldmin"},
    {"old max", "oldmax"},
    {"sample units", "sampleunits"},
};

enum { FIELD_COUNT = sizeof fields / sizeof fields[0] };

_Static_assert((int)FIELD_COUNT <= (int)NRRD_FIELD_LIMIT, "every field has a place in the header");

struct reader {
    struct volume_stream *stream;
    int line_number, header_bytes;
    char *line; // owned; the current one, without its end
    size_t capacity;
    bool is_at_end; // the file ended before a line
};

const char *volume_nrrd_field_name(enum volume_nrrd_field field)
{
    return fields[field].name;
}

void volume_nrrd_header_finish(struct volume_nrrd_header *header)
{
    for (size_t i = 0; i < NRRD_FIELD_LIMIT; i++)
        free(header->texts[i]);
    *header = (struct volume_nrrd_header){0};
}

static bool read_line(struct reader *reader, struct error *error)
{
    size_t length = 0;
    int byte;

    reader->line_number++;
    for (;;) {
        if (!volume_stream_read_byte(reader->stream, &byte, error)) return false;
        if (byte < 0 || byte == '\n') break;
        if (byte == '\0') {
            error_set(error, "line %d: expected text, got a zero byte", reader->line_number);
            return false;
        }
        if (length == LINE_LIMIT || ++reader->header_bytes > HEADER_LIMIT) {
            error_set(error, "line %d: %s", reader->line_number,
                      length == LINE_LIMIT ? "longer than 64 KiB" : "the header is longer than 1 MiB");
            return false;
        }
        reader->line = xgrow(reader->line, &reader->capacity, length + 2, 1);
        reader->line[length++] = (char)byte;
    }
    reader->is_at_end = byte < 0 && length == 0;
    while (length > 0 && isspace((unsigned char)reader->line[length - 1]))
        length--;
    reader->line = xgrow(reader->line, &reader->capacity, length + 1, 1);
    reader->line[length] = '\0';
    return true;
}

// Reads byte by byte, because a file of another kind may have no lines.
static bool read_magic(struct reader *reader, struct error *error)
{
    static const char magic[] = "NRRD000";
    int byte = 0;

    for (const char *at = magic; *at; at++) {
        if (!volume_stream_read_byte(reader->stream, &byte, error)) return false;
        if (byte != *at) goto wrong;
    }
    if (!volume_stream_read_byte(reader->stream, &byte, error)) return false;
    if (byte < '1' || byte > '6') goto wrong;
    if (!read_line(reader, error)) return false;
    if (!*reader->line) return true;
wrong:
    error_set(error, "line 1: expected NRRD's magic \"NRRD0001\" to \"NRRD0006\", got something else");
    return false;
}

static int find_field(const char *name, size_t length)
{
    for (int i = 0; i < FIELD_COUNT; i++) {
        const char *names[] = {fields[i].name, fields[i].other_name};

        for (size_t which = 0; which < 2 && names[which]; which++)
            if (strlen(names[which]) == length && strncasecmp(name, names[which], length) == 0) return i;
    }
    return -1;
}

static void set_unknown_error(const struct reader *reader, size_t name_length, struct error *error)
{
    const char *names[FIELD_COUNT + 1] = {NULL};
    char name[64];
    const char *nearest;

    for (size_t i = 0; i < FIELD_COUNT; i++)
        names[i] = fields[i].name;
    snprintf(name, sizeof name, "%.*s", (int)(name_length < sizeof name ? name_length : sizeof name - 1), reader->line);
    for (char *at = name; *at; at++)
        if (!isprint((unsigned char)*at)) *at = '?';
    nearest = nearest_name_find(name, names);
    error_set(error, "line %d: unknown field \"%s\"%s%s%s", reader->line_number, name,
              nearest ? ", did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
}

static bool take_line(struct volume_nrrd_header *header, const struct reader *reader, struct error *error)
{
    const char *colon = strchr(reader->line, ':');
    int field;

    if (reader->line[0] == '#') return true;
    if (!colon) {
        error_set(error, "line %d: expected \"field: text\", \"key:=text\" or a comment, got something else",
                  reader->line_number);
        return false;
    }
    field = colon[1] == '=' ? -1 : find_field(reader->line, (size_t)(colon - reader->line));
    if (field < 0) {
        if (strstr(reader->line, ":=")) return true; // a key that the format leaves to users
        set_unknown_error(reader, (size_t)(colon - reader->line), error);
        return false;
    }
    if (header->texts[field]) {
        error_set(error, "line %d: \"%s\" is given already in line %d", reader->line_number, fields[field].name,
                  header->lines[field]);
        return false;
    }
    header->texts[field] = xstrdup(colon + 1 + strspn(colon + 1, " \t"));
    header->lines[field] = reader->line_number;
    return true;
}

bool volume_nrrd_header_read(struct volume_nrrd_header *header, struct volume_stream *stream, struct error *error)
{
    struct reader reader = {.stream = stream};
    bool ok = read_magic(&reader, error);

    *header = (struct volume_nrrd_header){0};
    while (ok && !header->has_end && !reader.is_at_end) {
        ok = read_line(&reader, error);
        if (!ok || reader.is_at_end) break;
        header->has_end = reader.line[0] == '\0';
        if (!header->has_end) ok = take_line(header, &reader, error);
    }
    free(reader.line);
    return ok;
}
