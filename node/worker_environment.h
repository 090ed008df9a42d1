// The environment of a worker: needed variables of the daemon, no disk cache of shaders, llvmpipe's threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

char **worker_environment_create(int thread_count); // ends in NULL
void worker_environment_destroy(char **environment);
