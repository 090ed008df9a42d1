// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/shares.h"

#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"
#include "daemon/store/store_reader.h"

#include <math.h>

enum { STORE_EVERY_MS = 60 * 1000 };
static const double STORE_FROM_S = 0.1; // less is stored with a later frame

void shares_set_weight(struct farm *farm, int64_t uid, const char *name)
{
    turns_find_owner(queue_turns(farm->queue), uid)->weight =
        user_weights_find(&farm->options->user_weights, uid, name);
}

void shares_refresh(struct farm *farm)
{
    const struct options *options = farm->options;

    turns_set_rules(queue_turns(farm->queue), &(struct turns_rules){.half_life_s = (double)options->half_life_ms / 1000,
                                                                    .longest_wait_ms = options->longest_wait_ms});
    for (size_t i = 0; i < farm->quota.count; i++)
        shares_set_weight(farm, farm->quota.users[i]->uid, farm->quota.users[i]->name);
}

// What was used before `at_ms` has been forgotten in part since.
static bool on_usage(void *user, const struct store_usage *usage, struct error *error)
{
    struct farm *farm = user;
    double passed_s = fmax((double)(farm_clock_ms() - usage->at_ms) / 1000, 0);
    double half_life_s = (double)farm->options->half_life_ms / 1000;

    (void)error;
    if (usage->used_s > 0)
        turns_find_owner(queue_turns(farm->queue), usage->owner_uid)->used_s =
            usage->used_s * exp2(-passed_s / half_life_s);
    return true;
}

bool shares_restore(struct farm *farm, struct error *error)
{
    turns_advance(queue_turns(farm->queue), farm_now_ms(farm));
    return store_read_usage(farm->reader, on_usage, farm, error);
}

static void store_use(struct farm *farm, struct turns_owner *owner)
{
    owner->unstored_s = 0;
    farm_store(farm, (struct store_op){.kind = STORE_SET_USAGE, .usage = {owner->uid, owner->used_s, farm_clock_ms()}});
}

void shares_store_with_frame(struct farm *farm, struct turns_owner *owner)
{
    if (owner->unstored_s >= STORE_FROM_S) store_use(farm, owner);
}

void shares_store(struct farm *farm)
{
    struct turns_owner *owner;

    for (size_t i = 0; (owner = turns_owner_at(queue_turns(farm->queue), i)); i++)
        if (owner->unstored_s > 0) store_use(farm, owner);
}

void shares_tick(struct farm *farm)
{
    int64_t now_ms = farm_now_ms(farm);

    turns_advance(queue_turns(farm->queue), now_ms);
    if (now_ms - farm->shares_stored_ms < STORE_EVERY_MS) return;
    farm->shares_stored_ms = now_ms;
    shares_store(farm);
}
