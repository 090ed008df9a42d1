// Guards stand around the first returns and assignments of functions, and leave lines and all else alone.
// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/glsl_guard.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int count_lines(const char *text)
{
    int lines = 0;

    for (; *text; text++)
        lines += *text == '\n';
    return lines;
}

static void assert_guarded(const char *source, int wanted, bool is_returns_only, const char *expected, int count,
                           int line)
{
    struct glsl_guarded guarded = glsl_guard(source, wanted, is_returns_only);
    size_t length = strlen(guarded.text);

    assert_true(length >= strlen(expected));
    assert_string_equal(guarded.text + length - strlen(expected), expected);
    assert_int_equal(count_lines(guarded.text), count_lines(source));
    assert_int_equal(guarded.count, count);
    assert_int_equal(guarded.line, line);
    free(guarded.text);
}

static const char code[] = "const float A = 1.0;\n"
                           "#define B(x) (x = 2.0)\n"
                           "float density(vec3 p, float t)\n{\n"
                           "    float a = p.x, b = max(p.y, 0.0);\n"
                           "    float c[2] = {1.0, 2.0};\n"
                           "    for (int i = 0; i <= 3; ++i) a += b;\n"
                           "    if (a == b) return 0.0;\n"
                           "    return a /\n b;\n}\n";

static void the_first_statements_are_guarded(void **state)
{
    (void)state;
    assert_guarded(code, 0, false, code, 5, 0);
    assert_guarded(code, 2, false,
                   "    float a = guarded_value( p.x), b = guarded_value( max(p.y, 0.0));\n"
                   "    float c[2] = {1.0, 2.0};\n"
                   "    for (int i = 0; i <= 3; ++i) a += b;\n"
                   "    if (a == b) return 0.0;\n"
                   "    return a /\n b;\n}\n",
                   5, 5);
    assert_guarded(code, 9, false,
                   "    for (int i = 0; i <= 3; ++i) a += guarded_value( b);\n"
                   "    if (a == b) return guarded_value( 0.0);\n"
                   "    return guarded_value( a /\n b);\n}\n",
                   5, 9);
}

static void returns_alone_can_be_guarded(void **state)
{
    (void)state;
    assert_guarded(code, 2, true,
                   "{1.0, 2.0};\n    for (int i = 0; i <= 3; ++i) a += b;\n"
                   "    if (a == b) return guarded_value( 0.0);\n"
                   "    return guarded_value( a /\n b);\n}\n",
                   2, 9);
    assert_guarded("void f() { return; }\nfloat g() { return 1.0; }", 1, true,
                   "void f() { return; }\nfloat g() { return guarded_value( 1.0); }", 1, 2);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_statements_are_guarded),
        cmocka_unit_test(returns_alone_can_be_guarded),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
