// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/token_request.h"
#include "cli/program/options.h"
#include "cli/terminal/browser.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_URL "http://127.0.0.1:8470"

// The base of the address, which the token is appended to.
static bool check_url(const char *url, struct error *error)
{
    bool is_web = strncmp(url, "http://", 7) == 0 || strncmp(url, "https://", 8) == 0;

    for (const char *byte = url; *byte && is_web; byte++)
        is_web = *byte > ' ' && *byte < 0x7f && !strchr("\"'<>\\^`{|}?#", *byte);
    if (is_web) return true;
    error_set(error, "--url: expected an address such as " DEFAULT_URL ", got \"%s\"", url);
    return false;
}

static char *format_address(const char *url, const char *token)
{
    size_t length = strlen(url);

    return xasprintf("%s%s?token=%s", url, url[length - 1] == '/' ? "" : "/", token);
}

static void tell(const struct options *options, const char *address)
{
    struct json_writer writer = {0};

    if (options->json) {
        json_write_begin_object(&writer);
        json_write_string_member(&writer, "url", address);
        json_write_end_object(&writer);
        printf("%.*s\n", (int)writer.length, writer.text);
    } else {
        printf("%s\n", address);
    }
    json_writer_finish(&writer);
    fflush(stdout);
}

enum exit_status command_web(const struct options *options, struct error *error)
{
    const struct token_request request = {
        .name = "march web", .scope = options->scope ? options->scope : "submit", .is_once = true};
    const char *url = options->url ? options->url : DEFAULT_URL;
    struct error trouble = {0};
    struct token_reply token;
    enum exit_status status;
    char *address;

    if (!check_url(url, error)) return EXIT_STATUS_USAGE;
    status = token_request_send(options, &request, &token, error);
    if (status != EXIT_STATUS_DONE) return status;
    address = format_address(url, token.text);
    tell(options, address);
    if (!options->print && !browser_open(address, &trouble))
        fprintf(stderr, "march web: %s: open the address above within five minutes\n", trouble.message);
    free(address);
    message_finish(&token.reply);
    return status;
}
