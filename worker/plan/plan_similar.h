// Which jobs' plans let walks from the nodes of a grid of scattered light go on through similar media.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct job;

// Returns quality.similar_after for plans of the job: 0 where similar media save walks no time, or where their error,
// which is less than 1 %, is not small beside the tolerance.
int plan_similar_after(const struct job *job);
