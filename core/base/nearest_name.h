// The name that a misspelt one probably stands for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The name of `names` (ends in NULL) nearest to `text`, ignoring case; NULL when none is near.
const char *nearest_name_find(const char *text, const char *const names[]);
