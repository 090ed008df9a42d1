// Keeps drivers loaded to the end, so that the leak checker can name the owner of leaked memory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Call while a context is alive: the libraries loaded by then stay.
void keep_libraries(void);
