// The thread that turns rendered pictures into files: encodes, syncs, gates and reports each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct worker;

// The thread's function; `user` is the worker. Ends once the renderer has ended and no picture waits.
void *encoder_run(void *user);
