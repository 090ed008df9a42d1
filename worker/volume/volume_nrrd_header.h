// The lines of a NRRD header: the text of each field, without its meaning.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct volume_stream;

// The fields, named as in the format's definition (teem.sourceforge.net/nrrd/format.html).
enum volume_nrrd_field {
    NRRD_TYPE,
    NRRD_DIMENSION,
    NRRD_SIZES,
    NRRD_ENCODING,
    NRRD_ENDIAN,
    NRRD_DATA_FILE,
    NRRD_LINE_SKIP,
    NRRD_BYTE_SKIP,
    NRRD_SPACINGS,
    NRRD_AXIS_MINS,
    NRRD_AXIS_MAXS,
    NRRD_UNITS,
    NRRD_KINDS,
    NRRD_SPACE,
    NRRD_SPACE_DIMENSION,
    NRRD_SPACE_UNITS,
    NRRD_SPACE_ORIGIN,
    NRRD_SPACE_DIRECTIONS,
    NRRD_OTHER_FIRST, // known, but not used
    NRRD_FIELD_LIMIT = 32
};

struct volume_nrrd_header {
    char *texts[NRRD_FIELD_LIMIT]; // owned; without blanks at either end; NULL: not given
    int lines[NRRD_FIELD_LIMIT];   // the line of each field, counted from 1
    bool has_end;                  // an empty line closed it; else the file ended
};

// Reads up to the voxels of an attached header, or to the end of a detached one. Fields given twice, unknown fields,
// and lines that are no field, key or comment are errors that name the line.
bool volume_nrrd_header_read(struct volume_nrrd_header *header, struct volume_stream *stream, struct error *error);
void volume_nrrd_header_finish(struct volume_nrrd_header *header);
const char *volume_nrrd_field_name(enum volume_nrrd_field field);
