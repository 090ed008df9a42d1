// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/glsl_guard.h"

#include "worker/glsl/glsl_scanner.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// All in one line, so that the code keeps the numbers of its lines. Bits are compared, for drivers take isnan and isinf
// for false where they reorder arithmetic.
static const char functions[] =
    "float guarded_value(float v) { return (floatBitsToUint(v) & 0x7f800000u) == 0x7f800000u ? 0.0 : v; } "
    "vec2 guarded_value(vec2 v) { return vec2(guarded_value(v.x), guarded_value(v.y)); } "
    "vec3 guarded_value(vec3 v) { return vec3(guarded_value(v.xy), guarded_value(v.z)); } "
    "vec4 guarded_value(vec4 v) { return vec4(guarded_value(v.xy), guarded_value(v.zw)); } "
    "int guarded_value(int v) { return v; } uint guarded_value(uint v) { return v; } "
    "bool guarded_value(bool v) { return v; } mat2 guarded_value(mat2 v) { return v; } "
    "mat3 guarded_value(mat3 v) { return v; } mat4 guarded_value(mat4 v) { return v; } ";

struct guarding {
    FILE *out;
    const char *copied; // what comes before is written
    int wanted, count, line;
    bool is_returns_only;
    int braces, parens; // depth
    bool in_directive;
    const char *begin; // of the expression that is being read; NULL: none
    int begin_line, begin_parens;
};

// True for an = that assigns: neither ==, <=, >= nor !=.
static bool is_assignment(const struct glsl_token *token, const char *source)
{
    return glsl_token_is(token, "=") && token->text[1] != '=' && token->text > source &&
           !strchr("=<>!", token->text[-1]);
}

static void copy_to(struct guarding *guarding, const char *end)
{
    fwrite(guarding->copied, 1, (size_t)(end - guarding->copied), guarding->out);
    guarding->copied = end;
}

static void end_expression(struct guarding *guarding, const char *end)
{
    if (end > guarding->begin && ++guarding->count <= guarding->wanted) {
        copy_to(guarding, guarding->begin);
        fputs(" guarded_value(", guarding->out);
        copy_to(guarding, end);
        fputs(")", guarding->out);
        guarding->line = guarding->begin_line;
    }
    guarding->begin = NULL;
}

static void take(struct guarding *guarding, const struct glsl_token *token, const char *source)
{
    bool is_return = glsl_token_is(token, "return");

    if (token->kind == GLSL_TOKEN_HASH) guarding->in_directive = true;
    if (token->kind == GLSL_TOKEN_LINE_END) guarding->in_directive = false;
    if (guarding->in_directive) return;
    guarding->braces += glsl_token_is(token, "{") - glsl_token_is(token, "}");
    guarding->parens += glsl_token_is(token, "(") - glsl_token_is(token, ")");
    guarding->parens += glsl_token_is(token, "[") - glsl_token_is(token, "]");
    if (guarding->begin && glsl_token_is(token, "{")) guarding->begin = NULL; // a list of initial values
    if (guarding->begin && guarding->parens == guarding->begin_parens &&
        (glsl_token_is(token, ";") || glsl_token_is(token, ",")))
        end_expression(guarding, token->text);
    if (guarding->begin || guarding->braces == 0 || guarding->parens > 0) return;
    if (!is_return && (guarding->is_returns_only || !is_assignment(token, source))) return;
    guarding->begin = token->text + token->length;
    guarding->begin_line = token->line;
    guarding->begin_parens = guarding->parens;
}

struct glsl_guarded glsl_guard(const char *source, int wanted, bool is_returns_only)
{
    struct guarding guarding = {.copied = source, .wanted = wanted, .is_returns_only = is_returns_only};
    struct glsl_scanner scanner;
    struct glsl_token token;
    char *text = NULL;
    size_t size = 0;

    guarding.out = open_memstream(&text, &size);
    if (!guarding.out) return (struct glsl_guarded){0};
    fputs(functions, guarding.out);
    glsl_scanner_init(&scanner, source);
    do {
        token = glsl_scanner_next(&scanner);
        take(&guarding, &token, source);
    } while (token.kind != GLSL_TOKEN_END && token.kind != GLSL_TOKEN_BROKEN);
    copy_to(&guarding, source + strlen(source));
    if (fclose(guarding.out) == 0)
        return (struct glsl_guarded){.text = text, .count = guarding.count, .line = guarding.line};
    free(text);
    return (struct glsl_guarded){0};
}
