// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"

enum exit_status command_cancel(const struct options *options, struct error *error)
{
    return daemon_call_each_job(options, "job.cancel",
                                &(struct job_selection_params){"cancel", "queued,running,paused"}, error);
}
