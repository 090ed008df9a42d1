// Converts OpenVDB files to NanoVDB with nanovdb_convert, a program of OpenVDB.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

// Less than the time after which a worker without progress is ended.
enum { VDB_CONVERT_LIMIT_MS = 100 * 1000 };

// Returns a descriptor of the NanoVDB file, which is already unlinked; the caller closes it; -1 on failure. The program
// is ended after `limit_ms`, and when this process ends. Files that killed processes left behind are removed.
int vdb_convert(const char *path, int limit_ms, struct error *error);
