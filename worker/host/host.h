// march-worker --node: the workers of this machine for a daemon elsewhere, which speaks on the standard streams.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Serves until the daemon ends the stream, is silent for too long, or the process is told to stop; its workers end
// with it. Returns the exit status. `version` is the program's, as the daemon must have it; `worker` is the program of
// the workers, NULL: this one.
int host_run(const char *version, const char *worker);
