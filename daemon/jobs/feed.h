// Assigns frames to the workers that can take some.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;

void feed_workers(struct farm *farm);
