// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox.h"

#include "core/base/error.h"
#include "worker/sandbox/fence.h"
#include "worker/sandbox/sandbox_folders.h"
#include "worker/sandbox/sandbox_landlock.h"
#include "worker/sandbox/sandbox_scratch.h"
#include "worker/sandbox/sandbox_seccomp.h"
#include "worker/sandbox/sandbox_system.h"
#include "worker/sandbox/sanitizer.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

void sandbox_limit(int64_t memory_bytes)
{
    const struct rlimit no_core = {0, 0};
    int fd = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);

    (void)setrlimit(RLIMIT_CORE, &no_core);
    // The limit counts a sanitizer's shadow memory, which is some terabytes.
    if (memory_bytes > 0 && !IS_SANITIZED) {
        const struct rlimit memory = {(rlim_t)memory_bytes, (rlim_t)memory_bytes};

        (void)setrlimit(RLIMIT_DATA, &memory);
    }
    if (fd < 0) return;
    (void)!write(fd, "500", 3);
    close(fd);
}

void sandbox_close_files(int channel_fd)
{
    if (channel_fd > STDERR_FILENO + 1) (void)close_range(STDERR_FILENO + 1, (unsigned)channel_fd - 1, 0);
    (void)close_range((unsigned)channel_fd + 1, ~0U, 0);
}

// Workers of a daemon that root runs keep root's access to files and lose all other capabilities.
static bool drop_capabilities(struct error *error)
{
    struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
    struct __user_cap_data_struct held[2], kept[2];
    const uint32_t wanted = 1U << CAP_DAC_OVERRIDE | 1U << CAP_DAC_READ_SEARCH;

    if (syscall(SYS_capget, &header, held) < 0) goto fail;
    memset(kept, 0, sizeof kept);
    kept[0].permitted = held[0].permitted & wanted;
    kept[0].effective = held[0].effective & wanted;
    for (int capability = 0; capability < 64; capability++)
        if (prctl(PR_CAPBSET_DROP, capability, 0, 0, 0) < 0)
            break; // no capability is left, or the process is not root's
    if (syscall(SYS_capset, &header, kept) == 0) return true;
fail:
    error_set_errno(error, errno, "cannot drop capabilities");
    return false;
}

static bool give_up_privileges(struct error *error)
{
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) < 0) {
        error_set_errno(error, errno, "no_new_privs");
        return false;
    }
    return drop_capabilities(error);
}

static bool allow_inputs(const struct sandbox_landlock *landlock, const struct fence *fence,
                         const struct fence_job *job, size_t *files_left, struct error *error)
{
    for (size_t i = 0; i < job->input_count; i++)
        if (!sandbox_folders_allow_input(landlock, fence, &job->inputs[i], files_left, error)) return false;
    return true;
}

// What cannot be opened stays closed: a worker of its own tells what is wrong with the job.
static void allow_other(const struct sandbox_landlock *landlock, const struct fence *fence,
                        const struct fence_job *other, size_t *files_left)
{
    if (allow_inputs(landlock, fence, other, files_left, NULL))
        (void)sandbox_folders_allow_output(landlock, fence, other, NULL, NULL);
}

static bool allow_job(const struct sandbox_landlock *landlock, const struct sandbox_job *job, enum sandbox_fault *fault,
                      struct error *error)
{
    const struct fence *fence = job->fence;
    size_t files_left = SANDBOX_FILE_LIMIT;
    bool is_root_away;

    *fault = SANDBOX_FAULT_JOB;
    if (!allow_inputs(landlock, fence, &fence->job, &files_left, error)) return false;
    if (!sandbox_folders_allow_output(landlock, fence, &fence->job, &is_root_away, error)) {
        *fault = is_root_away ? SANDBOX_FAULT_ROOT : SANDBOX_FAULT_OUTPUT;
        return false;
    }
    for (size_t i = 0; i < fence->other_count; i++)
        allow_other(landlock, fence, &fence->others[i], &files_left);
    *fault = SANDBOX_FAULT_WORKER;
    return sandbox_system_allow(landlock, job->shader_folder, error);
}

static bool allow_converter(const struct sandbox_landlock *landlock, struct error *error)
{
    int fd = sandbox_scratch_make(error); // stays open until the process ends

    return fd >= 0 && sandbox_landlock_allow(landlock, fd, SANDBOX_READ | SANDBOX_WRITE, error) &&
           sandbox_system_allow_converter(landlock, error);
}

bool sandbox_enter_job(const struct sandbox_job *job, char holds[static SANDBOX_TEXT_SIZE], enum sandbox_fault *fault,
                       struct error *error)
{
    const struct sandbox_calls calls = {.has_programs = job->fence->has_converter};
    struct sandbox_landlock landlock;
    bool ok = false;

    *fault = SANDBOX_FAULT_WORKER;
    if (!sandbox_landlock_open(&landlock, error)) return false;
    sandbox_scratch_sweep();
    if (!allow_job(&landlock, job, fault, error)) goto out;
    if (job->fence->has_converter && !allow_converter(&landlock, error)) goto out;
    ok =
        give_up_privileges(error) && sandbox_landlock_enforce(&landlock, error) && sandbox_seccomp_enter(&calls, error);
    if (landlock.abi)
        snprintf(holds, SANDBOX_TEXT_SIZE, "landlock %d, seccomp", landlock.abi);
    else
        snprintf(holds, SANDBOX_TEXT_SIZE, "seccomp, %s", landlock.lack);
out:
    sandbox_landlock_close(&landlock);
    return ok;
}

bool sandbox_enter(char holds[static SANDBOX_TEXT_SIZE], struct error *error)
{
    const struct sandbox_calls calls = {.has_programs = true, .has_all_threads = true};

    if (!sandbox_seccomp_enter(&calls, error)) return false;
    snprintf(holds, SANDBOX_TEXT_SIZE, "seccomp");
    return true;
}
