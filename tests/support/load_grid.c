// SPDX-License-Identifier: Apache-2.0
#include "tests/support/load_grid.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/still.h"
#include "worker/audit/truth_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

void load_grid_inputs(struct still_inputs *inputs, const struct job *job, int32_t frame)
{
    struct truth_files files = {0};
    struct error error = {{0}};
    struct job of_grids = *job;

    of_grids.scene.object_count = 0;
    if (!truth_files_load(&files, &of_grids, frame, &error)) fail_msg("%s", error.message);
    *inputs = files.inputs;
    for (size_t m = 0; m < SCENE_MEDIUM_LIMIT; m++)
        free(files.media[m].path);
}

void load_grid_finish(struct still_inputs *inputs)
{
    for (size_t m = 0; m < SCENE_MEDIUM_LIMIT; m++) {
        free((void *)(uintptr_t)inputs->grids[m].values);
        free((void *)(uintptr_t)inputs->temperatures[m].values);
    }
    *inputs = (struct still_inputs){0};
}
