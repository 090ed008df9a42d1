// Describes the methods that clients call as an OpenRPC document: what `marchd --openrpc` prints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct json_writer;

void openrpc_write(struct json_writer *writer); // one JSON object
