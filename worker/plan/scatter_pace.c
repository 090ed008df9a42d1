// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_pace.h"

#include "core/base/clock.h"
#include "worker/plan/scatter_search.h"

#include <math.h>
#include <time.h>

static int kind_of(const struct scatter_setting *setting)
{
    if (setting->grid_rung == SCATTER_PIXELS) return 2;
    return setting->is_from_lights ? 1 : 0;
}

static double count_paths(const struct scatter_setting *setting, double pixels)
{
    double nodes = setting->grid_rung == SCATTER_PIXELS ? pixels : pow(scatter_grid_cells[setting->grid_rung], 3.0);

    return nodes * scatter_paths_of(setting->path_rung);
}

struct scatter_pace scatter_pace_begin(void)
{
    return (struct scatter_pace){.processor_s = clock_read_s(CLOCK_PROCESS_CPUTIME_ID),
                                 .wall_s = clock_read_s(CLOCK_MONOTONIC)};
}

void scatter_pace_note(struct scatter_pace paces[static SCATTER_PACE_KINDS], const struct scatter_setting *setting,
                       double pixels, const struct scatter_pace *began)
{
    struct scatter_pace *pace = &paces[kind_of(setting)], now = scatter_pace_begin();
    double paths = count_paths(setting, pixels);

    if (paths < pace->paths) return;
    *pace = (struct scatter_pace){
        .paths = paths, .processor_s = now.processor_s - began->processor_s, .wall_s = now.wall_s - began->wall_s};
}

struct scatter_pace scatter_pace_foretell(const struct scatter_pace paces[static SCATTER_PACE_KINDS],
                                          const struct scatter_setting *setting, double pixels)
{
    const struct scatter_pace *pace = &paces[kind_of(setting)];
    double paths = count_paths(setting, pixels), share = pace->paths > 0.0 ? paths / pace->paths : 0.0;

    if (!(share > 0.0)) return (struct scatter_pace){0};
    return (struct scatter_pace){
        .paths = paths, .processor_s = share * pace->processor_s, .wall_s = share * pace->wall_s};
}
