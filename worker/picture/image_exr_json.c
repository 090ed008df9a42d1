// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr_json.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"
#include "worker/picture/image_exr.h"

#include <stdlib.h>
#include <string.h>

enum { ATTRIBUTE_LIMIT = 256, TEXT_LIMIT = 64 * 1024, NUMBER_LIMIT = 16 };

static const char *name_compression(enum job_compression compression)
{
    switch (compression) {
    case JOB_COMPRESSION_NONE:
        return "none";
    case JOB_COMPRESSION_RLE:
        return "rle";
    case JOB_COMPRESSION_ZIPS:
        return "zips";
    case JOB_COMPRESSION_ZIP:
        return "zip";
    case JOB_COMPRESSION_PIZ:
        return "piz";
    }
    return NULL;
}

static void write_channels(exr_context_t context, struct json_writer *writer)
{
    const exr_attr_chlist_t *channels;

    json_write_key(writer, "channels");
    json_write_begin_array(writer);
    if (!exr_get_channels(context, 0, &channels))
        for (int i = 0; i < channels->num_channels; i++) {
            const exr_attr_chlist_entry_t *channel = &channels->entries[i];

            json_write_begin_object(writer);
            json_write_string_member(writer, "name", channel->name.str);
            json_write_string_member(writer, "pixel",
                                     channel->pixel_type == EXR_PIXEL_HALF    ? "half"
                                     : channel->pixel_type == EXR_PIXEL_FLOAT ? "float"
                                                                              : "integer");
            json_write_end_object(writer);
        }
    json_write_end_array(writer);
}

// A text of the file need not end where its length says, and may have zeros inside.
static void write_text(struct json_writer *writer, const exr_attr_string_t *string)
{
    size_t length = string->length > 0 ? (size_t)string->length : 0;
    char *text = xstrndup(string->str ? string->str : "", length < TEXT_LIMIT ? length : TEXT_LIMIT);

    json_write_string(writer, text);
    free(text);
}

static size_t take_floats(const float *from, size_t count, double *numbers)
{
    for (size_t i = 0; i < count; i++)
        numbers[i] = (double)from[i];
    return count;
}

static size_t take_integers(const int32_t *from, size_t count, double *numbers)
{
    for (size_t i = 0; i < count; i++)
        numbers[i] = from[i];
    return count;
}

// Returns how many numbers the attribute has; 0: it is of another type.
static size_t find_numbers(const exr_attribute_t *attribute, double numbers[static NUMBER_LIMIT])
{
    switch (attribute->type) {
    case EXR_ATTR_INT:
        return take_integers(&attribute->i, 1, numbers);
    case EXR_ATTR_FLOAT:
        return take_floats(&attribute->f, 1, numbers);
    case EXR_ATTR_DOUBLE:
        numbers[0] = attribute->d;
        return 1;
    case EXR_ATTR_RATIONAL:
        numbers[0] = attribute->rational->num;
        numbers[1] = attribute->rational->denom;
        return 2;
    case EXR_ATTR_BOX2I:
        take_integers((const int32_t[]){attribute->box2i->min.x, attribute->box2i->min.y}, 2, numbers);
        return 2 + take_integers((const int32_t[]){attribute->box2i->max.x, attribute->box2i->max.y}, 2, numbers + 2);
    case EXR_ATTR_V2F:
        return take_floats((const float[]){attribute->v2f->x, attribute->v2f->y}, 2, numbers);
    case EXR_ATTR_V3F:
        return take_floats((const float[]){attribute->v3f->x, attribute->v3f->y, attribute->v3f->z}, 3, numbers);
    case EXR_ATTR_M44F:
        return take_floats(attribute->m44f->m, 16, numbers);
    default:
        return 0;
    }
}

static void write_attribute(struct json_writer *writer, const exr_attribute_t *attribute)
{
    double numbers[NUMBER_LIMIT];
    size_t count = find_numbers(attribute, numbers);

    if (count == 0 && attribute->type != EXR_ATTR_STRING) return;
    json_write_key(writer, attribute->name);
    if (count == 0) write_text(writer, attribute->string);
    if (count == 1) json_write_number(writer, numbers[0]);
    if (count < 2) return;
    json_write_begin_array(writer);
    for (size_t i = 0; i < count; i++)
        json_write_number(writer, numbers[i]);
    json_write_end_array(writer);
}

static void write_attributes(exr_context_t context, struct json_writer *writer)
{
    int32_t count = 0;

    json_write_key(writer, "attributes");
    json_write_begin_object(writer);
    if (exr_get_attribute_count(context, 0, &count)) count = 0;
    for (int32_t i = 0; i < count && i < ATTRIBUTE_LIMIT; i++) {
        const exr_attribute_t *attribute;

        if (!exr_get_attribute_by_index(context, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute))
            write_attribute(writer, attribute);
    }
    json_write_end_object(writer);
}

void image_exr_json_write(exr_context_t context, const struct image_exr_facts *facts, struct json_writer *writer)
{
    json_write_begin_object(writer);
    json_write_integer_member(writer, "width_px", facts->width_px);
    json_write_integer_member(writer, "height_px", facts->height_px);
    json_write_string_member(writer, "compression", name_compression(facts->compression));
    write_channels(context, writer);
    write_attributes(context, writer);
    json_write_end_object(writer);
}
