// SPDX-License-Identifier: Apache-2.0
#include "web/program/web_check.h"

#include "core/base/error.h"
#include "web/http/http_listener.h"
#include "web/http/http_walls.h"
#include "web/notify/notifier.h"
#include "web/settings/web_options.h"

bool web_check_options(const struct web_options *options, struct http_origins *origins, struct error *error)
{
    if (!http_address_check(options->listen, error) || !notifier_check(&options->notify_targets, error)) return false;
    for (size_t i = 0; i < options->origin_count; i++)
        if (!http_origins_add(origins, options->origins[i], error)) return false;
    if (http_origins_have_secure(origins) || http_address_is_loopback(options->listen)) return true;
    error_set(error,
              "--listen: %s is not this machine's alone: march-web speaks no TLS; behind a proxy that does, --origin "
              "names its address, like https://farm.example.org",
              options->listen);
    return false;
}
