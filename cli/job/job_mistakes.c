// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_mistakes.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/job/quality_json.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <stdlib.h>
#include <string.h>

// A right job. Its camera is where nobody's is, so that no target coincides with it.
static const char right[] =
    "{\"version\":1,\"name\":\"x\",\"frames\":\"0\",\"fps\":24,\"resolution\":[16,16],\"camera\":{\"position\":["
    "12345.5,6789.25,-4321.125],\"target\":[1.5,2.25,3.125],\"fov\":40,\"clip\":[0.5,900000]},\"lights\":[],"
    "\"scene\":{\"media\":[],\"objects\":[]},\"output\":{\"path\":\"x/x.####.exr\"}}";
static const char right_light[] = "{\"kind\":\"point\",\"intensity\":1,\"position\":[0,9,0]}";
static const char right_medium[] =
    "{\"sigma_s\":1,\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\","
    "\"center\":[0,0,0],\"radius\":1}}}";
static const char right_object[] =
    "{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{\"kind\":\"mirror\"}}";

// What of the right job is replaced by the user's: a member, a member of that, and an element of that.
struct place {
    const char *key, *part; // `part` NULL: the whole member
    size_t index;
    const char *filler;            // for the elements before it; NULL: no element
    const struct json_node *value; // NULL: the member is left out
};

struct finding {
    struct json_node user, right;
    struct error *found; // owned
    size_t count, capacity;
};

static void write_node(struct json_writer *writer, const struct json_node *node)
{
    char *text = json_node_format(node);

    json_write_raw(writer, text, strlen(text));
    free(text);
}

static void write_value(struct json_writer *writer, const struct place *place)
{
    if (!place->filler) {
        write_node(writer, place->value);
        return;
    }
    json_write_begin_array(writer);
    for (size_t i = 0; i < place->index; i++)
        json_write_raw(writer, place->filler, strlen(place->filler));
    write_node(writer, place->value);
    json_write_end_array(writer);
}

// Writes the object with the member `key` replaced or added.
static void write_object(struct json_writer *writer, const struct json_node *object, const char *key,
                         const struct place *place)
{
    struct json_node member = {0}, old = json_node_child(object, key);

    json_write_begin_object(writer);
    while (json_node_next(object, &member)) {
        if (!strcmp(member.key, key)) continue;
        json_write_key(writer, member.key);
        write_node(writer, &member);
    }
    if (place->value) json_write_key(writer, key);
    if (place->value && place->part && key == place->key)
        write_object(writer, &old, place->part, place);
    else if (place->value)
        write_value(writer, place);
    json_write_end_object(writer);
}

static void add(struct finding *finding, const struct error *error)
{
    for (size_t i = 0; i < finding->count; i++)
        if (!strcmp(finding->found[i].message, error->message)) return;
    finding->found = xgrow(finding->found, &finding->capacity, finding->count + 1, sizeof *finding->found);
    finding->found[finding->count++] = *error;
}

// True when the place is right.
static bool try_place(struct finding *finding, const struct place *place)
{
    struct json_writer writer = {0};
    struct error error = {0};
    struct job job;
    bool ok;

    write_object(&writer, &finding->right, place->key, place);
    ok = job_parse(&job, writer.text, writer.length, "/", &error);
    if (ok)
        job_finish(&job);
    else
        add(finding, &error);
    json_writer_finish(&writer);
    return ok;
}

static void try_elements(struct finding *finding, const struct json_node *array, const char *key, const char *part,
                         const char *filler)
{
    struct json_node element = {0};

    while (json_node_next(array, &element))
        try_place(finding, &(struct place){key, part, element.index, filler, &element});
}

static void try_parts(struct finding *finding, const struct json_node *object, const char *key)
{
    struct json_node part = {0};

    while (json_node_next(object, &part)) {
        bool is_array = json_node_type(&part) == JSON_ARRAY, is_scene = !strcmp(key, "scene");

        if (is_scene && is_array && !strcmp(part.key, "media"))
            try_elements(finding, &part, key, part.key, right_medium);
        else if (is_scene && is_array && !strcmp(part.key, "objects"))
            try_elements(finding, &part, key, part.key, right_object);
        else
            try_place(finding, &(struct place){key, part.key, 0, NULL, &part});
    }
}

// Whether a quality suits the scene of its job is asked only where all else is right, as a part of the whole.
static void try_quality(struct finding *finding)
{
    struct job_quality quality;
    struct error error = {0};

    if (!quality_from_json(&quality, &finding->user, &error)) add(finding, &error);
}

static void try_member(struct finding *finding, const struct json_node *member)
{
    const char *key = member->key;
    bool is_object = json_node_type(member) == JSON_OBJECT;

    if (!strcmp(key, "quality"))
        try_quality(finding);
    else if (is_object && (!strcmp(key, "camera") || !strcmp(key, "output") || !strcmp(key, "scene")))
        try_parts(finding, member, key);
    else if (!strcmp(key, "lights") && json_node_type(member) == JSON_ARRAY)
        try_elements(finding, member, key, NULL, right_light);
    else
        try_place(finding, &(struct place){key, NULL, 0, NULL, member});
}

static void try_missing(struct finding *finding)
{
    static const char *const needed[] = {"version", "name", "frames", "fps", "resolution", "camera", "output"};

    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        struct json_node member = json_node_child(&finding->user, needed[i]);

        if (json_node_is_absent(&member)) try_place(finding, &(struct place){needed[i], NULL, 0, NULL, NULL});
    }
}

struct error *job_mistakes_find(const char *document, const struct error *first, size_t *count)
{
    struct finding finding = {0};
    struct cJSON *user = NULL, *other = NULL;
    struct json_node member = {0};

    add(&finding, first);
    if (json_parse(&user, document, strlen(document), NULL) && json_parse(&other, right, strlen(right), NULL)) {
        finding.user = json_node_root(user);
        finding.right = json_node_root(other);
        if (json_node_type(&finding.user) == JSON_OBJECT) try_missing(&finding);
        while (json_node_type(&finding.user) == JSON_OBJECT && json_node_next(&finding.user, &member))
            try_member(&finding, &member);
    }
    json_delete(user);
    json_delete(other);
    *count = finding.count;
    return finding.found;
}
