// Who is at the other end of a connection, as the kernel says.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/users/rights.h"

// Fills the peer and its user name, or its number as text (owned by the caller), as they were at the connection's
// start. Returns the peer's groups, which `peer` borrows; owned by the caller, NULL: unknown.
gid_t *client_peer_read(int fd, struct rights_peer *peer, char **user);
