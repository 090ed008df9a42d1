// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/pool_terms.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/schedule_json.h"

#include <ctype.h>
#include <grp.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TERM_LIMIT = 64 }; // tags of a pool, users of a pool

static bool add_tag(struct pool_terms *terms, const char *word, struct error *error)
{
    if (!schedule_is_pool_name(word)) {
        error_set(error, "tags: expected letters, digits and -._@:, got \"%s\"", word);
        return false;
    }
    terms->tags = xrealloc(terms->tags, (terms->tag_count + 1) * sizeof terms->tags[0]);
    terms->tags[terms->tag_count++] = xstrdup(word);
    return true;
}

static bool is_user(const char *word)
{
    if (*word == '@') word++;
    if (!*word) return false;
    for (; *word; word++)
        if (!isgraph((unsigned char)*word) || *word == '@') return false;
    return true;
}

static bool add_user(struct pool_terms *terms, const char *word, struct error *error)
{
    const struct group *group = *word == '@' ? getgrnam(word + 1) : NULL;

    if (!is_user(word)) {
        error_set(error, "users: expected names of users, and of groups after @, got \"%s\"", word);
        return false;
    }
    terms->users = xrealloc(terms->users, (terms->user_count + 1) * sizeof terms->users[0]);
    terms->users[terms->user_count++] =
        (struct pool_user){.name = xstrdup(word), .gid = group ? (int64_t)group->gr_gid : -1};
    return true;
}

static bool read_words(struct pool_terms *terms, const char *value, const char *key, size_t *count,
                       bool (*add)(struct pool_terms *terms, const char *word, struct error *error),
                       struct error *error)
{
    char *copy = xstrdup(value), *rest = copy, *word;
    bool ok = true;

    while (ok && (word = strsep(&rest, ", ")) != NULL)
        if (*word) ok = add(terms, word, error);
    free(copy);
    if (ok && *count == 0) error_set(error, "%s: expected NAME,NAME,..., got nothing", key);
    if (ok && *count > TERM_LIMIT) error_set(error, "%s: expected at most %d", key, TERM_LIMIT);
    return ok && *count > 0 && *count <= TERM_LIMIT;
}

bool pool_terms_read_tags(struct pool_terms *terms, const char *value, struct error *error)
{
    return read_words(terms, value, "tags", &terms->tag_count, add_tag, error);
}

bool pool_terms_read_users(struct pool_terms *terms, const char *value, struct error *error)
{
    return read_words(terms, value, "users", &terms->user_count, add_user, error);
}

void pool_terms_finish(struct pool_terms *terms)
{
    for (size_t i = 0; i < terms->tag_count; i++)
        free(terms->tags[i]);
    for (size_t i = 0; i < terms->user_count; i++)
        free(terms->users[i].name);
    free(terms->tags);
    free(terms->users);
    *terms = (struct pool_terms){0};
}

bool pool_terms_have_tag(const struct pool_terms *terms, const char *tag)
{
    for (size_t i = 0; i < terms->tag_count; i++)
        if (strcmp(terms->tags[i], tag) == 0) return true;
    return false;
}

static bool is_of_groups(int64_t gid, const gid_t *groups, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if ((int64_t)groups[i] == gid) return true;
    return false;
}

bool pool_terms_let(const struct pool_terms *terms, int64_t uid, const char *name, const gid_t *groups, size_t count)
{
    char number[24];

    snprintf(number, sizeof number, "%" PRId64, uid);
    for (size_t i = 0; i < terms->user_count; i++) {
        const struct pool_user *user = &terms->users[i];

        if (strcmp(user->name, name) == 0 || strcmp(user->name, number) == 0) return true;
        if (is_of_groups(user->gid, groups, count)) return true;
    }
    return terms->user_count == 0;
}

bool pool_terms_are_same(const struct pool_terms *a, const struct pool_terms *b)
{
    if (a->tag_count != b->tag_count || a->user_count != b->user_count) return false;
    for (size_t i = 0; i < a->tag_count; i++)
        if (strcmp(a->tags[i], b->tags[i]) != 0) return false;
    for (size_t i = 0; i < a->user_count; i++)
        if (strcmp(a->users[i].name, b->users[i].name) != 0 || a->users[i].gid != b->users[i].gid) return false;
    return true;
}

char *pool_terms_format_users(const struct pool_terms *terms)
{
    char *list = NULL;

    for (size_t i = 0; i < terms->user_count; i++) {
        char *longer = list ? xasprintf("%s, %s", list, terms->users[i].name) : xstrdup(terms->users[i].name);

        free(list);
        list = longer;
    }
    return list ? list : xstrdup("everybody");
}
