// What the program's exit code says to scripts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum exit_status {
    EXIT_STATUS_DONE = 0,
    EXIT_STATUS_FAILED = 1, // a frame failed or missed its tolerance, a job was canceled, the daemon could not do it
    EXIT_STATUS_USAGE = 2,  // wrong arguments or a wrong job file
    EXIT_STATUS_NO_DAEMON = 3,
    EXIT_STATUS_NOT_ALLOWED = 4,
    EXIT_STATUS_INTERRUPTED = 130 // as shells report SIGINT
};
