// march-launch's side of one connection: starts the command that is asked for, and tells how it ended.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Returns when the command has ended, or was ended because the other end is closed. Only our own user is served, and
// only commands of the pools in the file, as it is now. `socket` stays the caller's. The process has no other children.
void launch_serve(int socket, const char *config_path);
