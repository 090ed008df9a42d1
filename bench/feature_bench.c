// The cost of the features of a scene, one after the other: feature_bench IMAGE. Medians of several frames of 960x540.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/scene/scene_inputs.h"
#include "worker/scene/scene_visibility.h"
#include "worker/shader/scene_program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 960, HEIGHT = 540, RUNS = 5 };

// The lamp moves a little from frame to frame, so that each is rendered.
#define LAMP                                                                                                           \
    "{\"kind\": \"point\", \"intensity\": 40, \"position\": {\"start\": [1.5, 2.5, 1], \"rate\": [0.01, 0, 0]}}"
#define BALL(material) "{\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1, \"material\": {" material "}}"
#define FLOOR(material)                                                                                                \
    "{\"kind\": \"plane\", \"point\": [0, -1.2, 0], \"material\": {\"kind\": \"diffuse\", " material "}}"
#define GREY FLOOR("\"albedo\": 0.6")
#define TILED FLOOR("\"texture\": {\"file\": \"%s\", \"size\": 2}")
#define GLASS "\"kind\": \"dielectric\", \"ior\": 1.5"
#define RED "\"sigma_a\": [0.1, 0.8, 1.2]"
#define MARCH "\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.1"
#define POINTS "\"method\": \"equiangular\", \"points\": 8"
#define FOG                                                                                                            \
    "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"radius\": 6}}, \"sigma_s\": 0.05}"
#define SMOKE                                                                                                          \
    "\"interior\": {\"density\": {\"kind\": \"noise\", \"frequency\": 2, \"octaves\": 3, \"mode\": \"clip\", "         \
    "\"scale\": 4,"                                                                                                    \
    " \"bounds\": {\"kind\": \"sphere\", \"radius\": 1}}, \"sigma_s\": 1}"

#define HOT "\"bounds\": {\"kind\": \"sphere\", \"radius\": 1}}"
#define EVEN(coefficients) "{\"density\": {\"kind\": \"homogeneous\", " HOT ", " coefficients "}"
#define NOISE "\"kind\": \"noise\", \"frequency\": 2, \"octaves\": 3, \"mode\": \"clip\", \"scale\": 4, "
#define CLOUD(coefficients) "{\"density\": {" NOISE HOT ", " coefficients "}"
#define SOFT                                                                                                           \
    "{\"density\": {" NOISE "\"bounds\": {\"kind\": \"sphere\", \"radius\": 1, \"falloff\": 0.2}}, \"sigma_s\": 1}"
#define ASIDE                                                                                                          \
    "{\"density\": {" NOISE                                                                                            \
    "\"bounds\": {\"kind\": \"sphere\", \"center\": [9, -9, 0], \"radius\": 1}}, \"sigma_a\": 1}"
#define SECOND                                                                                                         \
    "{\"density\": {" NOISE                                                                                            \
    "\"bounds\": {\"kind\": \"sphere\", \"center\": [0.8, 0, 0], \"radius\": 0.7}}, \"sigma_s\": 1}"
#define OTHER_LAMP                                                                                                     \
    "{\"kind\": \"point\", \"intensity\": 20, \"position\": {\"start\": [-2, 1, 2], \"rate\": [0.01, 0, 0]}}"
#define DARK_LAMP "{\"kind\": \"point\", \"intensity\": 0, \"position\": [0, 3, 0]}"
#define LOBES "\"phase\": [{\"g\": 0.6, \"weight\": 0.7}, {\"g\": -0.2, \"weight\": 0.3}, {\"g\": 0.9, \"weight\": 0}]"

struct feature {
    const char *name, *lights, *media, *objects, *quality;
};

static const struct feature features[] = {
    {"even ball that absorbs", "", EVEN("\"sigma_a\": 1"), "", POINTS},
    {"and glows", "", EVEN("\"sigma_a\": 1, \"emission\": {\"start\": 1, \"rate\": 0.01}"), "", POINTS},
    {"and scatters a lamp's light", LAMP, EVEN("\"sigma_s\": 1"), "", POINTS},
    {"two lamps", LAMP ", " OTHER_LAMP, EVEN("\"sigma_s\": 1"), "", POINTS},
    {"noise that glows", "", CLOUD("\"sigma_a\": 1, \"emission\": {\"start\": 1, \"rate\": 0.01}"), "", MARCH},
    {"and scatters a lamp's light", LAMP, CLOUD("\"sigma_s\": 1"), "", MARCH},
    {"two lobes, a third of weight 0", LAMP, CLOUD("\"sigma_s\": 1, " LOBES), "", MARCH},
    {"three colours", LAMP, CLOUD("\"sigma_s\": [1, 0.9, 0.8], " LOBES), "", MARCH},
    {"two lamps, a third one dark", LAMP ", " OTHER_LAMP ", " DARK_LAMP, CLOUD("\"sigma_s\": 1"), "", MARCH},
    {"a soft edge", LAMP, SOFT, "", MARCH},
    {"a second medium", LAMP, CLOUD("\"sigma_s\": 1") ", " SECOND, "", MARCH},
    {"the second out of the view", LAMP, CLOUD("\"sigma_s\": 1") ", " ASIDE, "", MARCH},
    {"roulette", LAMP, CLOUD("\"sigma_s\": 1"), "", MARCH ", \"roulette\": {\"below\": 0.1, \"survive\": 0.5}"},
    {"four samples a pixel", LAMP, CLOUD("\"sigma_s\": 1"), "", MARCH ", \"samples\": 4"},
    {"floor, nothing shines on it", "", "", GREY, POINTS},
    {"and a lamp", LAMP, "", GREY, POINTS},
    {"and its image", LAMP, "", TILED, POINTS},
    {"and a diffuse ball", LAMP, "", TILED ", " BALL("\"kind\": \"diffuse\", \"albedo\": 0.5"), POINTS},
    {"ball with a specular share", LAMP, "", TILED ", " BALL("\"kind\": \"diffuse\", \"albedo\": 0.5, \"specular\": 1"),
     POINTS},
    {"ball a mirror", LAMP, "", TILED ", " BALL("\"kind\": \"mirror\""), POINTS},
    {"rough mirror", LAMP, "", TILED ", " BALL("\"kind\": \"mirror\", \"roughness\": 0.1"), POINTS},
    {"ball of glass, fresnel none", LAMP, "", TILED ", " BALL(GLASS ", \"fresnel\": \"none\""), POINTS},
    {"schlick", LAMP, "", TILED ", " BALL(GLASS ", \"fresnel\": \"schlick\""), POINTS},
    {"exact", LAMP, "", TILED ", " BALL(GLASS), POINTS},
    {"absorbing glass", LAMP, "", TILED ", " BALL(GLASS ", \"interior\": {" RED "}"), POINTS},
    {"rough absorbing glass", LAMP, "", TILED ", " BALL(GLASS ", \"roughness\": 0.1, \"interior\": {" RED "}"), POINTS},
    {"absorbing glass in fog", LAMP, FOG, TILED ", " BALL(GLASS ", \"interior\": {" RED "}"), POINTS},
    {"smoke in glass", LAMP, "", TILED ", " BALL(GLASS ", " SMOKE), MARCH},
    {"the same smoke, no glass", LAMP,
     "{"
     "\"density\": {\"kind\": \"noise\", \"frequency\": 2, \"octaves\": 3, \"mode\": \"clip\", \"scale\": 4,"
     " \"bounds\": {\"kind\": \"sphere\", \"radius\": 1}}, \"sigma_s\": 1}",
     "", MARCH},
};

static char *job_text(const struct feature *feature, const char *image)
{
    const char *mark = strstr(feature->objects, "%s");
    char *objects = !mark ? xstrdup(feature->objects)
                          : xasprintf("%.*s%s%s", (int)(mark - feature->objects), feature->objects, image, mark + 2);
    char *text =
        xasprintf("{\"version\": 1, \"name\": \"surface\", \"frames\": \"0-9\", \"fps\": 24, \"resolution\": [%d, %d],"
                  " \"camera\": {\"position\": [0, 0.6, 4], \"target\": [0, -0.3, 0], \"fov\": 45},"
                  " \"background\": [0.3, 0.4, 0.5], \"lights\": [%s], \"scene\": {\"media\": [%s]%s%s%s},"
                  " \"quality\": {%s}, \"output\": {\"path\": \"surface.####.exr\"}}",
                  WIDTH, HEIGHT, feature->lights, feature->media, objects[0] ? ", \"objects\": [" : "", objects,
                  objects[0] ? "]" : "", feature->quality);

    free(objects);
    return text;
}

static int compare(const void *a, const void *b)
{
    const double *left = a, *right = b;

    return (*left > *right) - (*left < *right);
}

// Returns the KiB of the first frame's fragment shader; 0 when there is none.
static double text_kib(const struct job *job)
{
    struct scene_files files;
    struct scene_inputs inputs = {0};
    struct scene_program program = {0};
    double kib = 0.0;

    scene_files_init(&files);
    if (!scene_inputs_open(&inputs, job, 0, &files, NULL, NULL)) goto out;
    scene_visibility_find(job, &inputs, 0, inputs.is_unneeded);
    if (scene_program_init(&program, job, &inputs, NULL, NULL)) kib = (double)strlen(program.fragment) / 1024.0;
out:
    scene_program_finish(&program);
    scene_inputs_finish(&inputs);
    scene_files_finish(&files);
    return kib;
}

static bool measure(struct gl_context *context, const struct feature *feature, const char *path, struct error *error)
{
    char *text = job_text(feature, path);
    struct renderer *renderer = renderer_create(context, NULL);
    struct renderer_result result;
    struct image image = {0};
    struct job job = {0};
    double seconds[RUNS + 1];
    bool ok =
        job_parse(&job, text, strlen(text), NULL, error) && image_init(&image, WIDTH, HEIGHT, false, false, error);

    for (int i = 0; ok && i <= RUNS; i++) { // the first one compiles
        double start = clock_now_s();

        ok = renderer_render(renderer, &(struct renderer_frame){.job = &job, .frame = i, .image = &image}, &result,
                             error);
        seconds[i] = clock_now_s() - start;
    }
    if (ok) {
        qsort(seconds + 1, RUNS, sizeof *seconds, compare);
        printf("%-30s %10.1f %10.1f %10.1f %12.2f %12.1e\n", feature->name, text_kib(&job), 1e3 * seconds[1 + RUNS / 2],
               1e3 * seconds[0], result.ray_counts.is_known ? result.ray_counts.rays : 1.0,
               result.ray_counts.cut_share);
    }
    renderer_destroy(renderer);
    image_finish(&image);
    job_finish(&job);
    free(text);
    return ok;
}

int main(int argc, char *argv[])
{
    struct error error = {0};
    struct gl_context *context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
    char *image = argc > 1 ? realpath(argv[1], NULL) : NULL;
    int failures = !context || !image;

    if (!context) printf("%s\n", error.message);
    if (!image) printf("usage: feature_bench IMAGE\n");
    if (!failures)
        printf("%-30s %10s %10s %10s %12s %12s\n", "scene", "text KiB", "ms", "first ms", "rays a pixel", "cut share");
    for (size_t i = 0; !failures && i < sizeof features / sizeof *features; i++)
        if (!measure(context, &features[i], image, &error)) {
            printf("%-30s %s\n", features[i].name, error.message);
            ++failures;
        }
    if (context) gl_context_destroy(context);
    free(image);
    return failures > 0;
}
