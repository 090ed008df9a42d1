// SPDX-License-Identifier: Apache-2.0
#include "reference/span_list.h"

#include "core/base/alloc.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static void make_room(struct span_list *list)
{
    list->spans = xgrow(list->spans, &list->capacity, list->count + 1, sizeof list->spans[0]);
}

void span_list_append(struct span_list *list, double begin, double end, const struct ray *image)
{
    static const struct ray NO_IMAGE;

    if (!(begin < end)) return;
    make_room(list);
    list->spans[list->count++] = (struct span){begin, end, image ? *image : NO_IMAGE};
}

void span_list_split(struct span_list *list, double cut)
{
    size_t first = 0, last = list->count; // the first span that ends beyond the cut is between them

    while (first < last) {
        size_t middle = (first + last) / 2;

        if (list->spans[middle].end <= cut) {
            first = middle + 1;
        } else {
            last = middle;
        }
    }
    // Not "cut <= begin": NaN must not split anything.
    if (first == list->count || !(list->spans[first].begin < cut)) return;
    make_room(list);
    memmove(&list->spans[first + 1], &list->spans[first], (list->count - first) * sizeof list->spans[0]);
    list->spans[first].end = cut;
    list->spans[first + 1].begin = cut;
    list->count++;
}

// True for a stretch that rounding leaves: two lists may round the same end differently.
static bool is_sliver(double begin, double end)
{
    return end - begin < 1e-12 * fmax(fabs(begin), fabs(end));
}

void span_list_split_at_ends(struct span_list *list, const struct span_list *other)
{
    struct span_list pieces = {0};
    size_t at = 0;

    for (size_t i = 0; i < list->count; i++) {
        const struct span *span = &list->spans[i];
        double begin = span->begin;

        // An end of the other list may be a begin as well: both are visited, in order.
        while (at < 2 * other->count) {
            double cut = at % 2 ? other->spans[at / 2].end : other->spans[at / 2].begin;

            if (cut >= span->end) break;
            if (cut > begin && !is_sliver(begin, cut) && !is_sliver(cut, span->end)) {
                span_list_append(&pieces, begin, cut, &span->image);
                begin = cut;
            }
            at++;
        }
        span_list_append(&pieces, begin, span->end, &span->image);
    }
    span_list_finish(list);
    *list = pieces;
}

// Walks along a list's ends in ascending order.
struct walk {
    const struct span_list *list;
    size_t at;      // the span whose begin or end comes next
    bool is_inside; // of it
};

static double next_end(const struct walk *walk)
{
    if (walk->at == walk->list->count) return INFINITY;
    return walk->is_inside ? walk->list->spans[walk->at].end : walk->list->spans[walk->at].begin;
}

// Passes every end that is not beyond `distance`; two may coincide.
static void walk_to(struct walk *walk, double distance)
{
    while (walk->at < walk->list->count && next_end(walk) <= distance) {
        if (walk->is_inside) walk->at++;
        walk->is_inside = !walk->is_inside;
    }
}

void span_list_merge(struct span_list *list, const struct span_list *other)
{
    struct walk a = {.list = list}, b = {.list = other};
    struct span_list merged = {0};

    while (a.at < list->count || b.at < other->count) {
        double begin = fmin(next_end(&a), next_end(&b)), end;

        walk_to(&a, begin);
        walk_to(&b, begin);
        if (!a.is_inside && !b.is_inside) continue;
        end = fmin(next_end(&a), next_end(&b));
        if (is_sliver(begin, end)) continue;
        span_list_append(&merged, begin, end, NULL);
    }
    span_list_finish(list);
    *list = merged;
}

void span_list_finish(struct span_list *list)
{
    free(list->spans);
    *list = (struct span_list){0};
}
