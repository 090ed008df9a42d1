// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_mistakes.h"

#include "cli/job/json_set.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"

#include <stdlib.h>
#include <string.h>

enum { MISTAKE_LIMIT = 64 };

#define COUNT(array) (sizeof(array) / sizeof *(array))

// What is right at most places. The camera is where nobody's is, so that no target coincides with it.
static const char right[] =
    "{\"version\":1,\"name\":\"x\",\"frames\":\"0\",\"fps\":24,\"resolution\":[16,16],\"camera\":{\"position\":["
    "12345.5,6789.25,-4321.125],\"target\":[1.5,2.25,3.125],\"fov\":40,\"clip\":[0.5,900000]},\"lights\":[{\"kind\":"
    "\"point\",\"intensity\":1,\"position\":[0,9,0]}],\"scene\":{\"media\":[{\"sigma_s\":1,\"density\":{\"kind\":"
    "\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}}}],\"objects\":[{\"kind\":"
    "\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{\"kind\":\"mirror\"}}]},\"output\":{\"path\":"
    "\"x/x.####.exr\"}}";
// What may be right elsewhere.
static const char *const fillers[] = {"1", "0.5", "90", "[0.25,0.5,0.75]", "\"x.nvdb\""};

struct search {
    char *text;          // owned; the document, with what was found mended
    struct error error;  // what is wrong with it; empty: nothing
    struct error *found; // owned
    size_t count, capacity;
};

// Of the path that a message begins with; 0: it is about the whole document.
static size_t path_length(const char *message)
{
    size_t length = strcspn(message, ": ");

    return strncmp(message + length, ": ", 2) == 0 ? length : 0;
}

static bool ends_step(char byte)
{
    return byte == '\0' || byte == '.' || byte == '[' || byte == ':';
}

// Whether the message is about the path, what contains it or a part of it.
static bool concerns(const char *message, const char *path)
{
    size_t length = path_length(message);

    if (length > strlen(path)) length = strlen(path);
    return length > 0 && strncmp(message, path, length) == 0 && ends_step(message[length]) && ends_step(path[length]);
}

// Goes on with the edited document, which it takes over, if what is wrong with it is wrong elsewhere.
static bool try_edited(struct search *search, char *edited, const char *path)
{
    struct error error = {0};
    struct job job;

    if (!edited) return false;
    if (job_parse(&job, edited, strlen(edited), "/", &error)) {
        job_finish(&job);
    } else if (path ? concerns(error.message, path) : strcmp(error.message, search->error.message) == 0) {
        free(edited);
        return false;
    }
    free(search->text);
    search->text = edited;
    search->error = error;
    return true;
}

// What is wrong then has to be wrong outside of `apart`.
static bool try_value(struct search *search, const char *document, const char *path, const char *value,
                      const char *apart)
{
    char *assignment = xasprintf("%s=%s", path, value);
    bool ok = try_edited(search, json_set(document, assignment, NULL), apart);

    free(assignment);
    return ok;
}

// The path's value in the right document, whatever the path's indices are; NULL: it has none. Owned by the caller.
static char *find_right(const char *path)
{
    char *first = xstrdup(path), *to = first, *value = NULL;

    for (const char *from = path; *from; from++) {
        *to++ = *from;
        if (*from != '[') continue;
        *to++ = '0';
        from += strcspn(from, "]") - 1;
    }
    *to = '\0';
    free(json_take(right, first, &value));
    free(first);
    return value;
}

static void cut_last_step(char *path)
{
    size_t length = strlen(path);

    while (length > 0 && path[length - 1] != '.' && path[length - 1] != '[')
        length--;
    path[length > 0 ? length - 1 : 0] = '\0';
}

// Puts a value in the path's place that is right there and, if one can be, beside all that stands beside it.
static bool try_fillers(struct search *search, const char *document, const char *path)
{
    char *around = xstrdup(path);
    bool ok = false;

    cut_last_step(around);
    for (size_t i = 0; i < 2 * COUNT(fillers) && !ok; i++)
        ok = try_value(search, document, path, fillers[i % COUNT(fillers)], i < COUNT(fillers) ? around : path);
    free(around);
    return ok;
}

static bool mend_value(struct search *search, const char *path)
{
    char *value = find_right(path), *without = json_take(search->text, path, NULL), *document;
    bool ok = value && try_value(search, search->text, path, value, path);

    if (!ok && without) ok = try_edited(search, xstrdup(without), path);
    document = without ? without : xstrdup(search->text); // a number in place of a string would become one
    ok = ok || try_fillers(search, document, path);
    free(document);
    free(value);
    return ok;
}

// The text between the quotes that follow `before`; NULL: none. Owned by the caller.
static char *find_quoted(const char *message, const char *before)
{
    const char *found = strstr(message, before), *start = found ? found + strlen(before) : NULL;

    return start ? xstrndup(start, strcspn(start, "\"")) : NULL;
}

// Gives a key that is unknown the name that was meant, or removes it.
static bool mend_key(struct search *search, const char *path)
{
    char *key = find_quoted(search->error.message, "unknown key \"");
    char *meant = find_quoted(search->error.message, "did you mean \"");
    const char *dot = *path ? "." : "";
    char *place = xasprintf("%s%s%s", path, dot, key ? key : ""), *value = NULL, *without = NULL, *edited = NULL;
    bool ok = false;

    if (key) without = json_take(search->text, place, &value);
    if (without && meant) {
        char *assignment = xasprintf("%s%s%s=%s", path, dot, meant, value);
        char *name = xasprintf("%s%s%s", path, dot, meant), *other = json_take(without, name, NULL);

        if (!other) edited = json_set(without, assignment, NULL);
        free(other);
        free(name);
        free(assignment);
    }
    ok = try_edited(search, edited, NULL) || try_edited(search, without ? xstrdup(without) : NULL, NULL);
    free(without);
    free(value);
    free(place);
    free(meant);
    free(key);
    return ok;
}

// Whether the value at the path says which keys stand beside it.
static bool is_choice(const char *path)
{
    const char *dot = strrchr(path, '.');

    return dot && (strcmp(dot, ".method") == 0 || strcmp(dot, ".kind") == 0);
}

// Mends what the error is about or, where nothing is right there, what contains it. Of a choice that nobody can guess
// all that stands beside it is unknown.
static bool mend(struct search *search)
{
    char *path = xstrndup(search->error.message, path_length(search->error.message));
    char *meant = find_quoted(search->error.message, "did you mean \"");
    bool ok = mend_key(search, path) || (meant && *path && try_value(search, search->text, path, meant, path));

    if (!ok && is_choice(path)) cut_last_step(path);
    while (!ok && *path) {
        ok = mend_value(search, path);
        cut_last_step(path);
    }
    free(meant);
    free(path);
    return ok;
}

static bool is_found(const struct search *search)
{
    for (size_t i = 0; i < search->count; i++)
        if (strcmp(search->found[i].message, search->error.message) == 0) return true;
    return false;
}

static void add(struct search *search, const struct error *error)
{
    search->found = xgrow(search->found, &search->capacity, search->count + 1, sizeof *search->found);
    search->found[search->count++] = *error;
}

struct error *job_mistakes_find(const char *document, const struct error *first, size_t *count)
{
    struct search search = {.text = xstrdup(document), .error = *first};

    do
        add(&search, &search.error);
    while (search.count < MISTAKE_LIMIT && mend(&search) && *search.error.message && !is_found(&search));
    free(search.text);
    *count = search.count;
    return search.found;
}
