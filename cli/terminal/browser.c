// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal/browser.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static bool write_file(const char *path, const char *address, struct error *error)
{
    int fd;
    FILE *file;
    bool ok;

    unlink(path); // whoever made it, with whatever mode
    fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    file = fd >= 0 ? fdopen(fd, "w") : NULL;
    if (!file) {
        error_set_errno(error, errno, "cannot write %s", path);
        return false;
    }
    fprintf(file,
            "<!doctype html><meta charset=\"utf-8\"><meta name=\"referrer\" content=\"no-referrer\">"
            "<meta http-equiv=\"refresh\" content=\"0; url=%s\"><title>marchd</title>"
            "<a href=\"%s\">marchd</a>\n",
            address, address);
    ok = !ferror(file);
    if (fclose(file) == 0 && ok) return true;
    error_set(error, "cannot write %s", path);
    return false;
}

static bool start(char *path, struct error *error)
{
    char name[] = "xdg-open";
    char *arguments[] = {name, path, NULL};
    posix_spawn_file_actions_t actions;
    pid_t pid;
    int failure;

    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    failure = posix_spawnp(&pid, name, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failure == 0) return true;
    error_set_errno(error, failure, "cannot start xdg-open");
    return false;
}

bool browser_open(const char *address, struct error *error)
{
    const char *folder = getenv("XDG_RUNTIME_DIR");
    char *path;
    bool ok;

    if (!folder || *folder != '/') {
        error_set(error, "XDG_RUNTIME_DIR is not set: there is no folder for what a browser reads");
        return false;
    }
    path = xasprintf("%s/march-web.html", folder);
    ok = write_file(path, address, error) && start(path, error);
    free(path);
    return ok;
}
