// The rules of each kind of density in a job: its name, how it is read, its values. One file density_KIND.c each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/density.h"

#include <stdbool.h>
#include <stdio.h>

struct scene_reader;

// A new kind is a file with one of these, called density_rules_KIND, and a row in density_rules.c's table.
struct density_rules {
    const char *name; // in the job
    bool is_even;     // rho is constant within bounds that have no falloff
    // `reader` stands at the density, of which only the kind is set. On failure the caller still calls scene_finish.
    bool (*read)(struct scene_density *density, const struct scene_reader *reader);
    void (*visit)(struct scene_density *density, timeline_visitor *visit,
                  void *user); // its timelines, always in one order
    // Writes the values that are no timelines, for the job's hash (hash_text.h). NULL: there are none.
    void (*write_hash_text)(const struct scene_density *density, FILE *text);
    void (*finish)(struct scene_density *density);            // frees all but timelines; NULL: there is nothing to free
    bool (*is_sequence)(const struct scene_density *density); // as scene_density_is_sequence; NULL: never
    // An upper bound, within `span`, of a straight line through the density without its bounds, m. NULL: unbounded.
    double (*find_diameter)(const struct scene_density *density, struct timeline_span span);
};

extern const struct density_rules density_rules_fold_fractal, density_rules_homogeneous, density_rules_noise,
    density_rules_grid, density_rules_glsl;

const struct density_rules *density_rules_of(const struct scene_density *density);

enum { DENSITY_RULES_LIMIT = 16 };
// The names of all kinds in the order of enum scene_density_kind, then NULL.
void density_rules_list(const char *names[static DENSITY_RULES_LIMIT]);
