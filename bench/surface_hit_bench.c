// Two methods that find the first surface along a ray, timed against each other.
// SPDX-License-Identifier: Apache-2.0
// One uses spans in closed form, the other marches a distance field with a bound on its steps. The scene is that of the
// examples: a ball and a box over a floor.
#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/gl/gl_context.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"
#include "worker/glsl/shader_sources.h"
#include "worker/picture/image.h"
#include "worker/render/gl_target.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 1920, HEIGHT = 1080, RUNS = 5, ROUNDS = 4 };

static const char VERTEX[] = "fullscreen.vert";

static const char SCENE[] = "const vec3 EYE = vec3(0.0, 0.6, 4.0);\n"
                            "vec3 view(vec2 p)\n"
                            "{\n"
                            "    return normalize(vec3((p - vec2(960.0, 540.0)) * vec2(1.0, -1.0) / 1080.0, -1.0));\n"
                            "}\n";

// Each ray is traced several times from points a little apart, as reflections and shadows would be: one draw is too
// short.
static const char MAIN[] = "layout(location = 0) out vec4 rgba;\n"
                           "void main()\n"
                           "{\n"
                           "    float sum = 0.0;\n"
                           "    for (int i = 0; i < ROUNDS; ++i) {\n"
                           "        float at = hit(EYE + vec3(0.0, 0.0, 1e-3 * float(i)), view(gl_FragCoord.xy));\n"
                           "        if (i == 0) rgba = vec4(at);\n"
                           "        sum += at;\n"
                           "    }\n"
                           "    rgba.y = sum;\n"
                           "}\n";

static const char CLOSED[] =
    "float hit(vec3 origin, vec3 direction)\n"
    "{\n"
    "    vec2 ball = region_sphere_span(RegionSphere(vec3(0.0), 1.0), origin, direction);\n"
    "    vec2 box = region_box_span(RegionBox(vec3(2.2, -0.7, -1.0), vec3(0.5)), origin, direction);\n"
    "    float along = direction.y;\n"
    "    float ground = along < 0.0 ? -(origin.y + 1.2) / along : FAR_AWAY;\n"
    "    return min(min(ball.x > 0.0 ? ball.x : FAR_AWAY, box.x > 0.0 ? box.x : FAR_AWAY), ground);\n"
    "}\n";

static const char MARCHED[] = "float field(vec3 p)\n"
                              "{\n"
                              "    vec3 q = abs(p - vec3(2.2, -0.7, -1.0)) - 0.5;\n"
                              "    float box = length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);\n"
                              "    return min(min(length(p) - 1.0, box), p.y + 1.2);\n"
                              "}\n"
                              "float hit(vec3 origin, vec3 direction)\n"
                              "{\n"
                              "    float at = 0.0;\n"
                              "    for (int i = 0; i < STEPS && at < 1000.0; ++i) {\n"
                              "        float clear = field(origin + at * direction);\n"
                              "        if (clear < NEAR) return at;\n"
                              "        at += clear;\n"
                              "    }\n"
                              "    return FAR_AWAY;\n"
                              "}\n";

struct method {
    const char *name, *hit;
    int steps;
    double near;
};

static const struct method methods[] = {{"spans in closed form", CLOSED, 0, 0.0},
                                        {"field, 64 steps, 1e-3 m", MARCHED, 64, 1e-3},
                                        {"field, 128 steps, 1e-4 m", MARCHED, 128, 1e-4},
                                        {"field, 256 steps, 1e-5 m", MARCHED, 256, 1e-5},
                                        {"field, 1024 steps, 1e-5 m", MARCHED, 1024, 1e-5}};

static double nearest_plane(double from, double to, double position, double direction, double *exit)
{
    double a = (from - position) / direction, b = (to - position) / direction;

    *exit = fmin(*exit, fmax(a, b));
    return fmin(a, b);
}

// Returns the distance in double precision; INFINITY: no hit.
static double true_distance(int x, int y)
{
    const double eye[3] = {0.0, 0.6, 4.0}, low[3] = {1.7, -1.2, -1.5}, high[3] = {2.7, -0.2, -0.5};
    double direction[3] = {(x + 0.5 - 960.0) / 1080.0, (540.0 - y - 0.5) / 1080.0, -1.0};
    double length = hypot(hypot(direction[0], direction[1]), direction[2]), nearest = INFINITY, along = 0.0,
           square = -1.0;
    double entry = -INFINITY, exit = INFINITY;

    for (int i = 0; i < 3; i++) {
        direction[i] /= length;
        along -= eye[i] * direction[i];
        square += eye[i] * eye[i];
        entry = fmax(entry, nearest_plane(low[i], high[i], eye[i], direction[i], &exit));
    }
    if (along * along > square) nearest = along - sqrt(along * along - square);
    if (entry < exit && entry > 0.0) nearest = fmin(nearest, entry);
    if (direction[1] < 0.0) nearest = fmin(nearest, -(eye[1] + 1.2) / direction[1]);
    return nearest;
}

static void append(char **text, const char *part)
{
    size_t length = *text ? strlen(*text) : 0;

    *text = realloc(*text, length + strlen(part) + 1);
    if (!*text) abort();
    strcpy(*text + length, part);
}

static char *fragment_text(const struct method *method)
{
    static const char *const modules[] = {"math/constants.glsl", "region/span.glsl", "region/sphere.glsl",
                                          "region/box.glsl"};
    char *text = NULL, numbers[128];

    append(&text, "#version 450 core\n");
    for (size_t i = 0; i < sizeof modules / sizeof *modules; i++) {
        char *module = shader_sources_load(NULL, modules[i], NULL);

        append(&text, module);
        free(module);
    }
    snprintf(numbers, sizeof numbers, "const int STEPS = %d;\nconst float NEAR = %.9e;\nconst int ROUNDS = %d;\n",
             method->steps, method->near, ROUNDS);
    append(&text, numbers);
    append(&text, SCENE);
    append(&text, method->hit);
    append(&text, MAIN);
    return text;
}

static int compare(const void *a, const void *b)
{
    const double *left = a, *right = b;

    return (*left > *right) - (*left < *right);
}

static double draw(const struct gl_functions *gl, const struct gl_target *target, unsigned program, struct image *image)
{
    double seconds[RUNS];

    gl_target_begin(target);
    gl->UseProgram(program);
    for (int i = 0; i < RUNS; i++) {
        double start = clock_now_s();

        gl->DrawArrays(GL_TRIANGLES, 0, 3);
        gl->Finish();
        seconds[i] = clock_now_s() - start;
    }
    gl_target_read(target, NULL, image, NULL);
    qsort(seconds, RUNS, sizeof *seconds, compare);
    return seconds[RUNS / 2];
}

static void print_method(const struct method *method, const struct image *image, double seconds)
{
    double largest = 0.0;
    long wrong = 0;

    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            double truth = true_distance(x, y), at = image->rgba[4 * ((size_t)y * WIDTH + (size_t)x)];
            double error = fabs(at - truth) / truth;

            if (truth > 1000.0) continue; // the horizon, which no march reaches
            if (error > 1e-2)
                ++wrong;
            else
                largest = fmax(largest, error);
        }
    printf("%-28s %14.1f %18.4f %22.1e\n", method->name, 1e-6 * WIDTH * HEIGHT * ROUNDS / seconds,
           100.0 * (double)wrong / (WIDTH * HEIGHT), largest);
}

static bool measure(const struct gl_functions *gl, const struct gl_target *target, struct image *image,
                    const struct method *method, struct error *error)
{
    char *vertex = shader_sources_load(NULL, VERTEX, error), *fragment = fragment_text(method);
    unsigned program =
        !vertex ? 0 : gl_program_create(gl, &(struct gl_program_params){.vertex = vertex, .fragment = fragment}, error);

    if (program) {
        print_method(method, image, draw(gl, target, program, image));
        gl->DeleteProgram(program);
    }
    free(vertex);
    free(fragment);
    return program != 0;
}

int main(void)
{
    struct error error = {0};
    struct gl_context *context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
    struct gl_functions gl;
    struct gl_target target = {0};
    struct image image = {0};
    unsigned vertex_array = 0;
    bool ok = context && gl_functions_load(&gl, context, &error) &&
              image_init(&image, WIDTH, HEIGHT, false, false, &error) &&
              gl_target_init(&target, &gl, &(struct gl_target_params){.image = &image, .pass_count = 1}, &error);

    if (ok) {
        gl.CreateVertexArrays(1, &vertex_array);
        gl.BindVertexArray(vertex_array);
        printf("%-28s %14s %18s %22s\n", "method", "million rays/s", "wrong pixels in %", "largest other error");
    }
    for (size_t i = 0; ok && i < sizeof methods / sizeof *methods; i++)
        ok = measure(&gl, &target, &image, &methods[i], &error);
    if (!ok) printf("%s\n", error.message);
    if (vertex_array) gl.DeleteVertexArrays(1, &vertex_array);
    gl_target_finish(&target);
    image_finish(&image);
    if (context) gl_context_destroy(context);
    return !ok;
}
