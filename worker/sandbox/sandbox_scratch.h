// A temporary folder of this worker alone, for the files of a converter.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

// Makes the folder in $TMPDIR and sets $TMPDIR to it, before there are threads. Returns its descriptor, which stays
// open as long as the folder is used; -1 on failure. A fenced worker cannot remove the folder, so the next worker does.
int sandbox_scratch_make(struct error *error);
// Removes the folders that ended workers left in $TMPDIR.
void sandbox_scratch_sweep(void);
