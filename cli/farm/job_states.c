// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/job_states.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"

#include <stdlib.h>
#include <string.h>

void job_states_write(struct json_writer *params, const char *states)
{
    if (!states) return;
    json_write_key(params, "state");
    json_write_begin_array(params);
    while (*states) {
        size_t length = strcspn(states, ",");
        char *state = xstrndup(states, length);

        json_write_string(params, state);
        free(state);
        states += length;
        if (*states == ',') states++;
    }
    json_write_end_array(params);
}
