// Words of a setting that holds several, and of a command line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

// The zero value is empty.
struct option_words {
    char **words; // owned, ends in NULL; NULL: none
    size_t count, capacity;
};

void option_words_add(struct option_words *words, char *word); // takes ownership
// Adds the words of a text. They stand between blanks; quotes, double or single, keep blanks and the other quotes
// within a word.
bool option_words_split(struct option_words *words, const char *text, struct error *error);
void option_words_free(char **words); // the array of a struct option_words; accepts NULL
