// The thread that owns the GL context: renders frames as they are assigned and answers requests between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The thread's function; `user` is the worker. It first reports whether there is a context.
void *render_loop_run(void *user);
