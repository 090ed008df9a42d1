// Finds the family and the point of a quality that a plan chose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan_family.h"

#include <stdbool.h>
#include <stddef.h>

// Of several, the first: settings that are equal are refined in the same way, whoever chose them. False when no family
// that serves the scene has such a point.
bool plan_lookup(const struct plan_scene *scene, const struct job_quality *quality, size_t *family,
                 struct plan_point *point);
