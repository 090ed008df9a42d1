// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/options_amount.h"

#include "core/base/error.h"
#include "core/settings/options_value.h"

#include <stdlib.h>
#include <string.h>

// Parts of a day have their use in trials.
static bool read_days(const char *name, const char *text, int64_t *ms, struct error *error)
{
    static const double day_ms = 24 * 3600 * 1000, most = 100000;
    char *end = NULL;
    double days;

    *ms = 0;
    if (strcmp(text, "none") == 0) return true;
    days = strtod(text, &end);
    if (end != text && !*end && days * day_ms >= 1 && days <= most) {
        *ms = (int64_t)(days * day_ms);
        return true;
    }
    error_set(error, "--%s: expected \"none\" or a number of days, at most %.0f, got \"%s\"", name, most, text);
    return false;
}

bool options_amount_read(const struct options_amount *amounts, int code, const char *text, void *options,
                         struct error *error)
{
    const struct options_amount *amount = amounts;
    int64_t *number;

    while (amount->code != code)
        amount++;
    number = (int64_t *)((char *)options + amount->offset);
    if (amount->kilo > 0) return options_value_limit(amount->name, text, amount->kilo, 0, number, error);
    return read_days(amount->name, text, number, error);
}
