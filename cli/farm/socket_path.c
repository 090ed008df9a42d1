// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/socket_path.h"

#include "core/base/alloc.h"

#include <stdbool.h>
#include <stdlib.h>

static bool is_given(const char *text)
{
    return text && *text;
}

static void add(struct socket_path_list *list, char *path)
{
    if (path) list->paths[list->count++] = path;
}

static char *own_path(const struct socket_path_params *params)
{
    if (is_given(params->runtime_folder)) return xasprintf("%s/marchd.sock", params->runtime_folder);
    if (is_given(params->state_home)) return xasprintf("%s/marchd/marchd.sock", params->state_home);
    if (is_given(params->home)) return xasprintf("%s/.local/state/marchd/marchd.sock", params->home);
    return NULL;
}

void socket_path_choose(struct socket_path_list *list, const struct socket_path_params *params)
{
    const char *named = is_given(params->option) ? params->option : params->environment;

    *list = (struct socket_path_list){.count = 0};
    if (is_given(named)) {
        add(list, xstrdup(named));
        return;
    }
    add(list, xstrdup(params->system_path));
    add(list, own_path(params));
}

void socket_path_finish(struct socket_path_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->paths[i]);
    *list = (struct socket_path_list){.count = 0};
}
