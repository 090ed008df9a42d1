// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"

enum exit_status command_pause(const struct options *options, struct error *error)
{
    return daemon_call_each_job(options, "job.pause", &(struct job_selection_params){"pause", "queued,running"}, error);
}
