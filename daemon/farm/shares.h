// Each owner's share of the farm: weights and rules from the settings, and what was used, kept over a restart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct farm;
struct turns_owner;

// Takes rules and weights from the settings; called at the start, before jobs are restored, and after a reload.
void shares_refresh(struct farm *farm);
void shares_set_weight(struct farm *farm, int64_t uid, const char *name); // of an owner whose job is new
// Reads what owners used before the restart.
bool shares_restore(struct farm *farm, struct error *error);
// To be called several times a second: passes the time on, and stores once a minute what owners used.
void shares_tick(struct farm *farm);
// To be called when a result of a frame of the owner's is stored: what they used goes with it.
void shares_store_with_frame(struct farm *farm, struct turns_owner *owner);
void shares_store(struct farm *farm); // to be called when the daemon stops
