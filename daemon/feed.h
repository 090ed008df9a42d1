// Gives frames to the workers that have their hands free.
#pragma once

struct farm;

void feed_workers(struct farm *farm);
