// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/glsl_scanner.h"

#include <ctype.h>
#include <string.h>

void glsl_scanner_init(struct glsl_scanner *scanner, const char *text)
{
    *scanner = (struct glsl_scanner){.at = text, .line = 1, .is_line_start = true};
}

// Returns the length of the line break at `at`; 0: there is none.
static size_t break_length(const char *at)
{
    if (*at != '\n' && *at != '\r') return 0;
    return (at[1] == '\n' || at[1] == '\r') && at[1] != at[0] ? 2 : 1;
}

static void skip_break(struct glsl_scanner *scanner)
{
    scanner->at += break_length(scanner->at);
    scanner->line++;
}

// Returns false where the text ends first.
static bool skip_comment(struct glsl_scanner *scanner)
{
    bool is_long = scanner->at[1] == '*';

    scanner->at += 2;
    while (*scanner->at) {
        if (is_long && scanner->at[0] == '*' && scanner->at[1] == '/') {
            scanner->at += 2;
            return true;
        }
        if (!is_long && *scanner->at == '\\' && break_length(scanner->at + 1))
            scanner->at++;
        else if (!is_long && break_length(scanner->at))
            return true;
        if (break_length(scanner->at))
            skip_break(scanner);
        else
            scanner->at++;
    }
    return !is_long;
}

// Skips to the next token, or to the line break that ends a directive. Returns false within a comment that does not
// end.
static bool skip_blanks(struct glsl_scanner *scanner)
{
    for (;;) {
        const char *at = scanner->at;

        if (at[0] == '/' && (at[1] == '/' || at[1] == '*')) {
            if (!skip_comment(scanner)) return false;
        } else if (at[0] == '\\' && break_length(at + 1)) {
            scanner->at++;
            skip_break(scanner);
        } else if (break_length(at)) {
            if (scanner->in_directive) return true;
            skip_break(scanner);
            scanner->is_line_start = true;
        } else if (*at == ' ' || *at == '\t' || *at == '\v' || *at == '\f') {
            scanner->at++;
        } else {
            return true;
        }
    }
}

static bool is_word_start(char c)
{
    return isalpha((unsigned char)c) || c == '_';
}

static size_t measure(const char *at, enum glsl_token_kind kind)
{
    size_t length = 1;

    if (kind == GLSL_TOKEN_WORD || kind == GLSL_TOKEN_NUMBER)
        while (is_word_start(at[length]) || isdigit((unsigned char)at[length]) ||
               (kind == GLSL_TOKEN_NUMBER && at[length] == '.'))
            length++;
    return length;
}

struct glsl_token glsl_scanner_next(struct glsl_scanner *scanner)
{
    struct glsl_token token = {.line = scanner->line};
    bool is_whole = skip_blanks(scanner);
    const char *at = scanner->at;

    token.text = at;
    // A comment without an end is reported where it begins.
    if (!is_whole) {
        token.kind = GLSL_TOKEN_BROKEN;
        return token;
    }
    token.line = scanner->line;
    if (!*at || break_length(at)) {
        token.kind = scanner->in_directive ? GLSL_TOKEN_LINE_END : GLSL_TOKEN_END;
        scanner->in_directive = false;
        return token;
    }
    if (*at == '#' && scanner->is_line_start)
        token.kind = GLSL_TOKEN_HASH;
    else if (is_word_start(*at))
        token.kind = GLSL_TOKEN_WORD;
    else if (isdigit((unsigned char)*at) || (*at == '.' && isdigit((unsigned char)at[1])))
        token.kind = GLSL_TOKEN_NUMBER;
    else
        token.kind = GLSL_TOKEN_MARK;
    scanner->in_directive |= token.kind == GLSL_TOKEN_HASH;
    scanner->is_line_start = false;
    token.length = measure(at, token.kind);
    scanner->at += token.length;
    return token;
}

bool glsl_token_is(const struct glsl_token *token, const char *text)
{
    return strlen(text) == token->length && memcmp(token->text, text, token->length) == 0;
}

bool glsl_token_is_any(const struct glsl_token *token, const char *const *texts)
{
    for (; *texts; ++texts)
        if (glsl_token_is(token, *texts)) return true;
    return false;
}
