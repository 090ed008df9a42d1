// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_peer.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <string.h>

enum { PREFIX_SIZE = 8, V4_OFFSET = 12 }; // bytes of an IPv6 address

static void name_v4_place(struct http_peer *peer, const struct in_addr *address)
{
    if (ntohl(address->s_addr) >> 24 == 127)
        strcpy(peer->place, "127.0.0.0/8");
    else
        inet_ntop(AF_INET, address, peer->place, sizeof peer->place);
}

static void name_v6_place(struct http_peer *peer, const struct in6_addr *address)
{
    struct in6_addr prefix = {0};
    struct in_addr v4;

    if (IN6_IS_ADDR_V4MAPPED(address)) {
        memcpy(&v4, address->s6_addr + V4_OFFSET, sizeof v4);
        name_v4_place(peer, &v4);
        return;
    }
    memcpy(&prefix, address, PREFIX_SIZE);
    inet_ntop(AF_INET6, &prefix, peer->place, INET6_ADDRSTRLEN);
    strcat(peer->place, "/64");
}

struct http_peer http_peer_name(const struct sockaddr *address)
{
    struct http_peer peer = {0};
    struct sockaddr_in v4;
    struct sockaddr_in6 v6;

    if (address->sa_family == AF_INET6) {
        memcpy(&v6, address, sizeof v6);
        inet_ntop(AF_INET6, &v6.sin6_addr, peer.address, sizeof peer.address);
        name_v6_place(&peer, &v6.sin6_addr);
    } else {
        memcpy(&v4, address, sizeof v4);
        inet_ntop(AF_INET, &v4.sin_addr, peer.address, sizeof peer.address);
        name_v4_place(&peer, &v4.sin_addr);
    }
    return peer;
}
