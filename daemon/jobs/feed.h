// Gives frames to the workers that have their hands free.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;

void feed_workers(struct farm *farm);
