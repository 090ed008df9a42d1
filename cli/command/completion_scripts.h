// What the shells load to complete `march` and `marchd`: they ask the programs themselves, so nothing goes out of date.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Of "bash", "zsh" or "fish"; NULL of any other.
const char *completion_script(const char *shell);
