// The environment a worker is started with: the daemon's own and how many threads llvmpipe may use.
#pragma once

char **worker_environment_create(int thread_count); // ends in NULL
void worker_environment_destroy(char **environment);
