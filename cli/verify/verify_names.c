// SPDX-License-Identifier: Apache-2.0
#include "cli/verify/verify_names.h"

#include "cli/verify/verify_list.h"
#include "core/base/alloc.h"
#include "core/job/frame_range.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// A number in a name, which may be its frame's.
struct place {
    char *rest; // owned; the name without it: what files of a sequence share
    size_t file, start, length;
    int32_t number;   // -1: the name has none
    size_t companies; // files with a number in the same place of the same rest
};

struct places {
    struct place *places; // owned
    size_t count, capacity;
};

static void add_place(struct places *places, const struct verify_list *list, size_t file, size_t start, size_t length)
{
    const char *name = list->files[file].name;
    struct place *place;

    places->places = xgrow(places->places, &places->capacity, places->count + 1, sizeof *places->places);
    place = &places->places[places->count++];
    *place = (struct place){.file = file, .start = start, .length = length, .number = -1};
    place->rest = length > 0 ? xasprintf("%.*s#%s", (int)start, name, name + start + length) : xstrdup(name);
    if (length > 0) place->number = (int32_t)strtol(name + start, NULL, 10);
}

// A header that says a number of the name leaves no doubt which it is.
static void add_places(struct places *places, const struct verify_list *list, size_t file)
{
    const struct verify_file *named = &list->files[file];
    size_t first = places->count, said = 0;

    for (size_t start = 0; named->name[start];) {
        size_t length = strspn(named->name + start, "0123456789");

        if (length > 0 && length < 10 && strtol(named->name + start, NULL, 10) < FRAME_NUMBER_LIMIT)
            add_place(places, list, file, start, length);
        start += length > 0 ? length : 1;
    }
    for (size_t i = first; named->picture_hash[0] && i < places->count; i++)
        said += places->places[i].number == named->header_frame;
    for (size_t i = first; said > 0 && i < places->count;) {
        if (places->places[i].number == named->header_frame) {
            i++;
            continue;
        }
        free(places->places[i].rest);
        places->places[i] = places->places[--places->count];
    }
    if (places->count == first) add_place(places, list, file, 0, 0);
}

static int compare_rests(const void *left, const void *right)
{
    const struct place *a = left, *b = right;

    return strcmp(a->rest, b->rest);
}

static void count_companies(const struct places *places)
{
    qsort(places->places, places->count, sizeof *places->places, compare_rests);
    for (size_t first = 0, next; first < places->count; first = next) {
        for (next = first; next < places->count && !compare_rests(&places->places[first], &places->places[next]);)
            next++;
        for (size_t i = first; i < next; i++)
            places->places[i].companies = next - first;
    }
}

static bool is_better(const struct place *a, const struct place *b)
{
    return !b || a->companies > b->companies || (a->companies == b->companies && a->start > b->start);
}

static int compare_files(const void *left, const void *right)
{
    const struct verify_file *a = left, *b = right;

    if (a->sequence != b->sequence) return a->sequence < b->sequence ? -1 : 1;
    if (a->frame != b->frame) return a->frame < b->frame ? -1 : 1;
    return strcmp(a->name, b->name);
}

// The places are sorted by what files of a sequence share.
static size_t number_sequences(struct verify_list *list, const struct places *places, const struct place *const best[])
{
    const char *rest = NULL;
    size_t count = 0;

    for (size_t i = 0; i < places->count; i++) {
        const struct place *place = &places->places[i];

        if (best[place->file] != place) continue;
        if (!rest || strcmp(rest, place->rest) != 0) count++;
        rest = place->rest;
        list->files[place->file].frame = place->number;
        list->files[place->file].sequence = count - 1;
        list->files[place->file].digits_start = place->start;
        list->files[place->file].digit_count = place->length;
    }
    return count;
}

size_t verify_names_sort(struct verify_list *list)
{
    struct places places = {0};
    const struct place **best = xcalloc(list->count + 1, sizeof(const struct place *));
    size_t sequence_count;

    for (size_t i = 0; i < list->count; i++)
        add_places(&places, list, i);
    if (places.count > 0) count_companies(&places);
    for (size_t i = 0; i < places.count; i++)
        if (is_better(&places.places[i], best[places.places[i].file])) best[places.places[i].file] = &places.places[i];
    sequence_count = number_sequences(list, &places, best);
    if (list->count > 0) qsort(list->files, list->count, sizeof *list->files, compare_files);
    for (size_t i = 0; i < places.count; i++)
        free(places.places[i].rest);
    free(places.places);
    free(best);
    return sequence_count;
}
