// SPDX-License-Identifier: Apache-2.0
#include "core/wire/metrics_text.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FAMILY_LIMIT = 1000, SAMPLE_LIMIT = 100 * 1000, BUCKET_LIMIT = 100, LABEL_LIMIT = 16, NUMBER_SIZE = 32 };

enum family_type { TYPE_COUNTER, TYPE_GAUGE, TYPE_HISTOGRAM };
static const char *const type_names[] = {"counter", "gauge", "histogram", NULL};

static const double NUMBER_MAX = 1.7e308;
static const int64_t COUNT_MAX = (int64_t)1 << 53;

struct family {
    const char *name; // borrowed from the document
    enum family_type type;
};

// The text grows in `stream`.
struct page {
    FILE *stream;
    const char **names; // owned; of the families so far, borrowed from the document
    size_t name_count, name_capacity;
};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_name(const char *text)
{
    if (!is_letter(*text)) return false;
    while (is_letter(*text) || (*text >= '0' && *text <= '9'))
        text++;
    return *text == '\0';
}

static bool read_name(const struct json_node *node, const char **name, struct error *error)
{
    if (!json_read_string(node, name, error)) return false;
    return is_name(*name) || json_fail_expected(node, error, "letters, digits and _, no digit first");
}

// In a label's value a quote is escaped, too.
static void write_escaped(FILE *stream, const char *text, bool is_value)
{
    for (; *text; text++) {
        if (*text == '\\' || (*text == '"' && is_value)) putc('\\', stream);
        fputs(*text == '\n' ? "\\n" : (char[]){*text, '\0'}, stream);
    }
}

// As few digits as read back.
static void format_number(double number, char text[static NUMBER_SIZE])
{
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, NUMBER_SIZE, "%.*g", digits, number);
        if (strtod(text, NULL) == number) return;
    }
}

static void write_number(FILE *stream, double number)
{
    char text[NUMBER_SIZE];

    format_number(number, text);
    fputs(text, stream);
}

// `le` is the label of a bucket's end; NULL: none.
static bool write_labels(FILE *stream, const struct json_node *labels, const char *le, struct error *error)
{
    struct json_node label = {0};
    const char *separator = "{", *value;

    if (!json_check_object(labels, error)) return false;
    if (json_node_count(labels) > LABEL_LIMIT) return json_fail_expected(labels, error, "16 labels at the most");
    while (json_node_next(labels, &label)) {
        if (!is_name(label.key) || strncmp(label.key, "__", 2) == 0 || strcmp(label.key, "le") == 0)
            return json_fail_expected(&label, error,
                                      "a label's name: letters, digits and _, no digit first; not \"le\"");
        if (!json_read_string(&label, &value, error)) return false;
        fprintf(stream, "%s%s=\"", separator, label.key);
        write_escaped(stream, value, true);
        putc('"', stream);
        separator = ",";
    }
    if (le) fprintf(stream, "%sle=\"%s\"", separator, le);
    if (le || *separator == ',') putc('}', stream);
    return true;
}

// One line. Its number follows.
static bool begin_line(FILE *stream, const struct family *family, const char *suffix, const struct json_node *labels,
                       const char *le, struct error *error)
{
    fprintf(stream, "%s%s", family->name, suffix);
    if (!write_labels(stream, labels, le, error)) return false;
    putc(' ', stream);
    return true;
}

// A number that JSON could not hold is null, and nobody knows it.
static bool write_value(FILE *stream, const struct json_node *node, struct error *error)
{
    double number;

    if (json_node_type(node) == JSON_NULL) {
        fputs("NaN\n", stream);
        return true;
    }
    if (!json_read_number(node, -NUMBER_MAX, NUMBER_MAX, &number, error)) return false;
    write_number(stream, number);
    putc('\n', stream);
    return true;
}

static bool write_line(FILE *stream, const struct family *family, const char *suffix, const struct json_node *sample,
                       const char *key, struct error *error)
{
    struct json_node labels = json_node_child(sample, "labels"), value = json_node_child(sample, key);

    return begin_line(stream, family, suffix, &labels, NULL, error) && write_value(stream, &value, error);
}

// A bucket is [END, COUNT]; `*end` and `*count` are those of the one before.
static bool read_bucket(const struct json_node *bucket, double *end, int64_t *count, struct error *error)
{
    struct json_node end_node = json_node_element(bucket, 0), count_node = json_node_element(bucket, 1);
    double before = *end;
    int64_t least = *count;

    if (!json_check_array(bucket, 2, 2, error)) return false;
    if (!json_read_number(&end_node, -NUMBER_MAX, NUMBER_MAX, end, error)) return false;
    if (bucket->index > 0 && *end <= before) return json_fail_expected(&end_node, error, "more than the end before");
    return json_read_integer(&count_node, least, COUNT_MAX, count, error);
}

static bool write_histogram(FILE *stream, const struct family *family, const struct json_node *sample,
                            struct error *error)
{
    struct json_node labels = json_node_child(sample, "labels"), buckets = json_node_child(sample, "buckets");
    struct json_node total_node = json_node_child(sample, "count"), bucket = {0};
    double end = 0;
    int64_t count = 0, total;
    char le[NUMBER_SIZE];

    if (!json_check_array(&buckets, 0, BUCKET_LIMIT, error)) return false;
    while (json_node_next(&buckets, &bucket)) {
        if (!read_bucket(&bucket, &end, &count, error)) return false;
        format_number(end, le);
        if (!begin_line(stream, family, "_bucket", &labels, le, error)) return false;
        fprintf(stream, "%lld\n", (long long)count);
    }
    if (!json_read_integer(&total_node, count, COUNT_MAX, &total, error)) return false;
    if (!begin_line(stream, family, "_bucket", &labels, "+Inf", error)) return false;
    fprintf(stream, "%lld\n", (long long)total);
    return write_line(stream, family, "_sum", sample, "sum", error) &&
           write_line(stream, family, "_count", sample, "count", error);
}

static bool read_family(struct page *page, const struct json_node *node, struct family *family, struct error *error)
{
    struct json_node name = json_node_child(node, "name"), type = json_node_child(node, "type");
    int choice;

    if (!json_check_object(node, error) || !read_name(&name, &family->name, error)) return false;
    if (!json_read_enum(&type, type_names, &choice, error)) return false;
    family->type = (enum family_type)choice;
    for (size_t i = 0; i < page->name_count; i++)
        if (strcmp(page->names[i], family->name) == 0)
            return json_fail_expected(&name, error, "a name that no family before has");
    page->names = xgrow(page->names, &page->name_capacity, page->name_count + 1, sizeof page->names[0]);
    page->names[page->name_count++] = family->name;
    return true;
}

static bool write_family(struct page *page, const struct json_node *node, struct error *error)
{
    struct json_node help_node = json_node_child(node, "help"), samples = json_node_child(node, "samples");
    struct json_node sample = {0};
    struct family family;
    const char *help;

    if (!read_family(page, node, &family, error) || !json_read_string(&help_node, &help, error)) return false;
    if (!json_check_array(&samples, 0, SAMPLE_LIMIT, error)) return false;
    fprintf(page->stream, "# HELP %s ", family.name);
    write_escaped(page->stream, help, false);
    fprintf(page->stream, "\n# TYPE %s %s\n", family.name, type_names[family.type]);
    while (json_node_next(&samples, &sample)) {
        if (!json_check_object(&sample, error)) return false;
        if (family.type == TYPE_HISTOGRAM ? !write_histogram(page->stream, &family, &sample, error)
                                          : !write_line(page->stream, &family, "", &sample, "value", error))
            return false;
    }
    return true;
}

static bool write_families(struct page *page, const struct json_node *result, struct error *error)
{
    struct json_node families = json_node_child(result, "families"), family = {0};

    if (!json_check_array(&families, 0, FAMILY_LIMIT, error)) return false;
    while (json_node_next(&families, &family))
        if (!write_family(page, &family, error)) return false;
    return true;
}

char *metrics_text_format(const struct json_node *result, struct error *error)
{
    char *text = NULL;
    size_t length = 0;
    struct page page = {.stream = open_memstream(&text, &length)};
    bool ok;

    if (!page.stream) abort(); // memory is out
    ok = write_families(&page, result, error);
    if (fclose(page.stream) != 0) abort();
    free(page.names);
    if (ok) return text;
    free(text);
    return NULL;
}
