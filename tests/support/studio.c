// SPDX-License-Identifier: Apache-2.0
#include "tests/support/studio.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { VALUES = 8 }; // of a pixel: two colours, alpha and depth

static enum gl_backend wanted = GL_BACKEND_SOFTWARE;
static struct gl_stage stage;

int studio_close(void **state)
{
    (void)state;
    gl_stage_close(stage);
    stage = (struct gl_stage){0};
    return 0;
}

void studio_use(enum gl_backend backend)
{
    if (stage.context && backend == wanted) return;
    studio_close(NULL);
    wanted = backend;
    stage = gl_stage_open(backend, test_shader_dir());
}

static struct vec3 up_of(const struct studio_camera *camera)
{
    return vec3_length(camera->up) > 0.0 ? camera->up : (struct vec3){0.0, 1.0, 0.0};
}

static void write_camera(FILE *out, const struct studio_scene *scene)
{
    const struct studio_camera *camera = &scene->camera;
    struct vec3 up = up_of(camera);

    fputs("\"camera\": {", out);
    if (scene->moving_camera)
        fputs(scene->moving_camera, out);
    else
        fprintf(out, "\"position\": [%.17g, %.17g, %.17g], \"target\": [%.17g, %.17g, %.17g]", camera->position.x,
                camera->position.y, camera->position.z, camera->target.x, camera->target.y, camera->target.z);
    fprintf(out, ", \"up\": [%.17g, %.17g, %.17g], \"fov\": %.17g", up.x, up.y, up.z, camera->fov);
    if (camera->far > 0.0) fprintf(out, ", \"clip\": [%.17g, %.17g]", camera->near, camera->far);
    fputs("}", out);
}

static void write_scene(FILE *out, const struct studio_scene *scene)
{
    fprintf(
        out,
        "{\"version\": 1, \"name\": \"studio\", \"frames\": \"%s\", \"fps\": 24, \"resolution\": [%d, %d],"
        " \"output\": {\"path\": \"studio.####.exr\", \"pixel\": \"float\", \"aovs\": [\"Z\", \"transmittance\"]}, ",
        scene->frames ? scene->frames : "0", scene->width_px, scene->height_px);
    write_camera(out, scene);
    if (scene->background) fprintf(out, ", \"background\": %s", scene->background);
    fprintf(out, ", \"lights\": [%s], \"scene\": {\"media\": [%s], \"objects\": [%s]}, \"quality\": {%s}}",
            scene->lights ? scene->lights : "", scene->media ? scene->media : "", scene->objects ? scene->objects : "",
            scene->quality ? scene->quality : "\"method\": \"equiangular\", \"points\": 16");
}

void studio_parse(struct job *job, const struct studio_scene *scene)
{
    struct error error = {{0}};
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);

    write_scene(out, scene);
    fclose(out);
    if (!job_parse(job, text, length, NULL, &error)) {
        print_error("%s\n", text);
        free(text);
        fail_msg("%s", error.message);
    }
    free(text);
}

void studio_render(const struct job *job, int32_t frame, struct studio_picture *picture)
{
    struct error error = {{0}};

    studio_use(wanted);
    *picture = (struct studio_picture){0};
    if (!image_init(&picture->image, job->width_px, job->height_px, true, true, &error) ||
        !renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = &picture->image},
                         &picture->result, &error) ||
        !image_is_finite(&picture->image, false, &error)) {
        fail_msg("frame %d: %s", (int)frame, error.message);
    }
}

void studio_shoot(const struct studio_scene *scene, struct studio_picture *picture)
{
    struct job job = {0};

    studio_parse(&job, scene);
    studio_render(&job, 0, picture);
    job_finish(&job);
}

void studio_finish(struct studio_picture *picture)
{
    image_finish(&picture->image);
}

struct ray studio_ray(const struct studio_scene *scene, int x_px, int y_px)
{
    const struct studio_camera *camera = &scene->camera;
    struct vec3 forward = vec3_normalize(vec3_subtract(camera->target, camera->position));
    struct vec3 right = vec3_normalize(vec3_cross(forward, up_of(camera)));
    struct vec3 up = vec3_cross(right, forward);
    double half_height = tan(camera->fov * acos(-1.0) / 360.0);
    double x = half_height * (2.0 * x_px + 1.0 - scene->width_px) / scene->height_px;
    double y = half_height * (1.0 - (2.0 * y_px + 1.0) / scene->height_px);
    struct vec3 across = vec3_add(vec3_scale(right, x), vec3_scale(up, y));

    return (struct ray){camera->position, vec3_normalize(vec3_add(forward, across))};
}

void studio_set_color(double color[3], double value)
{
    color[0] = color[1] = color[2] = value;
}

static void flatten(const struct studio_light *light, double values[static VALUES])
{
    memcpy(values, light->radiance, sizeof light->radiance);
    memcpy(values + 3, light->transmittance, sizeof light->transmittance);
    values[6] = light->alpha;
    values[7] = light->depth;
}

static void look(const struct image *image, size_t pixel, double values[static VALUES])
{
    for (size_t c = 0; c < 3; ++c) {
        values[c] = image->rgba[4 * pixel + c];
        values[3 + c] = image->transmittance[4 * pixel + c];
    }
    values[6] = image->rgba[4 * pixel + 3];
    values[7] = image->depth[pixel];
}

// False when nothing is known of the pixel; `wrong` counts what is too far off.
static bool judge(const double known[static VALUES], const double seen[static VALUES], double tolerance, int *wrong)
{
    bool is_known = false;

    for (int i = 0; i < VALUES; ++i) {
        if (isnan(known[i])) continue;
        is_known = true;
        if (!(fabs(seen[i] - known[i]) <= tolerance * fmax(1.0, fabs(known[i])))) ++*wrong;
    }
    return is_known;
}

static void tell(int x_px, int y_px, const double known[static VALUES], const double seen[static VALUES])
{
    static const char *const names[VALUES] = {"R", "G", "B", "transmittance R", "trans G", "trans B", "alpha", "Z"};

    for (int i = 0; i < VALUES; ++i)
        if (!isnan(known[i]))
            print_error("pixel (%d, %d): %s is %.9g, should be %.9g (%+.2g)\n", x_px, y_px, names[i], seen[i], known[i],
                        seen[i] - known[i]);
}

void studio_expect(const struct studio_scene *scene, const struct studio_picture *picture, studio_truth *truth,
                   const void *user, double tolerance, double share)
{
    int count = scene->width_px * scene->height_px, known_count = 0, wrong_count = 0;

    for (int i = 0; i < count; ++i) {
        int x_px = i % scene->width_px, y_px = i / scene->width_px, wrong = 0;
        struct ray ray = studio_ray(scene, x_px, y_px);
        struct studio_light light = {{NAN, NAN, NAN}, {NAN, NAN, NAN}, NAN, NAN};
        double known[VALUES], seen[VALUES];

        truth(&ray, &light, user);
        flatten(&light, known);
        look(&picture->image, (size_t)i, seen);
        if (judge(known, seen, tolerance, &wrong)) ++known_count;
        if (wrong > 0 && ++wrong_count <= 3) tell(x_px, y_px, known, seen);
    }
    if (wrong_count > 0) fail_msg("%d of %d pixels are wrong", wrong_count, known_count);
    if (known_count < share * count) fail_msg("only %d of %d pixels are judged", known_count, count);
}

void studio_check(const struct studio_scene *scene, studio_truth *truth, const void *user, double tolerance,
                  double share)
{
    struct studio_picture picture;

    studio_shoot(scene, &picture);
    studio_expect(scene, &picture, truth, user, tolerance, share);
    studio_finish(&picture);
}
