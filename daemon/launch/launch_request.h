// What the daemon asks march-launch for: one of a pool's commands, with pipes that become its standard streams.
// SPDX-License-Identifier: Apache-2.0
//
// It goes over a connected unix socket of packets (SOCK_SEQPACKET).
#pragma once

#include "daemon/settings/pool_command.h"

#include <stdbool.h>

struct error;

enum { LAUNCH_REQUEST_SIZE = 4096, LAUNCH_END_SIZE = 128 }; // bytes of a request, of the answer

// How an answer begins where the command was not ended by a signal; the number follows.
#define LAUNCH_END_STATUS "the launcher ended with exit status "
#define LAUNCH_END_WELL LAUNCH_END_STATUS "0"

struct launch_request {
    const char *pool;                               // borrowed from `text`, as the words
    const char *words[POOL_COMMAND_WORD_LIMIT + 1]; // of pool_command.h; ends in NULL
    int fds[3];                                     // owned; input, output, errors of the command
    char text[LAUNCH_REQUEST_SIZE];
};

// The descriptors stay the caller's. The answer is one packet: how the command ended, a sentence of at most
// LAUNCH_END_SIZE bytes. Whoever closes the connection before ends the command.
bool launch_request_send(int socket, const char *pool, const char *const words[], const int fds[static 3],
                         struct error *error);
// Waits for the request. What comes from a daemon is not trusted: the descriptors are then pipes, each open in its
// direction.
bool launch_request_receive(struct launch_request *request, int socket, struct error *error);
void launch_request_finish(struct launch_request *request); // legal after a request was received
