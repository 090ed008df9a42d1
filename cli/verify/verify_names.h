// Groups the files of a folder into sequences, by their names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct verify_list;

// Finds the frame's number in each name: the one in its header; else the one whose stem most files of the folder share;
// else the last. Files whose names differ only in that number form a sequence. Sorts the files by sequence and frame,
// numbers the sequences from 0 and returns their count.
size_t verify_names_sort(struct verify_list *list);
