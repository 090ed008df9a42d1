// SPDX-License-Identifier: Apache-2.0
#include "daemon/launch/launch_request.h"

#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FD_COUNT = 3 };

// Room for the descriptors of one message, aligned as the kernel wants it.
union control {
    char bytes[CMSG_SPACE(FD_COUNT * sizeof(int))];
    struct cmsghdr align;
};

// Each word ends in NUL. False: they are too long.
static bool add_word(char text[static LAUNCH_REQUEST_SIZE], size_t *length, const char *word)
{
    size_t size = strlen(word) + 1;

    if (*length + size > LAUNCH_REQUEST_SIZE) return false;
    memcpy(text + *length, word, size);
    *length += size;
    return true;
}

bool launch_request_send(int socket, const char *pool, const char *const words[], const int fds[static 3],
                         struct error *error)
{
    char text[LAUNCH_REQUEST_SIZE];
    size_t length = 0;
    bool fits = add_word(text, &length, pool);
    struct iovec part = {.iov_base = text};
    union control control = {.bytes = {0}};
    struct msghdr message = {
        .msg_iov = &part, .msg_iovlen = 1, .msg_control = control.bytes, .msg_controllen = sizeof control.bytes};
    struct cmsghdr *header = CMSG_FIRSTHDR(&message);

    for (size_t i = 0; fits && words[i]; i++)
        fits = add_word(text, &length, words[i]);
    if (!fits) {
        error_set(error, "expected at most %d bytes in all words", LAUNCH_REQUEST_SIZE);
        return false;
    }
    part.iov_len = length;
    *header = (struct cmsghdr){
        .cmsg_level = SOL_SOCKET, .cmsg_type = SCM_RIGHTS, .cmsg_len = CMSG_LEN(FD_COUNT * sizeof(int))};
    memcpy(CMSG_DATA(header), fds, FD_COUNT * sizeof(int));
    if (sendmsg(socket, &message, MSG_NOSIGNAL) == (ssize_t)length) return true;
    error_set_errno(error, errno, "sendmsg");
    return false;
}

// Takes the descriptors of all parts of the message, so that none is left open. False: they are not three.
static bool take_fds(struct msghdr *message, int fds[static FD_COUNT])
{
    size_t count = 0;

    for (struct cmsghdr *header = CMSG_FIRSTHDR(message); header; header = CMSG_NXTHDR(message, header)) {
        size_t here = (header->cmsg_len - CMSG_LEN(0)) / sizeof(int);

        if (header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS) continue;
        for (size_t i = 0; i < here; i++) {
            int fd;

            memcpy(&fd, CMSG_DATA(header) + i * sizeof fd, sizeof fd);
            if (count < FD_COUNT)
                fds[count] = fd;
            else
                close(fd);
            count++;
        }
    }
    return count == FD_COUNT;
}

static bool is_pipe(int fd, int access)
{
    struct stat stat;
    int flags = fcntl(fd, F_GETFL);

    return fstat(fd, &stat) == 0 && S_ISFIFO(stat.st_mode) && flags >= 0 && (flags & O_ACCMODE) == access;
}

static bool read_words(struct launch_request *request, size_t length, struct error *error)
{
    size_t count = 0;

    if (length == 0 || request->text[length - 1] != '\0') {
        error_set(error, "expected words that end in NUL");
        return false;
    }
    request->pool = request->text;
    for (size_t at = strlen(request->text) + 1; at < length; at += strlen(request->text + at) + 1) {
        if (count == POOL_COMMAND_WORD_LIMIT) {
            error_set(error, "expected at most %d words", POOL_COMMAND_WORD_LIMIT);
            return false;
        }
        request->words[count++] = request->text + at;
    }
    return true;
}

bool launch_request_receive(struct launch_request *request, int socket, struct error *error)
{
    union control control;
    struct iovec part = {.iov_base = request->text, .iov_len = sizeof request->text};
    struct msghdr message = {
        .msg_iov = &part, .msg_iovlen = 1, .msg_control = control.bytes, .msg_controllen = sizeof control.bytes};
    ssize_t length;
    bool ok;

    *request = (struct launch_request){.fds = {-1, -1, -1}};
    length = recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
    if (length < 0) {
        error_set_errno(error, errno, "recvmsg");
        return false;
    }
    ok = take_fds(&message, request->fds) && is_pipe(request->fds[0], O_RDONLY) && is_pipe(request->fds[1], O_WRONLY) &&
         is_pipe(request->fds[2], O_WRONLY);
    if (!ok)
        error_set(error, "expected the ends of three pipes");
    else if (message.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) {
        error_set(error, "expected a request of at most %d bytes", LAUNCH_REQUEST_SIZE);
        ok = false;
    }
    ok = ok && read_words(request, (size_t)length, error);
    if (!ok) launch_request_finish(request);
    return ok;
}

void launch_request_finish(struct launch_request *request)
{
    for (size_t i = 0; i < FD_COUNT; i++) {
        if (request->fds[i] >= 0) close(request->fds[i]);
        request->fds[i] = -1;
    }
}
