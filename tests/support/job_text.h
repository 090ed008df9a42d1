// Job documents for tests to start from.
#pragma once

#include <stddef.h>

// jobs/NAME, owned by the caller.
char *job_text_load(const char *name);

// A job that uses every key and every way to move a value at least once.
extern const char job_text_full[];
