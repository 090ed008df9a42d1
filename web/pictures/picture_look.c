// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_look.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

struct picture_look *picture_look_create(const struct picture_query *query, const char *subject, const char *worker,
                                         const struct path_list *roots)
{
    struct picture_look *look = xcalloc(1, sizeof *look);

    look->query = *query;
    look->subject = xstrdup(subject);
    look->worker = xstrdup(worker);
    for (size_t i = 0; i < roots->count; i++)
        path_list_add(&look->roots, xstrdup(roots->paths[i]));
    look->status = PICTURE_READY;
    return look;
}

struct picture_look *picture_look_copy(const struct picture_look *look)
{
    struct picture_look *copy = picture_look_create(&look->query, look->subject, look->worker, &look->roots);

    memcpy(copy->key, look->key, sizeof copy->key);
    copy->place = look->place;
    if (look->place.folder) copy->place.folder = xstrdup(look->place.folder);
    if (look->place.name) copy->place.name = xstrdup(look->place.name);
    return copy;
}

void picture_look_free(struct picture_look *look)
{
    if (!look) return;
    free(look->subject);
    free(look->worker);
    path_list_finish(&look->roots);
    picture_place_finish(&look->place);
    explanation_key_finish(&look->explanation);
    free(look);
}

struct picture_look *picture_look_of(struct lane_task *task)
{
    return (struct picture_look *)task;
}

static bool is_explanation(const struct picture_look *look)
{
    return look->query.form == PICTURE_FORM_EXPLANATION;
}

static bool has_begun(const struct picture_look *look)
{
    return look->explanation.writer.length > 0;
}

const char *picture_look_lane(const struct picture_look *look)
{
    const char *root;

    if (look->status != PICTURE_READY || look->key[0]) return NULL;
    if (is_explanation(look)) {
        root = explanation_key_root(&look->explanation);
    } else {
        root = path_list_find_root(&look->roots, look->subject);
    }
    return root ? root : "";
}

static void look_at_inputs(struct picture_look *look)
{
    const struct explanation explanation = {.document = look->subject, .worker = look->worker, .roots = &look->roots};

    if (has_begun(look))
        explanation_key_look(&look->explanation);
    else
        look->status = explanation_key_begin(&look->explanation, &explanation, &look->error);
    if (look->status == PICTURE_READY && !explanation_key_root(&look->explanation))
        explanation_key_make(&look->explanation, look->key);
}

void picture_look_run(struct lane_task *task)
{
    struct picture_look *look = picture_look_of(task);

    if (is_explanation(look)) {
        look_at_inputs(look);
        return;
    }
    look->status = picture_place_find(&look->place, &look->roots, look->subject, &look->error);
    if (look->status == PICTURE_READY) picture_place_make_key(&look->place, &look->query, look->key);
}
