#include "daemon/worker_environment.h"

#include "core/alloc.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char threads_name[] = "LP_NUM_THREADS=";

char **worker_environment_create(int thread_count)
{
    size_t count = 0, kept = 0;
    char **environment;

    while (environ[count])
        count++;
    environment = xcalloc(count + 2, sizeof(char *));
    for (size_t i = 0; i < count; i++) {
        if (strncmp(environ[i], threads_name, sizeof threads_name - 1) != 0) environment[kept++] = xstrdup(environ[i]);
    }
    environment[kept] = xasprintf("%s%d", threads_name, thread_count);
    return environment;
}

void worker_environment_destroy(char **environment)
{
    for (size_t i = 0; environment[i]; i++)
        free(environment[i]);
    free(environment);
}
