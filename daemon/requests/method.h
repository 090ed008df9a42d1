// How a method of the protocol is described: its parameters, its result, and who handles it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/requests/request.h"
#include "daemon/users/access.h"

#include <stdbool.h>
#include <stdint.h>

// A parameter, or a member of a result. A new method's rows go into a methods_*.c; what several have in common is a
// shape.
struct member {
    // NULL ends an array of members.
    const char *name;
    // integer, number, string, boolean, object (of any members), or the name of a shape. After it "[]" means an array
    // of such, "?" that it may be null, both from the left: "number?[]?" is null or an array of numbers and nulls.
    const char *type;
    const char *meaning;      // one line
    int64_t min, max;         // of an integer, closed; both 0: any. `max` 0: as large as JSON has
    const char *const *names; // what a string may be, ends in NULL; NULL: any text
    const char *fallback;     // what an absent parameter stands for, as JSON; NULL: it says so in `meaning`
    bool is_optional;         // may be absent
    bool is_set;              // one of `names`, or an array of them
};

// An object with a name in the OpenRPC document.
struct shape {
    const char *name;
    const char *meaning;
    const struct member *members;        // NULL: it has `variants`
    const struct shape *more;            // its members belong to it, too; NULL: none
    const struct shape *const *variants; // it is one of these; ends in NULL
};

struct method {
    const char *name; // NULL ends a table
    enum request_outcome (*handle)(struct request *request);
    const char *meaning;
    enum access_need need;       // of the connection
    const struct member *params; // NULL: none
    // The result is this shape, an object of these members, or both: the shape's members and these. Neither: an empty
    // object.
    const struct shape *result_shape;
    const struct member *result;
};
