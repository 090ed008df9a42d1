// Tells the sequences of a folder apart by the names of their files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct verify_list;

// Finds which digits of each name are its frame's number: those that its header says where they are among them, else those in
// whose place most files of the folder have a number, else the last. Files whose names are the same but for it are of one sequence.
// Sorts the files by sequence and frame and numbers the sequences from 0; returns how many there are.
size_t verify_names_sort(struct verify_list *list);
