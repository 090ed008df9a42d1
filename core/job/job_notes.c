// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_notes.h"

#include "core/base/alloc.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <stdlib.h>
#include <string.h>

bool job_notes_is_printable(const char *text)
{
    for (const unsigned char *byte = (const unsigned char *)text; *byte; byte++)
        if (*byte < 0x20 || *byte == 0x7f || (*byte == 0xc2 && byte[1] >= 0x80 && byte[1] <= 0x9f)) return false;
    return true;
}

static bool read_comment(struct job_notes *notes, const struct json_node *node, struct error *error)
{
    const char *text;

    if (json_node_is_absent(node)) return true;
    if (!json_read_string(node, &text, error)) return false;
    if (!*text || strlen(text) > JOB_COMMENT_LIMIT || !job_notes_is_printable(text))
        return json_fail_expected(node, error, "1 to 1000 printable bytes");
    notes->comment = xstrdup(text);
    return true;
}

// A comma stands between tags where they are in one line.
static bool read_tag(struct job_notes *notes, const struct json_node *node, struct error *error)
{
    const char *text;

    if (!json_read_string(node, &text, error)) return false;
    if (!*text || strlen(text) > JOB_TAG_SIZE_LIMIT || strchr(text, ',') || !job_notes_is_printable(text))
        return json_fail_expected(node, error, "1 to 64 printable bytes without a comma");
    for (size_t i = 0; i < notes->tag_count; i++)
        if (!strcmp(notes->tags[i], text)) return json_fail(node, error, "\"%s\" is there twice", text);
    notes->tags[notes->tag_count++] = xstrdup(text);
    return true;
}

bool job_notes_from_json(struct job_notes *notes, const struct json_node *document, struct error *error)
{
    struct json_node comment = json_node_child(document, "comment"), tags = json_node_child(document, "tags");
    struct json_node tag = {0};

    if (!read_comment(notes, &comment, error)) return false;
    if (json_node_is_absent(&tags)) return true;
    if (!json_check_array(&tags, 0, JOB_TAG_LIMIT, error)) return false;
    while (json_node_next(&tags, &tag))
        if (!read_tag(notes, &tag, error)) return false;
    return true;
}

void job_notes_finish(struct job_notes *notes)
{
    free(notes->comment);
    for (size_t i = 0; i < notes->tag_count; i++)
        free(notes->tags[i]);
    *notes = (struct job_notes){0};
}

void job_notes_write_members(const struct job_notes *notes, struct json_writer *writer)
{
    json_write_string_member(writer, "comment", notes->comment);
    json_write_key(writer, "tags");
    json_write_begin_array(writer);
    for (size_t i = 0; i < notes->tag_count; i++)
        json_write_string(writer, notes->tags[i]);
    json_write_end_array(writer);
}

char *job_notes_format_tags(const struct job_notes *notes)
{
    char *line = NULL;

    for (size_t i = 0; i < notes->tag_count; i++) {
        char *longer = line ? xasprintf("%s, %s", line, notes->tags[i]) : xstrdup(notes->tags[i]);

        free(line);
        line = longer;
    }
    return line;
}
