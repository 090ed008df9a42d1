// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/glsl_names.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const taken[] = {"Spectrum", NULL};

static void read_names(struct glsl_names *names, const char *text)
{
    struct error error = {{0}};

    if (!glsl_names_read(names, "a.glsl", text, taken, &error)) fail_msg("%s: %s", text, error.message);
}

// "name:line" of each, macros with a #, functions by their signatures; "" after ones without a body.
static void assert_names(const char *text, const char *wanted)
{
    struct glsl_names names;
    char *found = xstrdup("");

    read_names(&names, text);
    for (size_t i = 0; i < names.count; i++) {
        const struct glsl_name *name = &names.names[i];
        char *longer = xasprintf("%s%s%s%s:%d%s", found, i > 0 ? " " : "", name->is_macro ? "#" : "",
                                 name->signature ? name->signature : name->text, name->line,
                                 name->signature && !name->has_body ? ";" : "");

        free(found);
        found = longer;
    }
    assert_string_equal(found, wanted);
    free(found);
    glsl_names_finish(&names);
}

static void names_outside_of_functions_are_found(void **state)
{
    assert_names("", "");
    assert_names("float density(vec3 p, float t) { float inner = 1.0; return inner; }", "float density(vec3, float):1");
    assert_names("const float A = 1.0, B = f(2.0, 3.0), C[2] = float[2](1.0, 2.0);\nvec3 d;", "A:1 B:1 C:1 d:2");
    assert_names("float[3] a;\nfloat b[3], c;", "a:1 b:2 c:2");
    assert_names("struct Ball { vec3 center; float radius; };\nBall ball = Ball(vec3(0), 1.0);", "Ball:1 ball:2");
    assert_names("struct Ball { float radius; } one, two[2];", "Ball:1 one:1 two:1");
    assert_names("precision highp float;\nconst highp float a = 1.;", "a:2");
    assert_names("mat3 turn(const in float a, out vec3[2] b, inout sampler3D c[2]);",
                 "mat3 turn(float, vec3, sampler3D):1;");
    assert_names("float f(void) { return 1.0; }\nfloat f() { return 1.0; }", "float f():1 float f():2");
    assert_names("#define PI 3.14\n#define TWICE(x) (2.0 * (x))\n#undef PI\nfloat a = TWICE(PI);",
                 "#PI:1 #TWICE:2 a:4");
}

static void comments_and_continued_lines_hide_nothing(void **state)
{
    assert_names("/* float a;\n} */ float b; // float c; \\\n float d;\nfloat e;", "b:2 e:4");
    assert_names("#define LONG a + \\\n b\nfloat c;", "#LONG:1 c:3");
    assert_names("float a;\r\nfloat b;\r\n\r\nfloat c;", "a:1 b:2 c:4");
    assert_names("# /* x */ define A 1\nfloat b = A / 2.0;", "#A:1 b:2");
    assert_names("float a = 1.e-3, b = .5f;", "a:1 b:1");
}

static void branches_of_a_condition_are_all_read(void **state)
{
    assert_names("#if 1\nfloat a(float x) {\n#else\nfloat b(vec2 x) {\n#endif\n    return 1.0;\n}\nfloat c;",
                 "float a(float):2 float b(vec2):4 c:8");
    assert_names("float f() {\n#ifdef A\n    float x;\n#elif 0\n    float y;\n#endif\n    return 0.0;\n}",
                 "float f():1");
    assert_names("float f(\n#if 0\nfloat a)\n#else\nvec3 b)\n#endif\n{ return 0.0; }\nfloat g;",
                 "float f(float):1 g:8");
}

static void assert_refused(const char *text, const char *wanted)
{
    struct error error = {{0}};
    struct glsl_names names;

    assert_false(glsl_names_read(&names, "a.glsl", text, taken, &error));
    if (strncmp(error.message, wanted, strlen(wanted)) != 0) fail_msg("%s: %s", text, error.message);
    assert_int_equal(names.count, 0);
    assert_null(names.names);
}

static void what_reaches_beyond_the_text_is_refused_with_its_line(void **state)
{
    assert_refused("\n#version 450\n", "a.glsl:2: #version");
    assert_refused("float a; /* */\n  #  extension all : enable", "a.glsl:2: #extension");
    assert_refused("#include \"b.glsl\"", "a.glsl:1: #include");
    assert_refused("\n\n#line 7", "a.glsl:3: #line");
    assert_refused("#pragma optimize(off)", "a.glsl:1: #pragma");
    assert_refused("uniform float u;", "a.glsl:1: \"uniform\"");
    assert_refused("float a;\nin vec3 p;", "a.glsl:2: \"in\"");
    assert_refused("out vec4 p;", "a.glsl:1: \"out\"");
    assert_refused("layout(location = 0) out vec4 p;", "a.glsl:1: \"layout\"");
    assert_refused("buffer B { float b[]; };", "a.glsl:1: \"buffer\"");
    assert_refused("shared float s;", "a.glsl:1: \"shared\"");
    assert_refused("float f() {\n    return gl_FragCoord.x;\n}", "a.glsl:2: gl_FragCoord");
    assert_refused("#define WHERE gl_FragCoord.xy", "a.glsl:1: gl_FragCoord");
    assert_refused("#if 0\n#else\n#version 450\n#endif", "a.glsl:3: #version");
    assert_refused("float f() { discard; }", "a.glsl:1: \"discard\"");
    assert_refused("float a__b;", "a.glsl:1: a__b");
    assert_refused("#define Spectrum vec4", "a.glsl:1: the name Spectrum");
    assert_refused("float f(float Spectrum) { return Spectrum; }", "a.glsl:1: the name Spectrum");
    assert_refused("#undef Spectrum", "a.glsl:1: the name Spectrum");
}

static void what_is_not_closed_is_refused_where_it_opens(void **state)
{
    assert_refused("float a;\n/* no end\n\n", "a.glsl:1: a comment has no end");
    assert_refused("float f()\n{\n    if (true) {\n    return 1.0;\n}\n", "a.glsl:2: a \"{\"");
    assert_refused("float f() { return (1.0; }", "a.glsl:1: a \"}\" without");
    assert_refused("float f() { return 1.0; }\n}", "a.glsl:2: a \"}\" without");
    assert_refused("\n#if 1\nfloat a;", "a.glsl:2: an #if without #endif");
    assert_refused("#endif", "a.glsl:1: #endif without #if");
    assert_refused("#else", "a.glsl:1: #else without #if");
}

static void only_comments_hold_more_than_ascii(void **state)
{
    assert_names("// gr\xc3\xb6\xc3\x9f"
                 "er \xcf\x80\n/* \xc2\xa0 */ float a;",
                 "a:2");
    assert_refused("float a;\nfloat\xc2\xa0"
                   "b;",
                   "a.glsl:2: expected ASCII outside of comments, got the character U+00A0");
    assert_refused("\xef\xbb\xbf"
                   "float a;",
                   "a.glsl:1: expected ASCII outside of comments, got the character U+FEFF");
    assert_refused("float f() { return \xf0\x9f\x98\x80; }",
                   "a.glsl:1: expected ASCII outside of comments, got the character U+1F600");
    assert_refused("#define A \xcf\x80", "a.glsl:1: expected ASCII outside of comments, got the character U+03C0");
    assert_refused("\xcf", "a.glsl:1: expected ASCII");
}

static char *format(const struct glsl_names *names, bool is_hide)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);

    if (is_hide)
        glsl_names_write_hide(names, out);
    else
        glsl_names_write_private(names, "medium_0_own", out);
    fclose(out);
    return text;
}

static void names_become_private_and_are_hidden_again(void **state)
{
    struct glsl_names names;
    char *text;

    read_names(&names, "#define A 1\nfloat A, b, _c;\nfloat f(float x);\nfloat f(float x) { return x; }\n#define A 1");
    text = format(&names, false);
    assert_string_equal(text, "#define b medium_0_own_b\n#define _c medium_0_own_x_c\n#define f medium_0_own_f\n");
    free(text);
    text = format(&names, true);
    assert_string_equal(text, "#undef A\n#undef b\n#undef _c\n#undef f\n");
    free(text);
    glsl_names_finish(&names);
}

static void a_text_of_endless_names_is_refused(void **state)
{
    char *text = xstrdup("float a0");
    struct glsl_names names;
    struct error error = {{0}};

    for (int i = 1; i < 12; i++) {
        char *longer = xasprintf("%s, %s", text, text + strlen("float "));

        free(text);
        text = longer;
    }
    assert_false(glsl_names_read(&names, "a.glsl", text, taken, &error));
    assert_non_null(strstr(error.message, "names"));
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_outside_of_functions_are_found),
        cmocka_unit_test(comments_and_continued_lines_hide_nothing),
        cmocka_unit_test(branches_of_a_condition_are_all_read),
        cmocka_unit_test(what_reaches_beyond_the_text_is_refused_with_its_line),
        cmocka_unit_test(what_is_not_closed_is_refused_where_it_opens),
        cmocka_unit_test(only_comments_hold_more_than_ascii),
        cmocka_unit_test(names_become_private_and_are_hidden_again),
        cmocka_unit_test(a_text_of_endless_names_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
