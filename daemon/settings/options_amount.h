// Options that bound something: an amount, or none.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

struct options_amount {
    int code; // of the option
    const char *name;
    size_t offset; // of the int64_t that has the amount, where 0 is none
    int64_t kilo;  // what a K of the amount is; 0: it is a number of days, kept as milliseconds
};

// Reads the value of the option with that code, which `amounts` has, into `options`.
bool options_amount_read(const struct options_amount *amounts, int code, const char *text, void *options,
                         struct error *error);
