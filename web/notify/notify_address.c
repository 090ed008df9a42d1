// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_address.h"

#include <ifaddrs.h>
#include <netinet/in.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>

struct block4 {
    uint32_t base;
    int bits;
};

static const struct block4 special4[] = {
    {0x00000000, 8},  // this network
    {0x0a000000, 8},  // private
    {0x64400000, 10}, // shared by a provider
    {0x7f000000, 8},  // this machine
    {0xa9fe0000, 16}, // link
    {0xac100000, 12}, // private
    {0xc0000000, 24}, // protocols
    {0xc0000200, 24}, // documentation
    {0xc0586300, 24}, // 6to4 relays
    {0xc0a80000, 16}, // private
    {0xc6120000, 15}, // benchmarks
    {0xc6336400, 24}, // documentation
    {0xcb007100, 24}, // documentation
    {0xe0000000, 4},  // groups
    {0xf0000000, 4},  // reserved, broadcast
};

static bool is_public4(uint32_t address)
{
    for (size_t i = 0; i < sizeof special4 / sizeof special4[0]; i++)
        if ((address ^ special4[i].base) >> (32 - special4[i].bits) == 0) return false;
    return true;
}

static uint32_t word_at(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

// Of 2000::/3, the addresses of hosts, those that are something else or lead to an IPv4 address.
static bool is_public6(const uint8_t bytes[static 16])
{
    static const uint8_t mapped[12] = {[10] = 0xff, [11] = 0xff}, translated[12] = {0x00, 0x64, 0xff, 0x9b};

    if (memcmp(bytes, mapped, 12) == 0 || memcmp(bytes, translated, 12) == 0) return is_public4(word_at(bytes + 12));
    if (bytes[0] >> 5 != 1) return false;
    if (bytes[0] == 0x20 && bytes[1] == 0x02) return is_public4(word_at(bytes + 2)); // 6to4
    if (word_at(bytes) >> 9 == 0x20010000 >> 9) return false;                        // protocols, Teredo among them
    if (word_at(bytes) == 0x20010db8) return false;                                  // documentation
    if (bytes[0] == 0x3f && bytes[1] == 0xff && bytes[2] >> 4 == 0) return false;    // documentation
    return true;
}

bool notify_address_is_public(const struct sockaddr *address)
{
    if (address->sa_family == AF_INET) {
        struct sockaddr_in host;

        memcpy(&host, address, sizeof host);
        return is_public4(ntohl(host.sin_addr.s_addr));
    }
    if (address->sa_family == AF_INET6) {
        struct sockaddr_in6 host;

        memcpy(&host, address, sizeof host);
        return is_public6(host.sin6_addr.s6_addr);
    }
    return false;
}

// As IPv6, in which an IPv4 address is a mapped one.
static bool take_address(const struct sockaddr *address, struct in6_addr *taken)
{
    *taken = (struct in6_addr){.s6_addr = {[10] = 0xff, [11] = 0xff}};
    if (address && address->sa_family == AF_INET6)
        memcpy(taken, (const char *)address + offsetof(struct sockaddr_in6, sin6_addr), sizeof *taken);
    else if (address && address->sa_family == AF_INET)
        memcpy(&taken->s6_addr[12], (const char *)address + offsetof(struct sockaddr_in, sin_addr), 4);
    else
        return false;
    return true;
}

bool notify_address_is_own(const struct sockaddr *address)
{
    struct in6_addr wanted, own;
    struct ifaddrs *interfaces;
    bool is_own = false;

    if (!take_address(address, &wanted) || getifaddrs(&interfaces) != 0) return true;
    for (const struct ifaddrs *entry = interfaces; entry && !is_own; entry = entry->ifa_next)
        is_own = take_address(entry->ifa_addr, &own) && memcmp(&own, &wanted, sizeof own) == 0;
    freeifaddrs(interfaces);
    return is_own;
}
