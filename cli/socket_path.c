#include "cli/socket_path.h"

#include "core/alloc.h"

#include <stdbool.h>
#include <unistd.h>

static bool is_given(const char *text)
{
    return text && *text;
}

char *socket_path_choose(const struct socket_path_params *params)
{
    if (is_given(params->option)) return xstrdup(params->option);
    if (is_given(params->environment)) return xstrdup(params->environment);
    if (is_given(params->system_path) && access(params->system_path, F_OK) == 0) return xstrdup(params->system_path);
    if (is_given(params->runtime_folder)) return xasprintf("%s/marchd.sock", params->runtime_folder);
    return xstrdup(is_given(params->system_path) ? params->system_path : SOCKET_PATH_SYSTEM);
}
