// Which addresses are the internet's: others are reached only by targets that may.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct sockaddr;

// False for addresses of this machine, of private networks, links, groups and whatever else is no host of the internet,
// also where an IPv6 address holds such an IPv4 address; and for families other than these two. IANA's registries of
// special-purpose addresses.
bool notify_address_is_public(const struct sockaddr *address);
// Whether an interface of this machine has it now, public or not; true where that cannot be found out. Asks the kernel.
bool notify_address_is_own(const struct sockaddr *address);
