// Draining the farm: what runs is finished and nothing new is begun, as before an upgrade. A restart ends it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;

// `user` names the client, in the log and in the reasons of jobs. Both do nothing to a farm that is so already.
void drain_begin(struct farm *farm, const char *user);
void drain_end(struct farm *farm, const char *user);
