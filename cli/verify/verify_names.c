// SPDX-License-Identifier: Apache-2.0
#include "cli/verify/verify_names.h"

#include "cli/verify/verify_list.h"
#include "core/base/alloc.h"
#include "core/job/frame_range.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// A number in a file's name; it may be the frame's.
struct number {
    char *stem; // owned; the name with # in place of the number, the same in all files of a sequence
    size_t file, start, length;
    int32_t value; // -1: the name has no number
    size_t peers;  // files with the same stem
};

struct numbers {
    struct number *list; // owned
    size_t count, capacity;
};

static void add_number(struct numbers *numbers, const struct verify_list *list, size_t file, size_t start,
                       size_t length)
{
    const char *name = list->files[file].name;
    struct number *number;

    numbers->list = xgrow(numbers->list, &numbers->capacity, numbers->count + 1, sizeof *numbers->list);
    number = &numbers->list[numbers->count++];
    *number = (struct number){.file = file, .start = start, .length = length, .value = -1};
    number->stem = length > 0 ? xasprintf("%.*s#%s", (int)start, name, name + start + length) : xstrdup(name);
    if (length > 0) number->value = (int32_t)strtol(name + start, NULL, 10);
}

// Adds the numbers of a name. If one of them is the frame in the header, only that one is added.
static void add_numbers(struct numbers *numbers, const struct verify_list *list, size_t file)
{
    const struct verify_file *named = &list->files[file];
    size_t first = numbers->count, said = 0;

    for (size_t start = 0; named->name[start];) {
        size_t length = strspn(named->name + start, "0123456789");

        if (length > 0 && length < 10 && strtol(named->name + start, NULL, 10) < FRAME_NUMBER_LIMIT)
            add_number(numbers, list, file, start, length);
        start += length > 0 ? length : 1;
    }
    for (size_t i = first; named->picture_hash[0] && i < numbers->count; i++)
        said += numbers->list[i].value == named->header_frame;
    for (size_t i = first; said > 0 && i < numbers->count;) {
        if (numbers->list[i].value == named->header_frame) {
            i++;
            continue;
        }
        free(numbers->list[i].stem);
        numbers->list[i] = numbers->list[--numbers->count];
    }
    if (numbers->count == first) add_number(numbers, list, file, 0, 0);
}

static int compare_stems(const void *left, const void *right)
{
    const struct number *a = left, *b = right;

    return strcmp(a->stem, b->stem);
}

static void count_peers(const struct numbers *numbers)
{
    qsort(numbers->list, numbers->count, sizeof *numbers->list, compare_stems);
    for (size_t first = 0, next; first < numbers->count; first = next) {
        for (next = first; next < numbers->count && !compare_stems(&numbers->list[first], &numbers->list[next]);)
            next++;
        for (size_t i = first; i < next; i++)
            numbers->list[i].peers = next - first;
    }
}

static bool is_better(const struct number *a, const struct number *b)
{
    return !b || a->peers > b->peers || (a->peers == b->peers && a->start > b->start);
}

static int compare_files(const void *left, const void *right)
{
    const struct verify_file *a = left, *b = right;

    if (a->sequence != b->sequence) return a->sequence < b->sequence ? -1 : 1;
    if (a->frame != b->frame) return a->frame < b->frame ? -1 : 1;
    return strcmp(a->name, b->name);
}

// `numbers` must be sorted by stem.
static size_t number_sequences(struct verify_list *list, const struct numbers *numbers,
                               const struct number *const best[])
{
    const char *stem = NULL;
    size_t count = 0;

    for (size_t i = 0; i < numbers->count; i++) {
        const struct number *number = &numbers->list[i];

        if (best[number->file] != number) continue;
        if (!stem || strcmp(stem, number->stem) != 0) count++;
        stem = number->stem;
        list->files[number->file].frame = number->value;
        list->files[number->file].sequence = count - 1;
        list->files[number->file].digits_start = number->start;
        list->files[number->file].digit_count = number->length;
    }
    return count;
}

size_t verify_names_sort(struct verify_list *list)
{
    struct numbers numbers = {0};
    const struct number **best = xcalloc(list->count + 1, sizeof(const struct number *));
    size_t sequence_count;

    for (size_t i = 0; i < list->count; i++)
        add_numbers(&numbers, list, i);
    if (numbers.count > 0) count_peers(&numbers);
    for (size_t i = 0; i < numbers.count; i++)
        if (is_better(&numbers.list[i], best[numbers.list[i].file])) best[numbers.list[i].file] = &numbers.list[i];
    sequence_count = number_sequences(list, &numbers, best);
    if (list->count > 0) qsort(list->files, list->count, sizeof *list->files, compare_files);
    for (size_t i = 0; i < numbers.count; i++)
        free(numbers.list[i].stem);
    free(numbers.list);
    free(best);
    return sequence_count;
}
