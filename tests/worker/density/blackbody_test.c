// SPDX-License-Identifier: Apache-2.0
#include "worker/density/blackbody.h"

#include "reference/blackbody.h"
#include "tests/support/assert_near.h"
#include "tests/support/shader_probe.h"
#include "worker/gl/gl_functions.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double coldest_kelvin = 400;

// Entries equal the reference's integral, which has other steps, another rule and another matrix to Rec. 709: floats
// and the rule's steps of 1 nm stay below 1e-5 of the luminance.
static void entries_are_the_reference_s_light(void **state)
{
    static float table[BLACKBODY_TABLE_SIZE][4];

    blackbody_fill_table(table);
    for (int i = 1; i < BLACKBODY_TABLE_SIZE - 1; i += 10) {
        double kelvin = coldest_kelvin * (BLACKBODY_TABLE_SIZE - 1) / i, rgb[3], xyz[3];
        double luminance = kelvin * exp2((double)table[i][3]);

        blackbody_rgb(kelvin, rgb);
        blackbody_xyz(kelvin, xyz);
        assert_near(luminance / xyz[1], 1, 1e-5);
        for (int k = 0; k < 3; ++k)
            assert_near(fmax((double)table[i][k], 0), rgb[k] / xyz[1], 1e-5);
    }
}

static void an_infinite_temperature_has_a_finite_entry(void **state)
{
    static float table[BLACKBODY_TABLE_SIZE][4];

    blackbody_fill_table(table);
    for (int k = 0; k < 4; ++k)
        assert_near((double)table[0][k], (double)table[1][k], 0.1);
}

struct row {
    const struct gl_functions *gl;
    unsigned texture;
};

static void bind_row(const struct gl_functions *gl, void *user)
{
    static float table[BLACKBODY_TABLE_SIZE][4];
    struct row *row = user;

    row->gl = gl;
    blackbody_fill_table(table);
    gl->CreateTextures(GL_TEXTURE_2D, 1, &row->texture);
    gl->TextureStorage2D(row->texture, 1, GL_RGBA32F, BLACKBODY_TABLE_SIZE, 1);
    gl->TextureSubImage2D(row->texture, 0, 0, 0, BLACKBODY_TABLE_SIZE, 1, GL_RGBA, GL_FLOAT, table);
    gl->TextureParameteri(row->texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TextureParameteri(row->texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->BindTextureUnit(0, row->texture);
}

static void release_row(void *user)
{
    struct row *row = user;

    row->gl->DeleteTextures(1, &row->texture);
}

// Luminance between the entries is within tolerance too: linear interpolation of 1024 entries is within 1e-4 of it, the
// driver's exp2 within 1e-5.
static void the_shader_s_light_is_the_reference_s(void **state)
{
    static const char *const modules[] = {"emission/blackbody.glsl", NULL};
    enum { COUNT = 1000 };
    static float inputs[COUNT][4], outputs[COUNT][4];
    double before = 0;

    for (int i = 0; i < COUNT; i++)
        inputs[i][0] = (float)(401 * pow(250, i / (COUNT - 1.0)));
    for (int egl = 0; egl < 2; egl++) {
        struct row row;

        shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                       .body = "layout(binding = 0) uniform sampler2D row;\n"
                                                               "vec4 probe(int i)\n{\n    return "
                                                               "vec4(emission_blackbody(row, inputs[i].x), 0.0);\n}\n",
                                                       .inputs = (const float(*)[4])inputs,
                                                       .input_count = COUNT,
                                                       .count = COUNT,
                                                       .on_egl = egl,
                                                       .bind = bind_row,
                                                       .release = release_row,
                                                       .user = &row},
                         outputs);
        before = 0;
        for (int i = 0; i < COUNT; i++) {
            double rgb[3], xyz[3], luminance;

            blackbody_rgb((double)inputs[i][0], rgb);
            blackbody_xyz((double)inputs[i][0], xyz);
            for (int k = 0; k < 3; k++)
                assert_near((double)outputs[i][k] / xyz[1], rgb[k] / xyz[1], 2e-4);
            luminance =
                0.2126 * (double)outputs[i][0] + 0.7152 * (double)outputs[i][1] + 0.0722 * (double)outputs[i][2];
            assert_true(luminance > before);
            before = luminance;
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(entries_are_the_reference_s_light),
        cmocka_unit_test(the_shader_s_light_is_the_reference_s),
        cmocka_unit_test(an_infinite_temperature_has_a_finite_entry),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
