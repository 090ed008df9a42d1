// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/notice_list.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

void notice_list_finish(struct notice_list *list)
{
    free(list->entries);
    *list = (struct notice_list){0};
}

static size_t count_of(const struct notice_list *list, int64_t owner_uid)
{
    size_t count = 0;

    for (size_t i = 0; i < list->count; i++)
        count += list->entries[i].owner_uid == owner_uid;
    return count;
}

static int compare_owners(const void *a, const void *b)
{
    int64_t first = *(const int64_t *)a, second = *(const int64_t *)b;

    return (first > second) - (first < second);
}

static int64_t find_largest_owner(const struct notice_list *list)
{
    int64_t *owners = xmalloc(list->count * sizeof *owners), largest = 0;
    size_t most = 0, run = 0;

    for (size_t i = 0; i < list->count; i++)
        owners[i] = list->entries[i].owner_uid;
    qsort(owners, list->count, sizeof *owners, compare_owners);
    for (size_t i = 0; i < list->count; i++) {
        run = i > 0 && owners[i] == owners[i - 1] ? run + 1 : 1;
        if (run <= most) continue;
        most = run;
        largest = owners[i];
    }
    free(owners);
    return largest;
}

static void remove_at(struct notice_list *list, size_t index)
{
    list->count--;
    memmove(&list->entries[index], &list->entries[index + 1], (list->count - index) * sizeof list->entries[0]);
}

static int64_t drop_oldest_of(struct notice_list *list, int64_t owner_uid)
{
    size_t i = 0;
    int64_t id;

    while (list->entries[i].owner_uid != owner_uid)
        i++;
    id = list->entries[i].id;
    remove_at(list, i);
    list->dropped++;
    return id;
}

void notice_list_add(struct notice_list *list, int64_t id, int64_t owner_uid, int64_t *dropped)
{
    *dropped = 0;
    list->entries = xgrow(list->entries, &list->capacity, list->count + 1, sizeof list->entries[0]);
    list->entries[list->count++] = (struct notice_entry){id, owner_uid};
    if (list->count > NOTICE_LIST_OWNER_LIMIT && count_of(list, owner_uid) > NOTICE_LIST_OWNER_LIMIT)
        *dropped = drop_oldest_of(list, owner_uid);
    else if (list->count > NOTICE_LIST_LIMIT)
        *dropped = drop_oldest_of(list, find_largest_owner(list));
}

bool notice_list_remove(struct notice_list *list, int64_t id)
{
    size_t low = 0, high = list->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;

        if (list->entries[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == list->count || list->entries[low].id != id) return false;
    remove_at(list, low);
    return true;
}
