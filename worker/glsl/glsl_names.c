// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/glsl_names.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/glsl/glsl_scanner.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { CONDITION_DEPTH_LIMIT = 32, DEPTH_LIMIT = 256, NAME_LIMIT = 2000, SIGNATURE_LIMIT = 500 };

static const char *const qualifiers[] = {"const", "highp", "mediump",  "lowp",     "precise",  "invariant", "in",
                                         "out",   "inout", "volatile", "restrict", "readonly", "writeonly", NULL};
static const char *const interfaces[] = {"layout",  "uniform",    "buffer",  "shared", "attribute",
                                         "varying", "subroutine", "discard", NULL};
static const char *const directions[] = {"in", "out", "inout", NULL};

// One declaration outside of functions, as far as it is read.
struct declaration {
    struct glsl_token type, name; // length 0: not yet
    bool is_struct, is_function, is_initializer, is_skipped;
};

struct reader {
    struct glsl_scanner scanner;
    struct glsl_names *names;
    const char *file;
    const char *const *taken;
    struct error *error;
    struct declaration declaration;
    char *signature;        // owned; of the function whose parameters are read
    bool wants_parameter;   // the next word is a parameter's type
    char open[DEPTH_LIMIT]; // brackets that wait for their ends
    int lines[DEPTH_LIMIT]; // where they are
    int depth;
    int depths[CONDITION_DEPTH_LIMIT], condition_lines[CONDITION_DEPTH_LIMIT]; // at each #if that is open
    int condition_count;
};

__attribute__((format(printf, 3, 4))) static bool fail(struct reader *reader, int line, const char *format, ...)
{
    char *text = NULL;
    va_list arguments;

    va_start(arguments, format);
    if (vasprintf(&text, format, arguments) < 0) abort();
    va_end(arguments);
    error_set(reader->error, "%s:%d: %s", reader->file, line, text);
    free(text);
    return false;
}

static struct glsl_name *add_name(struct reader *reader, const struct glsl_token *token)
{
    struct glsl_names *names = reader->names;
    struct glsl_name *name;

    names->names = xgrow(names->names, &names->capacity, names->count + 1, sizeof *names->names);
    name = &names->names[names->count++];
    *name = (struct glsl_name){.text = xstrndup(token->text, token->length), .line = token->line};
    return name;
}

static bool check_word(struct reader *reader, const struct glsl_token *token)
{
    int length = (int)token->length;

    if (glsl_token_is_any(token, interfaces))
        return fail(reader, token->line, "\"%.*s\" is not for a density: it follows from its point and the time alone",
                    length, token->text);
    if (length >= 3 && memcmp(token->text, "gl_", 3) == 0)
        return fail(reader, token->line, "%.*s is not for a density: it follows from its point and the time alone",
                    length, token->text);
    if (memmem(token->text, token->length, "__", 2) && strncmp(token->text, "__", 2) != 0)
        return fail(reader, token->line, "%.*s: names with two underscores in a row are the compiler's", length,
                    token->text);
    if (glsl_token_is_any(token, reader->taken))
        return fail(reader, token->line, "the name %.*s is the renderer's: expected another", length, token->text);
    return true;
}

// Compilers take such a character, often an invisible one, for the text's end.
static bool check_mark(struct reader *reader, const struct glsl_token *token)
{
    unsigned char first = (unsigned char)*token->text;
    unsigned long code = first & (first < 0xe0 ? 0x1f : first < 0xf0 ? 0x0f : 0x07);

    if (first < 0x80) return true;
    for (const char *next = token->text + 1; ((unsigned char)*next & 0xc0) == 0x80; ++next)
        code = code << 6 | ((unsigned char)*next & 0x3f);
    return fail(reader, token->line, "expected ASCII outside of comments, got the character U+%04lX", code);
}

static bool begin_condition(struct reader *reader, int line)
{
    if (reader->condition_count == CONDITION_DEPTH_LIMIT)
        return fail(reader, line, "expected at most %d #if in one another", CONDITION_DEPTH_LIMIT);
    reader->depths[reader->condition_count] = reader->depth;
    reader->condition_lines[reader->condition_count++] = line;
    return true;
}

// Each branch begins between the same brackets.
static bool change_condition(struct reader *reader, const struct glsl_token *name)
{
    if (reader->condition_count == 0)
        return fail(reader, name->line, "#%.*s without #if", (int)name->length, name->text);
    if (glsl_token_is(name, "endif")) {
        reader->condition_count--;
        return true;
    }
    if (reader->depth > reader->depths[reader->condition_count - 1]) {
        reader->declaration = (struct declaration){0};
        free(reader->signature);
        reader->signature = NULL;
    }
    reader->depth = reader->depths[reader->condition_count - 1];
    return true;
}

static bool read_directive(struct reader *reader)
{
    static const char *const openers[] = {"if", "ifdef", "ifndef", NULL};
    static const char *const changers[] = {"else", "elif", "endif", NULL};
    static const char *const others[] = {"define", "undef", "error", NULL};
    struct glsl_token name = glsl_scanner_next(&reader->scanner), token = name;
    bool is_define = glsl_token_is(&name, "define");

    if (name.kind == GLSL_TOKEN_LINE_END) return true;
    if (glsl_token_is_any(&name, openers)) {
        if (!begin_condition(reader, name.line)) return false;
    } else if (glsl_token_is_any(&name, changers)) {
        if (!change_condition(reader, &name)) return false;
    } else if (!glsl_token_is_any(&name, others)) {
        return fail(reader, name.line, "#%.*s is not for a density: expected #define, #undef, #if and its like",
                    (int)name.length, name.text);
    }
    for (bool is_first = true; token.kind != GLSL_TOKEN_LINE_END; is_first = false) {
        token = glsl_scanner_next(&reader->scanner);
        if (token.kind == GLSL_TOKEN_BROKEN) return fail(reader, token.line, "a comment has no end");
        if (token.kind == GLSL_TOKEN_MARK && !check_mark(reader, &token)) return false;
        if (token.kind != GLSL_TOKEN_WORD) continue;
        if (!check_word(reader, &token)) return false;
        if (is_define && is_first) add_name(reader, &token)->is_macro = true;
    }
    return true;
}

static void add_to_signature(struct reader *reader, const char *text, size_t length)
{
    char *longer;

    if (strlen(reader->signature) > SIGNATURE_LIMIT) return;
    longer = xasprintf("%s%.*s", reader->signature, (int)length, text);

    free(reader->signature);
    reader->signature = longer;
}

static void begin_function(struct reader *reader)
{
    struct declaration *declaration = &reader->declaration;

    declaration->is_function = true;
    reader->wants_parameter = true;
    reader->signature = xasprintf("%.*s %.*s(", (int)declaration->type.length, declaration->type.text,
                                  (int)declaration->name.length, declaration->name.text);
}

static void end_parameters(struct reader *reader)
{
    struct glsl_name *name = add_name(reader, &reader->declaration.name);

    add_to_signature(reader, ")", 1);
    name->signature = reader->signature;
    reader->signature = NULL;
}

static void read_parameter(struct reader *reader, const struct glsl_token *token)
{
    if (token->kind == GLSL_TOKEN_WORD && reader->wants_parameter && !glsl_token_is_any(token, qualifiers) &&
        !glsl_token_is(token, "void")) {
        add_to_signature(reader, token->text, token->length);
        reader->wants_parameter = false;
    } else if (token->kind == GLSL_TOKEN_MARK && *token->text == ',' && reader->depth == 1) {
        add_to_signature(reader, ", ", 2);
        reader->wants_parameter = true;
    }
}

static bool open_bracket(struct reader *reader, const struct glsl_token *token)
{
    struct declaration *declaration = &reader->declaration;

    if (reader->depth == DEPTH_LIMIT) return fail(reader, token->line, "too many brackets in one another");
    if (reader->depth == 0 && *token->text == '(' && declaration->name.length && !declaration->is_initializer &&
        !declaration->is_function)
        begin_function(reader);
    if (reader->depth == 0 && *token->text == '{' && declaration->is_function)
        reader->names->names[reader->names->count - 1].has_body = true;
    reader->lines[reader->depth] = token->line;
    reader->open[reader->depth++] = *token->text;
    return true;
}

static bool close_bracket(struct reader *reader, const struct glsl_token *token)
{
    static const char pairs[] = "()[]{}";
    char opener = strchr(pairs, *token->text)[-1];

    if (reader->depth == 0 || reader->open[reader->depth - 1] != opener)
        return fail(reader, token->line, "a \"%c\" without its \"%c\"", *token->text, opener);
    reader->depth--;
    if (reader->depth > 0) return true;
    if (opener == '(' && reader->signature) end_parameters(reader);
    if (opener == '{' && reader->declaration.is_function) reader->declaration = (struct declaration){0};
    return true;
}

static bool read_outer_word(struct reader *reader, const struct glsl_token *token)
{
    struct declaration *declaration = &reader->declaration;

    if (glsl_token_is_any(token, directions))
        return fail(reader, token->line, "\"%.*s\" is not for a density: it follows from its point and the time alone",
                    (int)token->length, token->text);
    if (declaration->is_initializer || declaration->is_skipped || glsl_token_is_any(token, qualifiers)) return true;
    if (glsl_token_is(token, "precision")) {
        declaration->is_skipped = true;
    } else if (glsl_token_is(token, "struct")) {
        declaration->is_struct = true;
    } else if (declaration->type.length == 0) {
        declaration->type = *token;
        if (declaration->is_struct) add_name(reader, token);
    } else {
        declaration->name = *token;
    }
    return true;
}

// True for a token that ends a declarator at the outermost level.
static void read_outer_mark(struct reader *reader, char mark)
{
    struct declaration *declaration = &reader->declaration;

    if (mark != ';' && mark != ',' && mark != '=') return;
    if (declaration->name.length && !declaration->is_function && !declaration->is_initializer)
        add_name(reader, &declaration->name);
    declaration->name.length = 0;
    declaration->is_initializer = mark == '=';
    if (mark == ';') *declaration = (struct declaration){0};
}

static bool read_token(struct reader *reader, const struct glsl_token *token)
{
    if (token->kind == GLSL_TOKEN_HASH) return read_directive(reader);
    if (token->kind == GLSL_TOKEN_WORD && !check_word(reader, token)) return false;
    if (token->kind == GLSL_TOKEN_MARK && !check_mark(reader, token)) return false;
    if (reader->signature) read_parameter(reader, token);
    if (token->kind == GLSL_TOKEN_WORD) return reader->depth > 0 || read_outer_word(reader, token);
    if (token->kind != GLSL_TOKEN_MARK) return true;
    if (strchr("([{", *token->text)) return open_bracket(reader, token);
    if (strchr(")]}", *token->text)) return close_bracket(reader, token);
    if (reader->depth == 0) read_outer_mark(reader, *token->text);
    return true;
}

static bool check_end(struct reader *reader)
{
    if (reader->condition_count > 0)
        return fail(reader, reader->condition_lines[reader->condition_count - 1], "an #if without #endif");
    if (reader->depth > 0)
        return fail(reader, reader->lines[reader->depth - 1], "a \"%c\" that is not closed",
                    reader->open[reader->depth - 1]);
    return true;
}

bool glsl_names_read(struct glsl_names *names, const char *file, const char *text, const char *const *taken,
                     struct error *error)
{
    struct reader reader = {.names = names, .file = file, .taken = taken, .error = error};
    struct glsl_token token;
    bool ok = true;

    *names = (struct glsl_names){0};
    glsl_scanner_init(&reader.scanner, text);
    for (token = glsl_scanner_next(&reader.scanner); ok && token.kind != GLSL_TOKEN_END;
         token = glsl_scanner_next(&reader.scanner)) {
        if (token.kind == GLSL_TOKEN_BROKEN)
            ok = fail(&reader, token.line, "a comment has no end");
        else if (names->count > NAME_LIMIT)
            ok = fail(&reader, token.line, "expected at most %d names outside of functions", NAME_LIMIT);
        else
            ok = read_token(&reader, &token);
        if (!ok) break;
    }
    ok = ok && check_end(&reader);
    free(reader.signature);
    if (!ok) glsl_names_finish(names);
    return ok;
}

void glsl_names_finish(struct glsl_names *names)
{
    for (size_t i = 0; i < names->count; ++i) {
        free(names->names[i].text);
        free(names->names[i].signature);
    }
    free(names->names);
    *names = (struct glsl_names){0};
}

// True for the first entry of a name that no macro has.
static bool is_renamed(const struct glsl_names *names, size_t index)
{
    for (size_t i = 0; i < names->count; ++i) {
        if (strcmp(names->names[i].text, names->names[index].text) != 0) continue;
        if (names->names[i].is_macro || i < index) return false;
    }
    return true;
}

static bool is_first(const struct glsl_names *names, size_t index)
{
    for (size_t i = 0; i < index; ++i)
        if (strcmp(names->names[i].text, names->names[index].text) == 0) return false;
    return true;
}

void glsl_names_write_private(const struct glsl_names *names, const char *prefix, FILE *out)
{
    for (size_t i = 0; i < names->count; ++i) {
        const char *text = names->names[i].text;

        // A name with two underscores in a row is reserved.
        if (is_renamed(names, i)) fprintf(out, "#define %s %s%s%s\n", text, prefix, *text == '_' ? "_x" : "_", text);
    }
}

void glsl_names_write_hide(const struct glsl_names *names, FILE *out)
{
    for (size_t i = 0; i < names->count; ++i)
        if (is_first(names, i)) fprintf(out, "#undef %s\n", names->names[i].text);
}
