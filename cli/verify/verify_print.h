// Prints the result of verifying: a table of defects and a line for each sequence, or JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct verify_list;
struct verify_sequence;

// True when none of `count` sequences has a defect.
bool verify_print_is_good(const struct verify_sequence *sequences, size_t count);
void verify_print_text(const struct verify_list *list, const struct verify_sequence *sequences, size_t count);
void verify_print_json(const struct verify_list *list, const struct verify_sequence *sequences, size_t count);
