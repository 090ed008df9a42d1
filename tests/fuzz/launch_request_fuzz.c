// What a daemon that was taken over sends to march-launch: words of a command that the pool has, or refused.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/launch/launch_request.h"
#include "daemon/settings/pool_command.h"
#include "daemon/settings/pool_options.h"

#include "core/base/error.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void require(bool condition)
{
    if (!condition) abort();
}

static void send_with_pipes(int to, const uint8_t *bytes, size_t size, const int fds[static 3])
{
    union {
        char bytes[CMSG_SPACE(3 * sizeof(int))];
        struct cmsghdr align;
    } control = {.bytes = {0}};
    struct iovec part = {.iov_base = (void *)bytes, .iov_len = size};
    struct msghdr message = {
        .msg_iov = &part, .msg_iovlen = 1, .msg_control = control.bytes, .msg_controllen = sizeof control.bytes};
    struct cmsghdr *header = CMSG_FIRSTHDR(&message);

    *header =
        (struct cmsghdr){.cmsg_level = SOL_SOCKET, .cmsg_type = SCM_RIGHTS, .cmsg_len = CMSG_LEN(3 * sizeof(int))};
    memcpy(CMSG_DATA(header), fds, 3 * sizeof(int));
    require(sendmsg(to, &message, 0) == (ssize_t)size);
}

// The pools that are asked, by what stands first.
static void check_commands(const char *const words[])
{
    static const char *const settings[] = {"p nodes=anna,ben command='run {node}'",
                                           "p launcher=slurm max=2 workers=1 program=/usr/bin/march-worker"};

    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        struct pool_options pool;
        struct error error = {0};
        char **command;

        require(pool_options_read(&pool, settings[i], NULL));
        command = pool_command_make(&pool, words, &error);
        require(command ? command[0] && command[0][0] : error.message[0] != '\0');
        // The program is the settings', whatever was asked.
        if (command && i == 0) require(strcmp(command[0], "run") == 0);
        if (command && i == 1)
            require(strcmp(command[0], "srun") == 0 || strcmp(command[0], "squeue") == 0 ||
                    strcmp(command[0], "sbatch") == 0 || strcmp(command[0], "scancel") == 0);
        pool_options_free_command(command);
        pool_options_finish(&pool);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct launch_request request;
    struct error error = {0};
    int sockets[2], pipe_fds[2];

    if (size == 0 || size > 2 * LAUNCH_REQUEST_SIZE) return 0;
    require(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, sockets) == 0 && pipe(pipe_fds) == 0);
    send_with_pipes(sockets[0], bytes, size, (const int[]){pipe_fds[0], pipe_fds[1], pipe_fds[1]});
    if (launch_request_receive(&request, sockets[1], &error)) {
        check_commands(request.words);
        launch_request_finish(&request);
    } else {
        require(error.message[0] != '\0');
    }
    close(sockets[0]);
    close(sockets[1]);
    close(pipe_fds[0]);
    close(pipe_fds[1]);
    return 0;
}
