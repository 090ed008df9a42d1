// Parts of a job's quality that are not there yet: known by name, so that none is taken for a slip or passed over.
#pragma once

#include "core/json_read.h"

#include <stdbool.h>

struct error;

struct job_later {
    const char *key;  // NULL ends the table
    const char *text; // the value that comes later; NULL: any
};

extern const struct job_later job_later_table[];

// Refuses what `quality` holds of the table: `PATH: "gauss" is not there yet`. Accepts an absent one.
bool job_later_check(const struct json_node *quality, struct error *error);
