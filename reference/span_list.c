#include "reference/span_list.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

void span_list_append(struct span_list *list, double begin, double end, const struct ray *image)
{
    static const struct ray NO_IMAGE;

    if (!(begin < end)) return;
    if (list->count == SPAN_LIMIT) {
        list->spans[SPAN_LIMIT - 1].end = end;
        return;
    }
    list->spans[list->count++] = (struct span){begin, end, image ? *image : NO_IMAGE};
}

void span_list_split(struct span_list *list, double cut)
{
    size_t at = 0;

    while (at < list->count && !(list->spans[at].begin < cut && cut < list->spans[at].end))
        at++;
    if (at == list->count || list->count == SPAN_LIMIT) return;
    memmove(&list->spans[at + 1], &list->spans[at], (list->count - at) * sizeof list->spans[0]);
    list->spans[at].end = cut;
    list->spans[at + 1].begin = cut;
    list->count++;
}

static int compare_distances(const void *a, const void *b)
{
    double first = *(const double *)a, second = *(const double *)b;

    return (first > second) - (first < second);
}

static bool covers(const struct span_list *list, double distance)
{
    for (size_t i = 0; i < list->count; i++) {
        if (list->spans[i].begin <= distance && distance <= list->spans[i].end) return true;
    }
    return false;
}

void span_list_merge(struct span_list *list, const struct span_list *other)
{
    double ends[4 * SPAN_LIMIT];
    size_t end_count = 0;
    struct span_list merged = {0};

    for (size_t i = 0; i < list->count; i++) {
        ends[end_count++] = list->spans[i].begin;
        ends[end_count++] = list->spans[i].end;
    }
    for (size_t i = 0; i < other->count; i++) {
        ends[end_count++] = other->spans[i].begin;
        ends[end_count++] = other->spans[i].end;
    }
    qsort(ends, end_count, sizeof ends[0], compare_distances);
    for (size_t i = 1; i < end_count; i++) {
        double middle = 0.5 * (ends[i - 1] + ends[i]);

        if (covers(list, middle) || covers(other, middle)) span_list_append(&merged, ends[i - 1], ends[i], NULL);
    }
    *list = merged;
}
