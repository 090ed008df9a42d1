// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/base/version.h"
#include "web/http/http_walls.h"
#include "web/program/web.h"
#include "web/program/web_check.h"
#include "web/settings/web_help.h"
#include "web/settings/web_options.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { EXIT_USAGE = 2 };

static void print_mistake(void *user, const char *mistake)
{
    (void)user;
    fprintf(stderr, "march-web: %s\n", mistake);
}

static int check_config(const struct web_options *options)
{
    struct http_origins origins = {0};
    struct error error = {0};
    bool is_right = web_check_options(options, &origins, &error);

    if (!is_right)
        print_mistake(NULL, error.message);
    else if (options->config_file)
        printf("%s: every setting is right\n", options->config_file);
    else
        printf("there is no file of settings: the defaults hold\n");
    http_origins_finish(&origins);
    return is_right ? EXIT_SUCCESS : EXIT_USAGE;
}

static int run(const struct web_options *options)
{
    struct http_origins origins = {0};
    struct error error = {0};
    bool is_right = web_check_options(options, &origins, &error);

    http_origins_finish(&origins);
    log_set_level(options->log_level);
    if (is_right && web_run(options, &error)) return EXIT_SUCCESS;
    log_error("%s", error.message);
    return is_right ? EXIT_FAILURE : EXIT_USAGE;
}

// The folder of this program, without its end; "/usr/bin" where the kernel does not tell.
static void find_program_folder(char folder[static PATH_MAX])
{
    ssize_t length = readlink("/proc/self/exe", folder, PATH_MAX - 1);
    char *slash;

    folder[length > 0 ? length : 0] = '\0';
    slash = strrchr(folder, '/');
    if (slash)
        *slash = '\0';
    else
        snprintf(folder, PATH_MAX, "/usr/bin");
}

// The page of this very build or installation, "../share" as seen from the program; else the installed one.
static const char *find_data_folder(const char *program_folder, char folder[static PATH_MAX])
{
    char page[PATH_MAX + 32];

    snprintf(folder, PATH_MAX, "%.4000s/../share", program_folder);
    snprintf(page, sizeof page, "%s/marchd/page", folder);
    return access(page, F_OK) == 0 ? folder : MARCHD_DATA_DIR;
}

int main(int argc, char **argv)
{
    char folder[PATH_MAX], program_folder[PATH_MAX], data_folder[PATH_MAX];
    struct web_surroundings surroundings = {.home = getenv("HOME"),
                                            .xdg_config_home = getenv("XDG_CONFIG_HOME"),
                                            .xdg_runtime_dir = getenv("XDG_RUNTIME_DIR"),
                                            .xdg_state_home = getenv("XDG_STATE_HOME"),
                                            .marchd_socket = getenv("MARCHD_SOCKET"),
                                            .config_path = "/etc/marchd/march-web.conf",
                                            .current_folder = getcwd(folder, sizeof folder) ? folder : "/",
                                            .program_folder = program_folder,
                                            .xdg_cache_home = getenv("XDG_CACHE_HOME"),
                                            .cache_directory = getenv("CACHE_DIRECTORY"),
                                            .is_root = geteuid() == 0};
    struct web_options options;
    int status = EXIT_SUCCESS;

    find_program_folder(program_folder);
    surroundings.data_folder = find_data_folder(program_folder, data_folder);
    if (!web_options_read(&options, argc, argv, &surroundings, print_mistake, NULL)) return EXIT_USAGE;
    if (options.wants_help)
        fputs(web_help, stdout);
    else if (options.wants_version)
        version_print(stdout, "march-web");
    else if (options.wants_check)
        status = check_config(&options);
    else
        status = run(&options);
    web_options_finish(&options);
    return status;
}
