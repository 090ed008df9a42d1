// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_context.h"

#include "core/base/error.h"
#include "worker/gl/gl_debug.h"
#include "worker/gl/gl_functions.h"
#include "worker/picture/image.h"
#include "worker/render/gl_target.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct gl_context *create_or_skip(enum gl_backend backend)
{
    struct error error = {{0}};
    struct gl_context *context = gl_context_create(backend, NULL, &error);

    if (!context) {
        print_message("skipped: %s\n", error.message);
        skip();
    }
    return context;
}

// Clears a float target to a colour that bytes cannot hold and reads it back.
static void assert_renders_floats(struct gl_context *context)
{
    static const float colour[] = {1234.5f, -0.25f, 1e-20f, 3e30f};
    struct gl_functions gl;
    struct gl_target target = {0};
    struct image image;

    assert_true(gl_functions_load(&gl, context, NULL));
    assert_true(image_init(&image, 7, 5, true, false, NULL));
    assert_true(gl_target_init(&target, &gl, &(struct gl_target_params){.image = &image, .pass_count = 1}, NULL));
    gl.ClearNamedFramebufferfv(target.framebuffer, GL_COLOR, 0, colour);
    gl_target_read(&target, NULL, &image, NULL);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
    for (int i = 0; i < 7 * 5; ++i)
        assert_memory_equal(&image.rgba[4 * i], colour, sizeof colour);
    gl_target_finish(&target);
    image_finish(&image);
}

static void check_backend(enum gl_backend backend, const char *name)
{
    struct gl_context *context = create_or_skip(backend);
    const struct gl_context_facts *facts = gl_context_facts(context);

    assert_string_equal(facts->backend, name);
    assert_true(facts->vendor[0] && facts->renderer[0]);
    assert_non_null(strstr(facts->version, "4.5"));
    assert_renders_floats(context);
    gl_context_destroy(context);
}

static void osmesa_renders_floats(void **state)
{
    check_backend(GL_BACKEND_OSMESA, "osmesa");
}

static void egl_renders_floats(void **state)
{
    check_backend(GL_BACKEND_EGL, "egl");
}

static void contexts_follow_one_another(void **state)
{
    for (int i = 0; i < 2; ++i) {
        check_backend(GL_BACKEND_EGL, "egl");
        check_backend(GL_BACKEND_OSMESA, "osmesa");
    }
}

static void auto_takes_egl_only_before_osmesa_when_it_is_hardware(void **state)
{
    struct gl_context *context = create_or_skip(GL_BACKEND_AUTO);
    const struct gl_context_facts *facts = gl_context_facts(context);

    if (strcmp(facts->backend, "osmesa") == 0)
        assert_true(facts->is_software);
    else if (facts->is_software)
        assert_null(gl_context_create(GL_BACKEND_OSMESA, NULL, NULL));
    gl_context_destroy(context);
}

static void software_is_egl_only_without_osmesa(void **state)
{
    struct gl_context *osmesa = gl_context_create(GL_BACKEND_OSMESA, NULL, NULL), *context;
    bool has_osmesa = osmesa != NULL;

    gl_context_destroy(osmesa);
    context = create_or_skip(GL_BACKEND_SOFTWARE);
    assert_true(gl_context_facts(context)->is_software);
    assert_string_equal(gl_context_facts(context)->backend, has_osmesa ? "osmesa" : "egl");
    gl_context_destroy(context);
}

static void a_device_is_picked_by_index(void **state)
{
    struct gl_context *context = gl_context_create(GL_BACKEND_EGL, "0", NULL);

    if (!context) skip();
    assert_renders_floats(context);
    gl_context_destroy(context);
}

// Where there is no GPU, or none that this process may use, workers render in software whatever their turn.
static void a_turn_keeps_nobody_from_a_context(void **state)
{
    struct gl_context *context;

    gl_context_destroy(create_or_skip(GL_BACKEND_EGL));
    context = gl_context_create(GL_BACKEND_EGL, "turn:5", NULL);
    assert_non_null(context);
    gl_context_destroy(context);
    assert_int_equal(setenv("CUDA_VISIBLE_DEVICES", "NoDevFiles", 1), 0);
    context = gl_context_create(GL_BACKEND_AUTO, "turn:0", NULL);
    assert_non_null(context);
    assert_true(gl_context_facts(context)->is_software);
    gl_context_destroy(context);
    assert_int_equal(unsetenv("CUDA_VISIBLE_DEVICES"), 0);
}

static void a_device_is_picked_by_the_uuid_it_reports(void **state)
{
    struct gl_context *context = create_or_skip(GL_BACKEND_EGL);
    char uuid[40];

    strcpy(uuid, gl_context_facts(context)->device_uuid);
    gl_context_destroy(context);
    if (!uuid[0]) {
        print_message("skipped: the device has no UUID\n");
        skip();
    }
    assert_int_equal(strlen(uuid), 36);
    context = gl_context_create(GL_BACKEND_EGL, uuid, NULL);
    assert_non_null(context);
    assert_string_equal(gl_context_facts(context)->device_uuid, uuid);
    gl_context_destroy(context);
}

static void an_unknown_device_is_named_with_what_was_tried(void **state)
{
    struct error error = {{0}};

    assert_null(gl_context_create(GL_BACKEND_EGL, "00000000-1111-2222-3333-444444444444", &error));
    assert_non_null(strstr(error.message, "00000000-1111-2222-3333-444444444444"));
    assert_non_null(strstr(error.message, "egl"));
    assert_null(gl_context_create(GL_BACKEND_EGL, "63", &error));
    assert_non_null(strstr(error.message, "\"63\""));
}

static void osmesa_has_no_devices(void **state)
{
    struct error error = {{0}};

    assert_null(gl_context_create(GL_BACKEND_OSMESA, "0", &error));
    assert_non_null(strstr(error.message, "osmesa: expected no device"));
}

static void a_wrong_call_is_collected_once(void **state)
{
    struct gl_context *context = create_or_skip(GL_BACKEND_SOFTWARE);
    struct error error = {{0}};
    struct gl_functions gl;
    struct gl_debug debug;

    assert_true(gl_functions_load(&gl, context, NULL));
    gl_debug_init(&debug, &gl);
    assert_int_equal(gl_debug_check(&debug, &error), GL_DEBUG_FINE);
    gl.Enable(0xdead);
    assert_int_equal(gl_debug_check(&debug, &error), GL_DEBUG_ERROR);
    assert_non_null(strstr(error.message, "GL error 0x0500"));
    assert_int_equal(gl_debug_check(&debug, &error), GL_DEBUG_FINE);
    gl_debug_finish(&debug);
    gl_context_destroy(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(osmesa_renders_floats),
        cmocka_unit_test(egl_renders_floats),
        cmocka_unit_test(contexts_follow_one_another),
        cmocka_unit_test(auto_takes_egl_only_before_osmesa_when_it_is_hardware),
        cmocka_unit_test(software_is_egl_only_without_osmesa),
        cmocka_unit_test(a_device_is_picked_by_index),
        cmocka_unit_test(a_turn_keeps_nobody_from_a_context),
        cmocka_unit_test(a_device_is_picked_by_the_uuid_it_reports),
        cmocka_unit_test(an_unknown_device_is_named_with_what_was_tried),
        cmocka_unit_test(osmesa_has_no_devices),
        cmocka_unit_test(a_wrong_call_is_collected_once),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
