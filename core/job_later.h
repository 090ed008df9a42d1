// Parts of the job format that are not there yet: known by name, so that none is taken for a slip or passed over.
#pragma once

#include "core/json_read.h"

#include <stdbool.h>

struct error;

enum job_later_place { JOB_LATER_SCENE, JOB_LATER_QUALITY };

struct job_later {
    enum job_later_place place;
    const char *key;  // NULL ends the table
    const char *text; // the value that comes later; NULL: any
};

extern const struct job_later job_later_table[];

// Refuses what `object` holds of the table's entries for `place`: `PATH: "jittered" is not there yet`. Accepts an absent one.
bool job_later_check(const struct json_node *object, enum job_later_place place, struct error *error);
