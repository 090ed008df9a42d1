// Completes command lines of `march` for the shells, from the tables that parse them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdio.h>

// Writes a line for each job id that suits `verb`: the id, a tab, a description.
typedef void completion_write_ids(FILE *out, const char *verb);

// `words` are those after `march`; the last of them (maybe empty) is being typed. Writes a line for each completion:
// the word, a tab and a description; or :files, :folders or :json (job files) where a file's name belongs. An option's
// value may follow "=", in one word or, as bash splits it, in separate words.
void completion_write(FILE *out, const char *const words[], size_t count, completion_write_ids *write_ids);
