// A folder of this worker's alone for what a converter writes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

// Makes one in $TMPDIR, which it then becomes; before there are threads. Returns its descriptor, to be kept open for as long as
// the folder is wanted; -1 on failure. A fenced worker cannot remove it: the next one does.
int sandbox_scratch_make(struct error *error);
// Removes what workers that are gone left in $TMPDIR.
void sandbox_scratch_sweep(void);
