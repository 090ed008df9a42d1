// What a node says of itself first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct json_writer;

// An object: protocol, version, host, pid, uid, cores, memory_bytes, landlock (its ABI version; 0: none), and why
// there is none.
void host_hello_write(const char *version, struct json_writer *writer);
