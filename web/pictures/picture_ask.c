// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_ask.h"

#include "web/pictures/picture_look.h"

#include <stddef.h>
#include <stdlib.h>

struct picture_ask *picture_ask_of(struct picture_waiter *waiter)
{
    return (struct picture_ask *)((char *)waiter - offsetof(struct picture_ask, waiter));
}

void picture_ask_free(struct picture_ask *ask)
{
    free(ask->known);
    picture_look_free(ask->look);
    picture_file_close(&ask->file);
    free(ask);
}

void picture_ask_list_init(struct picture_ask_list *list)
{
    list->first = NULL;
    list->end = &list->first;
}

void picture_ask_list_add(struct picture_ask_list *list, struct picture_ask *ask)
{
    ask->next = NULL;
    *list->end = ask;
    list->end = &ask->next;
}

struct picture_ask *picture_ask_list_take(struct picture_ask_list *list)
{
    struct picture_ask *ask = list->first;

    if (!ask) return NULL;
    list->first = ask->next;
    if (!list->first) list->end = &list->first;
    return ask;
}

void picture_ask_list_remove(struct picture_ask_list *list, struct picture_ask *ask)
{
    struct picture_ask **link = &list->first;

    while (*link && *link != ask)
        link = &(*link)->next;
    if (!*link) return;
    *link = ask->next;
    if (!*link) list->end = link;
}
