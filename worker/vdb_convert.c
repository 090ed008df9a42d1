#include "worker/vdb_convert.h"

#include "core/alloc.h"
#include "core/error.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char program[] = "nanovdb_convert";

static char *make_temporary(struct error *error)
{
    const char *folder = getenv("TMPDIR");
    char *path = xasprintf("%s/marchd-XXXXXX.nvdb", folder && *folder ? folder : "/tmp");
    int fd = mkostemps(path, (int)strlen(".nvdb"), O_CLOEXEC);

    if (fd >= 0) {
        close(fd);
        return path;
    }
    error_set_errno(error, errno, "cannot make %s", path);
    free(path);
    return NULL;
}

// Its chatter goes nowhere: what counts is whether it succeeds.
static bool run(char *const arguments[], struct error *error)
{
    posix_spawn_file_actions_t actions;
    int status = 0, fault;
    pid_t child;

    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    fault = posix_spawnp(&child, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (fault == ENOENT) {
        error_set(error,
                  "a .vdb file is read through %s, which is not installed: install libnanovdb-tools, or convert "
                  "the file with `%s -z` elsewhere",
                  program, program);
        return false;
    }
    if (fault != 0) {
        error_set_errno(error, fault, "cannot run %s", program);
        return false;
    }
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) {
            error_set_errno(error, errno, "cannot wait for %s", program);
            return false;
        }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
    if (WIFSIGNALED(status))
        error_set(error, "%s was ended by signal %d", program, WTERMSIG(status));
    else
        error_set(error, "%s failed with exit status %d: is it an OpenVDB file?", program, WEXITSTATUS(status));
    return false;
}

bool vdb_convert(const char *path, char **nvdb_path, struct error *error)
{
    // A relative name that begins with a dash would be taken for an option.
    char *source = xasprintf("%s%s", path[0] == '/' ? "" : "./", path);
    bool ok;

    *nvdb_path = make_temporary(error);
    if (!*nvdb_path) {
        free(source);
        return false;
    }
    {
        char name[] = "nanovdb_convert", overwrite[] = "-f";

        ok = run((char *[]){name, overwrite, source, *nvdb_path, NULL}, error);
    }
    free(source);
    if (ok) return true;
    (void)unlink(*nvdb_path);
    free(*nvdb_path);
    *nvdb_path = NULL;
    return false;
}
