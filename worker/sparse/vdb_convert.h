// Turns OpenVDB files into NanoVDB ones with the program that OpenVDB's authors ship for it, nanovdb_convert.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

// Less than a worker may be without progress: who waits longer is taken for stuck.
enum { VDB_CONVERT_LIMIT_MS = 100 * 1000 };

// A descriptor, owned by the caller, of the NanoVDB file, which has no name any more; -1 on failure. The program is ended
// after `limit_ms`, and with this process. What killed processes have left behind is removed.
int vdb_convert(const char *path, int limit_ms, struct error *error);
