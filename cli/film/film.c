// SPDX-License-Identifier: Apache-2.0
#include "cli/film/film.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// Returns 0 and the program's exit status, or the errno value why it could not be started.
static int run(char *const arguments[], int *exit_status)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, defaults;
    int failure, wait_status = 0;
    pid_t pid;

    sigemptyset(&none);
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
    failure = posix_spawnp(&pid, arguments[0], &actions, &attributes, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (failure) return failure;
    while (waitpid(pid, &wait_status, 0) < 0 && errno == EINTR)
        ;
    *exit_status = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
    return 0;
}

bool film_has_ffmpeg(struct error *error)
{
    const char *folders = getenv("PATH");

    for (const char *folder = folders ? folders : "/usr/bin"; *folder;) {
        size_t length = strcspn(folder, ":");
        char *path = xasprintf("%.*s/ffmpeg", (int)length, folder);
        bool found = access(path, X_OK) == 0;

        free(path);
        if (found) return true;
        folder += length + (folder[length] == ':');
    }
    error_set(error, "a film needs ffmpeg, which is not installed (apt install ffmpeg); a contact sheet needs none: "
                     "--out NAME.png");
    return false;
}

bool film_encode(const char *folder, const char *rate, const char *out, struct error *error)
{
    char *in = xasprintf("%s/%%06d.png", folder);
    char *part = xasprintf("%s.%ld.part", out, (long)getpid());
    // H.264 with 4:2:0 chroma needs even sides. The pictures are sRGB; a film that does not say its colours is shown in
    // other ones by each player.
    char *const arguments[] = {(char *)"ffmpeg",
                               (char *)"-y",
                               (char *)"-loglevel",
                               (char *)"error",
                               (char *)"-framerate",
                               (char *)rate,
                               (char *)"-i",
                               in,
                               (char *)"-vf",
                               (char *)"pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
                               (char *)"-pix_fmt",
                               (char *)"yuv420p",
                               (char *)"-color_range",
                               (char *)"tv",
                               (char *)"-colorspace",
                               (char *)"bt709",
                               (char *)"-color_primaries",
                               (char *)"bt709",
                               (char *)"-color_trc",
                               (char *)"iec61966-2-1",
                               (char *)"-movflags",
                               (char *)"+faststart",
                               (char *)"-f",
                               (char *)"mp4",
                               part,
                               NULL};
    int exit_status = 0, failure = run(arguments, &exit_status);
    bool ok = false;

    if (failure)
        error_set_errno(error, failure, "ffmpeg cannot be started");
    else if (exit_status != 0)
        error_set(error, "ffmpeg failed with exit status %d", exit_status);
    else if (rename(part, out) != 0)
        error_set_errno(error, errno, "%s", out);
    else
        ok = true;
    if (!ok) unlink(part);
    free(in);
    free(part);
    return ok;
}

char *film_create_folder(struct error *error)
{
    const char *parent = getenv("TMPDIR");
    char *folder = xasprintf("%s/march-film.XXXXXX", parent && *parent ? parent : "/tmp");

    if (mkdtemp(folder)) return folder;
    error_set_errno(error, errno, "%s", folder);
    free(folder);
    return NULL;
}

void film_remove_folder(const char *folder)
{
    DIR *directory = folder ? opendir(folder) : NULL;
    int fd = directory ? dirfd(directory) : -1;
    const struct dirent *entry;

    if (!directory) return;
    while ((entry = readdir(directory)))
        if (entry->d_name[0] != '.' && fd >= 0) unlinkat(fd, entry->d_name, 0);
    closedir(directory);
    rmdir(folder);
}
