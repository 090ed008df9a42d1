// SPDX-License-Identifier: Apache-2.0
#include "tests/support/schema_check.h"

#include "core/base/utf8.h"

#include <float.h>
#include <math.h>
#include <regex.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct place {
    const struct json_node *root;     // of the schema
    const struct json_node *schema;   // the rules that hold here
    const struct json_node *document; // what they hold for
};

static bool accepts(const struct json_node *root, const struct json_node *schema, const struct json_node *document);

static void give_up(const char *why, const char *what)
{
    fprintf(stderr, "schema: %s: %s\n", why, what);
    abort();
}

static double number_of(const struct json_node *node)
{
    double number = NAN;

    json_read_number(node, -DBL_MAX, DBL_MAX, &number, NULL);
    return number;
}

static const char *text_of(const struct json_node *node)
{
    const char *text = "";

    json_read_string(node, &text, NULL);
    return text;
}

static bool is_equal(const struct json_node *a, const struct json_node *b)
{
    struct json_node child = {0}, other;
    enum json_type type = json_node_type(a);
    bool first, second;

    if (type != json_node_type(b) || json_node_count(a) != json_node_count(b)) return false;
    switch (type) {
    case JSON_NUMBER:
        return number_of(a) == number_of(b);
    case JSON_STRING:
        return strcmp(text_of(a), text_of(b)) == 0;
    case JSON_BOOL:
        return json_read_bool(a, &first, NULL) && json_read_bool(b, &second, NULL) && first == second;
    default:
        break;
    }
    while (json_node_next(a, &child)) {
        other = child.key ? json_node_child(b, child.key) : json_node_element(b, child.index);
        if (!is_equal(&child, &other)) return false;
    }
    return true;
}

static bool check_type(const struct place *place, const struct json_node *rule)
{
    static const char *const names[] = {"",       "null",  "boolean", "number",
                                        "string", "array", "object",  NULL}; // in the order of enum json_type
    enum json_type type = json_node_type(place->document);
    const char *wanted = text_of(rule);

    if (strcmp(wanted, "integer") == 0) {
        double number = number_of(place->document);

        return type == JSON_NUMBER && number == rint(number);
    }
    return strcmp(wanted, names[type]) == 0;
}

static bool check_const(const struct place *place, const struct json_node *rule)
{
    return is_equal(place->document, rule);
}

static bool check_enum(const struct place *place, const struct json_node *rule)
{
    struct json_node choice = {0};

    while (json_node_next(rule, &choice))
        if (is_equal(place->document, &choice)) return true;
    return false;
}

static bool check_required(const struct place *place, const struct json_node *rule)
{
    struct json_node key = {0};

    if (json_node_type(place->document) != JSON_OBJECT) return true;
    while (json_node_next(rule, &key)) {
        struct json_node member = json_node_child(place->document, text_of(&key));

        if (json_node_is_absent(&member)) return false;
    }
    return true;
}

static bool check_properties(const struct place *place, const struct json_node *rule)
{
    struct json_node schema = {0};

    while (json_node_next(rule, &schema)) {
        struct json_node member = json_node_child(place->document, schema.key);

        if (!json_node_is_absent(&member) && !accepts(place->root, &schema, &member)) return false;
    }
    return true;
}

static bool check_additional_properties(const struct place *place, const struct json_node *rule)
{
    struct json_node properties = json_node_child(place->schema, "properties"), member = {0};
    bool allowed;

    if (!json_read_bool(rule, &allowed, NULL) || allowed) give_up("not supported", "additionalProperties but false");
    if (json_node_type(place->document) != JSON_OBJECT) return true;
    while (json_node_next(place->document, &member)) {
        struct json_node known = json_node_child(&properties, member.key);

        if (json_node_is_absent(&known)) return false;
    }
    return true;
}

static bool check_items(const struct place *place, const struct json_node *rule)
{
    struct json_node prefix = json_node_child(place->schema, "prefixItems"), element = {0};

    if (json_node_type(place->document) != JSON_ARRAY) return true;
    while (json_node_next(place->document, &element))
        if (element.index >= json_node_count(&prefix) && !accepts(place->root, rule, &element)) return false;
    return true;
}

static bool check_prefix_items(const struct place *place, const struct json_node *rule)
{
    struct json_node schema = {0};

    while (json_node_next(rule, &schema)) {
        struct json_node element = json_node_element(place->document, schema.index);

        if (!json_node_is_absent(&element) && !accepts(place->root, &schema, &element)) return false;
    }
    return true;
}

static bool check_min_items(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_ARRAY || (double)json_node_count(place->document) >= number_of(rule);
}

static bool check_max_items(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_ARRAY || (double)json_node_count(place->document) <= number_of(rule);
}

static bool check_unique_items(const struct place *place, const struct json_node *rule)
{
    size_t count = json_node_count(place->document);

    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < i; k++) {
            struct json_node a = json_node_element(place->document, i), b = json_node_element(place->document, k);

            if (is_equal(&a, &b)) return false;
        }
    return true;
}

static bool check_minimum(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_NUMBER || number_of(place->document) >= number_of(rule);
}

static bool check_maximum(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_NUMBER || number_of(place->document) <= number_of(rule);
}

static bool check_exclusive_minimum(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_NUMBER || number_of(place->document) > number_of(rule);
}

static bool check_exclusive_maximum(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_NUMBER || number_of(place->document) < number_of(rule);
}

static double character_count(const char *text)
{
    double count = 0.0;

    for (size_t rest = strlen(text), length; rest > 0; rest -= length, text += length, count++) {
        length = utf8_character_length(text, rest);
        if (length == 0) give_up("not UTF-8", text);
    }
    return count;
}

static bool check_min_length(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_STRING ||
           character_count(text_of(place->document)) >= number_of(rule);
}

static bool check_max_length(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_STRING ||
           character_count(text_of(place->document)) <= number_of(rule);
}

enum { PATTERN_LIMIT = 16 };

// Compiling costs a thousand times more than matching, and there are few patterns.
static const regex_t *compiled_pattern(const char *text)
{
    static struct {
        char text[256];
        regex_t pattern;
    } known[PATTERN_LIMIT];
    size_t i = 0;

    while (i < PATTERN_LIMIT && known[i].text[0] && strcmp(known[i].text, text) != 0)
        i++;
    if (i == PATTERN_LIMIT || strlen(text) >= sizeof known[i].text) give_up("no room for pattern", text);
    if (!known[i].text[0] && regcomp(&known[i].pattern, text, REG_EXTENDED | REG_NOSUB) != 0)
        give_up("wrong pattern", text);
    strcpy(known[i].text, text);
    return &known[i].pattern;
}

static bool check_pattern(const struct place *place, const struct json_node *rule)
{
    return json_node_type(place->document) != JSON_STRING ||
           regexec(compiled_pattern(text_of(rule)), text_of(place->document), 0, NULL, 0) == 0;
}

static bool check_any_of(const struct place *place, const struct json_node *rule)
{
    struct json_node schema = {0};

    while (json_node_next(rule, &schema))
        if (accepts(place->root, &schema, place->document)) return true;
    return false;
}

static bool check_not(const struct place *place, const struct json_node *rule)
{
    return !accepts(place->root, rule, place->document);
}

// Definitions are many and are looked up a million times.
static struct json_node find_definition(const struct json_node *root, const struct json_node *rule)
{
    static const char prefix[] = "#/$defs/";
    static struct {
        const struct cJSON *rule, *definition;
    } known[1024];
    struct json_node definitions = json_node_child(root, "$defs"), schema;
    size_t slot = (uintptr_t)rule->value / sizeof(void *) % 1024;
    const char *name = text_of(rule);

    if (known[slot].rule == rule->value) return json_node_root(known[slot].definition);
    if (strncmp(name, prefix, strlen(prefix)) != 0) give_up("not supported", name);
    schema = json_node_child(&definitions, name + strlen(prefix));
    if (json_node_is_absent(&schema)) give_up("no such definition", name);
    known[slot].rule = rule->value;
    known[slot].definition = schema.value;
    return schema;
}

static bool check_ref(const struct place *place, const struct json_node *rule)
{
    struct json_node schema = find_definition(place->root, rule);

    return accepts(place->root, &schema, place->document);
}

static bool check_nothing(const struct place *place, const struct json_node *rule)
{
    return true;
}

struct keyword {
    const char *name;
    bool (*check)(const struct place *place, const struct json_node *rule);
};

static const struct keyword keywords[] = {
    {"$ref", check_ref},
    {"description", check_nothing},
    {"anyOf", check_any_of},
    {"type", check_type},
    {"const", check_const},
    {"enum", check_enum},
    {"required", check_required},
    {"properties", check_properties},
    {"additionalProperties", check_additional_properties},
    {"items", check_items},
    {"prefixItems", check_prefix_items},
    {"minItems", check_min_items},
    {"maxItems", check_max_items},
    {"uniqueItems", check_unique_items},
    {"minimum", check_minimum},
    {"maximum", check_maximum},
    {"exclusiveMinimum", check_exclusive_minimum},
    {"exclusiveMaximum", check_exclusive_maximum},
    {"minLength", check_min_length},
    {"maxLength", check_max_length},
    {"pattern", check_pattern},
    {"not", check_not},
    {"$schema", check_nothing},
    {"$defs", check_nothing},
    {"title", check_nothing},
    {"default", check_nothing},
};

static bool accepts(const struct json_node *root, const struct json_node *schema, const struct json_node *document)
{
    struct place place = {root, schema, document};
    struct json_node rule = {0};

    if (json_node_type(schema) != JSON_OBJECT) give_up("not an object", schema->key ? schema->key : "schema");
    while (json_node_next(schema, &rule)) {
        size_t i = 0, count = sizeof keywords / sizeof keywords[0];

        while (i < count && strcmp(keywords[i].name, rule.key) != 0)
            i++;
        if (i == count) give_up("unknown keyword", rule.key);
        if (!keywords[i].check(&place, &rule)) return false;
    }
    return true;
}

bool schema_accepts(const struct json_node *root, const struct json_node *document)
{
    return accepts(root, root, document);
}
