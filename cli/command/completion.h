// What may come next on a command line of `march`, for the shells' completion: it is said by the tables that parse it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdio.h>

// Writes a line for each id of a job that verb VERB could mean: the id, a tab, what it is.
typedef void completion_write_ids(FILE *out, const char *verb);

// `words` are those behind `march`, the last of them (maybe empty) being typed. Writes a line for each word that it may become:
// the word, a tab and what it is; or :files, :folders or :json where names of files belong (the last: of job files). An
// option's value may stand behind "=", as one word or, as bash has it, as words of its own.
void completion_write(FILE *out, const char *const words[], size_t count, completion_write_ids *write_ids);
