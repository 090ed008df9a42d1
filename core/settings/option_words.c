// SPDX-License-Identifier: Apache-2.0
#include "core/settings/option_words.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <stdlib.h>
#include <string.h>

void option_words_add(struct option_words *words, char *word)
{
    words->words = xgrow(words->words, &words->capacity, words->count + 2, sizeof words->words[0]);
    words->words[words->count++] = word;
    words->words[words->count] = NULL;
}

bool option_words_split(struct option_words *words, const char *text, struct error *error)
{
    char *word = xmalloc(strlen(text) + 1), quote = '\0';
    size_t length = 0;
    bool is_word = false;

    for (; *text; text++) {
        if (quote ? *text == quote : *text == '"' || *text == '\'') {
            quote = quote ? '\0' : *text;
            is_word = true;
        } else if (!quote && (*text == ' ' || *text == '\t')) {
            if (is_word) option_words_add(words, xstrndup(word, length));
            is_word = false;
            length = 0;
        } else {
            word[length++] = *text;
            is_word = true;
        }
    }
    if (is_word) option_words_add(words, xstrndup(word, length));
    free(word);
    if (quote) error_set(error, "expected another %c at the end", quote);
    return !quote;
}

void option_words_free(char **words)
{
    for (size_t i = 0; words && words[i]; i++)
        free(words[i]);
    free(words);
}
