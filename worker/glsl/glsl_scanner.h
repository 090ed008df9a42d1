// Cuts a GLSL text into words and marks, with their lines. Comments and line continuations are left out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum glsl_token_kind {
    GLSL_TOKEN_END,
    GLSL_TOKEN_WORD, // identifier or keyword
    GLSL_TOKEN_NUMBER,
    GLSL_TOKEN_MARK,     // one character
    GLSL_TOKEN_HASH,     // the # that begins a directive
    GLSL_TOKEN_LINE_END, // of a directive
    GLSL_TOKEN_BROKEN    // a comment without an end
};

struct glsl_token {
    enum glsl_token_kind kind;
    const char *text; // borrowed from what is scanned; not terminated
    size_t length;
    int line; // from 1
};

struct glsl_scanner {
    const char *at; // borrowed; terminated
    int line;
    bool is_line_start; // nothing but blanks before it
    bool in_directive;
};

void glsl_scanner_init(struct glsl_scanner *scanner, const char *text);
struct glsl_token glsl_scanner_next(struct glsl_scanner *scanner);

bool glsl_token_is(const struct glsl_token *token, const char *text);
// True when the token's text is one of `texts`, which ends in NULL.
bool glsl_token_is_any(const struct glsl_token *token, const char *const *texts);
