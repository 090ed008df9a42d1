// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/config_check.h"

#include "daemon/settings/options.h"

#include <errno.h>
#include <grp.h>
#include <string.h>
#include <unistd.h>

static void check(FILE *out, const char *what, const char *path, int mode, const char *effect)
{
    if (path && access(path, mode) != 0)
        fprintf(out, "marchd: warning: %s %s: %s: %s\n", what, path, strerrordesc_np(errno), effect);
}

void config_check_print(const struct options *options, FILE *out)
{
    const struct path_list *roots = &options->output_roots, *inputs = &options->input_roots;

    for (size_t i = 0; i < roots->count; i++)
        check(out, "output root", roots->paths[i], F_OK,
              i == 0 ? "the first start of a farm makes it; later, jobs that write there wait until it is there"
                     : "jobs that write there wait until it is there");
    for (size_t i = 0; i < inputs->count; i++)
        check(out, "input root", inputs->paths[i], F_OK, "jobs that read files below it are refused");
    check(out, "worker program", options->worker_program, X_OK, "no worker can start");
    check(out, "shader folder", options->shader_folder, F_OK, "no worker can start");
    if (strcmp(options->admin_group, OPTIONS_ADMIN_GROUP) != 0 && !getgrnam(options->admin_group))
        fprintf(out, "marchd: warning: admin group %s: there is no such group, and so none of its members\n",
                options->admin_group);
}
