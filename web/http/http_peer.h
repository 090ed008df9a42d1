// Who is at the other end of a TCP connection: the address for the log, and the place that limits count.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>

enum { HTTP_PEER_SIZE = INET6_ADDRSTRLEN + 4 };

struct http_peer {
    char address[HTTP_PEER_SIZE];
    // Whoever has one address of a place has them all: of IPv6 it is the first 64 bits, "2001:db8:0:1::/64", of this
    // machine 127.0.0.0/8, else the address. IPv4 within IPv6 counts as IPv4.
    char place[HTTP_PEER_SIZE];
};

struct http_peer http_peer_name(const struct sockaddr *address); // of IPv4 or IPv6
