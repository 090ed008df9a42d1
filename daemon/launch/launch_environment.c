// SPDX-License-Identifier: Apache-2.0
#include "daemon/launch/launch_environment.h"

#include "core/base/alloc.h"

#include <stddef.h>
#include <string.h>
#include <unistd.h>

// Nothing else is passed on. srun gives what it has to the nodes, where TMPDIR and LD_LIBRARY_PATH may name nothing.
static const char *const kept_names[] = {
    "PATH=",          "HOME=",       "USER=",       "LOGNAME=",      "LANG=",         "LC_",           "TZ=",
    "SSH_AUTH_SOCK=", "SLURM_CONF=", "KRB5CCNAME=", "ASAN_OPTIONS=", "LSAN_OPTIONS=", "UBSAN_OPTIONS="};

char **launch_environment_make(void)
{
    size_t count = 0, kept = 0;
    char **environment;

    while (environ[count])
        count++;
    environment = xcalloc(count + 1, sizeof environment[0]);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < sizeof kept_names / sizeof kept_names[0]; k++)
            if (strncmp(environ[i], kept_names[k], strlen(kept_names[k])) == 0) environment[kept++] = environ[i];
    return environment;
}
