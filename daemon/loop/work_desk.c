// SPDX-License-Identifier: Apache-2.0
#include "daemon/loop/work_desk.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <stdlib.h>

enum { RUNNING_LIMIT = 2 };

struct work_desk {
    uv_loop_t *loop;          // borrowed; outlives us
    struct work_piece *first; // list of those that wait, by round
    struct work_piece *begun; // list of those that run
    uint64_t round;           // of the piece that was begun last
    int running;
    bool is_stopped;
};

static void on_run(uv_work_t *work);
static void on_done(uv_work_t *work, int status);

struct work_desk *work_desk_create(uv_loop_t *loop)
{
    struct work_desk *desk = xcalloc(1, sizeof *desk);

    desk->loop = loop;
    return desk;
}

void work_desk_destroy(struct work_desk *desk)
{
    assert(!desk || work_desk_is_idle(desk));
    free(desk);
}

static void begin_some(struct work_desk *desk)
{
    while (desk->first && desk->running < RUNNING_LIMIT) {
        struct work_piece *piece = desk->first;

        desk->first = piece->next;
        desk->round = piece->round;
        desk->running++;
        piece->next = desk->begun;
        desk->begun = piece;
        uv_queue_work(desk->loop, &piece->work, on_run, on_done);
    }
}

static uint64_t round_after(const struct work_piece *list, int64_t uid, uint64_t round)
{
    for (; list; list = list->next)
        if (list->uid == uid && list->round >= round) round = list->round + 1;
    return round;
}

void work_desk_put(struct work_desk *desk, struct work_piece *piece)
{
    struct work_piece **link = &desk->first;

    if (desk->is_stopped) {
        piece->done(piece, false);
        return;
    }
    piece->desk = desk;
    piece->work.data = piece;
    piece->round = desk->round;
    if (!piece->goes_on)
        piece->round = round_after(desk->first, piece->uid, round_after(desk->begun, piece->uid, desk->round));
    while (*link && !piece->goes_on && (*link)->round <= piece->round)
        link = &(*link)->next;
    piece->next = *link;
    *link = piece;
    begin_some(desk);
}

static void on_run(uv_work_t *work)
{
    struct work_piece *piece = work->data;

    piece->run(piece);
}

static void on_done(uv_work_t *work, int status)
{
    struct work_piece *piece = work->data;
    struct work_desk *desk = piece->desk;
    struct work_piece **link = &desk->begun;

    while (*link != piece)
        link = &(*link)->next;
    *link = piece->next;
    desk->running--;
    begin_some(desk);
    piece->done(piece, true);
}

void work_desk_stop(struct work_desk *desk)
{
    desk->is_stopped = true;
    while (desk->first) {
        struct work_piece *piece = desk->first;

        desk->first = piece->next;
        piece->done(piece, false);
    }
}

bool work_desk_is_idle(const struct work_desk *desk)
{
    return desk->running == 0 && !desk->first;
}
