// SPDX-License-Identifier: Apache-2.0
#include "tests/support/schema_agreement.h"

#include "core/base/alloc.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/scene/density_rules.h"
#include "core/scene/light_rules.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"
#include "tests/support/schema_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MEDIUM(density) "{\"media\":[{\"sigma_a\":1,\"density\":" density "}]}"
#define NOISE "{\"kind\":\"noise\",\"frequency\":1}"
#define SLAB                                                                                                           \
    "{\"kind\":\"noise\",\"frequency\":1,\"bounds\":{\"kind\":\"slab\",\"normal\":{\"start\":[0,1,0],\"rate\":[1,0,0]" \
    "},"                                                                                                               \
    "\"thickness\":1}}"
#define GLSL "{\"kind\":\"glsl\",\"source\":\"# version 450\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}"
#define FALLOFF "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1,\"falloff\":0.5}}"

#define FOG "{\"sigma_a\":1,\"density\":{\"kind\":\"homogeneous\"}}"
#define FOGS FOG "," FOG "," FOG "," FOG "," FOG "," FOG "," FOG
#define GLASS                                                                                                          \
    "{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{\"kind\":\"dielectric\",\"ior\":1.5,"          \
    "\"interior\":{\"sigma_a\":1}}}"
#define BALL "{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}"
#define BALLS BALL "," BALL "," BALL "," BALL "," BALL "," BALL
#define UNION "{\"kind\":\"union\",\"of\":[" BALLS "," BALLS "," BALLS "],\"material\":{\"kind\":\"mirror\"}}"

#define DOME "{\"kind\":\"dome\",\"radiance\":1}"
#define SPOT(inner, outer)                                                                                             \
    "{\"kind\":\"spot\",\"intensity\":1,\"position\":[0,3,0],\"direction\":[0,-1,0],\"inner\":" inner                  \
    ",\"outer\":" outer "}"
#define SEVERAL(density) "{\"scattering\":{\"orders\":2},\"media\":[{\"sigma_s\":1,\"density\":" density "}]}"
#define CODE                                                                                                           \
    "{\"kind\":\"glsl\",\"source\":\"float density(vec3 p, float t) { return 1.0; }\",\"bounds\":{\"kind\":"           \
    "\"sphere\",\"radius\":1}}"

const struct cross_rule schema_cross_rules[] = {
    {"a name counts bytes, not characters, and has no U+0080 to U+009F",
     "1 to 128 printable bytes",
     {"name",
      "\"\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9"
      "\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9"
      "\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9"
      "\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\""}},
    {"a comment, likewise", "1 to 1000 printable bytes", {"comment", "\"a\\u0085b\""}},
    {"a tag, likewise", "printable bytes without a comma", {"tags[0]", "\"a\\u0085b\""}},
    {"frames in all", "at most 4000000 frames", {"frames", "\"0-4000000\""}},
    {"fps has at most 6 decimals", "at most 6 decimals", {"fps", "23.97602397"}},
    {"fps as a ratio", "at most 1000 frames a second", {"fps", "[1001, 1]"}},
    {"pixels in all", "pixels in all", {"resolution", "[16384, 4097]"}},
    {"clip is ascending", "expected near < far", {"camera.clip", "[5, 5]"}},
    {"keys are ascending", "a time after that of the key before it", {"camera.fov", "{\"keys\":[[1,50],[1,60]]}"}},
    {"a moving value stays in its range", "expected to stay in", {"camera.fov", "{\"start\":179,\"rate\":2}"}},
    {"a direction has a length", "a vector whose length is not 0", {"camera.up", "[1e-7, 0, 0]"}},
    {"the camera looks somewhere", "a point other than camera.position", {"camera.position", "[0.25, 0, 0]"}},
    {"up is not along the view", "a direction that is not along the view", {"camera.position", "[0, 3, 0]"}},
    {"phase weights", "weights that sum to 1", {"scene.media[0].phase[1].weight", "0.7"}},
    {"pixels that differ by chance",
     "random numbers of its own in each pixel",
     {"quality", "{\"method\":\"jittered\",\"step\":0.1,\"light_step\":0.1,\"pixels\":{\"threshold\":0.1}}"}},
    {"cut rays of pixels that are traced",
     "not beside pixels",
     {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"pixels\":{\"threshold\":0.1},"
                 "\"max_cut\":0.5}"}},
    {"half keeps no small tolerance", "with half pixels", {"quality", "{\"tolerance\":0.00015}"}},
    {"steps along a ray", "steps along a ray, got", {"quality.step", "1e-6"}},
    {"a step reaches no further than clip",
     "m between the clip distances, got",
     {"quality", "{\"method\":\"riemann\",\"step\":9,\"light_steps\":1}"}},
    {"riemann has an end", "riemann needs camera.clip", {"quality.method", "\"riemann\""}},
    {"a march through a medium ends", "a march through it has no end", {"scene", MEDIUM(NOISE)}},
    {"light comes in somewhere", "the path of lights", {"scene", MEDIUM(SLAB)}},
    {"voxels are a grid's", "whose voxels it counts", {"quality", "{\"method\":\"midpoint\",\"step_voxels\":1}"}},
    {"keys of raw files",
     "only for .raw files",
     {"scene", MEDIUM("{\"kind\":\"grid\",\"file\":\"a.nii\",\"skip_bytes\":1}")}},
    {"named grids",
     "files have named grids",
     {"scene", MEDIUM("{\"kind\":\"grid\",\"file\":\"a.nii\",\"grid\":\"density\"}")}},
    {"no directives", "is not for densities", {"scene", MEDIUM(GLSL)}},
    {"hot grids", "which holds its temperature", {"scene.media[1].blackbody", "{\"grid\":\"t\",\"kelvin\":1}"}},
    {"a transfer function is ascending",
     "expected a value above that of the point",
     {"scene", "{\"media\":[{\"density\":{\"kind\":\"grid\",\"file\":\"a.nii\",\"unit_distance\":1,"
               "\"transfer_function\":[[0,0,0,0,0],[0,1,1,1,0.5]]}}]}"}},
    {"light marches in steps", "as light marches through media", {"quality.light_step", NULL}},
    {"equiangular is for the homogeneous",
     "which equiangular needs everywhere",
     {"quality", "{\"method\":\"equiangular\",\"points\":1}"}},
    {"equiangular is for the even", "0, which equiangular needs", {"scene", MEDIUM(FALLOFF)}},
    {"objects are there to be cut at", "only for scenes with objects", {"quality.max_depth", "3"}},
    {"riemann is for scenes without objects",
     "expected a method that renders objects",
     {"scene", "{\"objects\":[" GLASS "]}"}},
    {"media and interiors in all",
     "media, interiors among them",
     {"scene", "{\"media\":[" FOGS "," FOG "],\"objects\":[" GLASS "]}"}},
    {"shapes in all", "shapes in all", {"scene", "{\"objects\":[" UNION "," UNION "]}"}},
    {"one dome at most", "expected one dome at most", {"lights", "[" DOME "," DOME "]"}},
    {"a visible dome is the background",
     "both lie behind everything",
     {"lights", "[{\"kind\":\"dome\",\"radiance\":1,\"visible\":true}]"}},
    {"light of many directions", "its light comes from many directions", {"lights", "[" DOME "]"}},
    {"cones are one in the other", "expected at most outer", {"lights", "[" SPOT("30", "20") "]"}},
    {"a scatter_grid is for several orders",
     "only where light scatters more than once",
     {"quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":8}"}},
    {"several orders need a scatter_grid",
     "which a march needs where light scatters more than once",
     {"scene.scattering", "{\"orders\":2}"}},
    {"methods of one order",
     "expected one that shows light scattered more than once",
     {"scene.scattering", "{\"orders\":2}"}},
    {"a box around what scatters",
     "a scatter_grid is a box around what scatters",
     {"scene", "{\"scattering\":{\"orders\":2},\"media\":[{\"sigma_s\":1,\"sigma_a\":1,\"density\":{\"kind\":"
               "\"homogeneous\"}}]}"}},
    {"paths of nodes", "only beside scatter_grid", {"quality.paths", "3"}},
    {"random paths end at glass",
     "not with random paths",
     {"scene", "{\"scattering\":{\"orders\":\"all\"},\"objects\":[" GLASS "]}"}},
    {"random paths know a majorant", "which random paths need", {"scene", SEVERAL(CODE)}},
    {"random paths end", "it scatters without end", {"scene", SEVERAL("{\"kind\":\"homogeneous\"}")}},
    {"what is not rendered yet", "not rendered yet", {0}},
    {"output stays below its root", "expected a path below", {"output.path", "\"/elsewhere/a.#.exr\""}},
    {"no . or .. in a path", "is not allowed in a path", {"output.path", "\"../a.#.exr\""}},
    {"a number in the name alone", "belongs into the file name", {"output.path", "\"%04d/a.#.exr\""}},
    {"one number in the name", "expected one frame number", {"output.path", "\"a.%04d.%04d.exr\""}},
    {0},
};

static struct cJSON *schema_root;

const struct cross_rule *schema_agreement_find_rule(const char *message)
{
    for (const struct cross_rule *rule = schema_cross_rules; rule->name; rule++)
        if (strstr(message, rule->message)) return rule;
    return NULL;
}

struct schema_verdicts schema_agreement_judge(const char *text)
{
    struct schema_verdicts verdicts = {0};
    struct cJSON *root = NULL;
    struct json_node schema = json_node_root(schema_root), document;
    struct job job;

    if (!json_parse(&root, text, strlen(text), &verdicts.error)) fail_msg("%s: %s", verdicts.error.message, text);
    document = json_node_root(root);
    verdicts.schema = schema_accepts(&schema, &document);
    verdicts.code = job_from_json(&job, &document, "/srv/out", &verdicts.error);
    job_finish(&job);
    json_delete(root);
    return verdicts;
}

void schema_agreement_assert(const char *text, const char *change)
{
    struct schema_verdicts verdicts = schema_agreement_judge(text);

    if (verdicts.schema == verdicts.code) return;
    if (verdicts.schema && schema_agreement_find_rule(verdicts.error.message)) return;
    fail_msg("%s: the schema %s it, the code says \"%s\"", change, verdicts.schema ? "takes" : "refuses",
             verdicts.code ? "yes" : verdicts.error.message);
}

// Replacements for every value, for strings, and for values that are no strings.
static const char *const for_all[] = {"null", "true", "false", "\"\"", "\"x\"", "-1", "0", "1", "[]", "{}", NULL};
static const char *const for_strings[] = {"\"1-5\"",
                                          "\" 1 , 5-3 ,07-9x2\\t\"",
                                          "\"1-5x0\"",
                                          "\"12345678\"",
                                          "\"1:5\"",
                                          "\"1,,2\"",
                                          "\"a.#.exr\"",
                                          "\"a/b.%04d.exr\"",
                                          "\"a//b.#.exr\"",
                                          "\"/srv/out/a.##########.exr\"",
                                          "\"#########.exr\"",
                                          "\"/srv/out/a.#.exr\"",
                                          "\"a.#.png\"",
                                          "\"a.exr\"",
                                          "\"a#b#.exr\"",
                                          "\"caf\\u00e9\"",
                                          "\"a\\tb\"",
                                          "\"a\\u0085b\"",
                                          "\"draft\"",
                                          "\"ratio\"",
                                          "\"jackknife\"",
                                          "\"sphere\"",
                                          "\"box\"",
                                          "\"slab\"",
                                          "\"all\"",
                                          "\"b/a.EXR\"",
                                          "\"clip\"",
                                          "\"rayleigh\"",
                                          "\"uint8\"",
                                          "\"big\"",
                                          "\"nearest\"",
                                          "\"a.raw\"",
                                          "\"/b/a.NII.gz\"",
                                          "\"#.nrrd\"",
                                          "\".nhdr\"",
                                          "\"a/.vdb\"",
                                          "\"a#b#.vdb\"",
                                          "\"a#/b#.vdb\"",
                                          "\"a##########.nvdb\"",
                                          "\"a.nii.zip\"",
                                          "\"none\"",
                                          "\"half\"",
                                          "\"zip\"",
                                          "\"Z\"",
                                          "\"verify\"",
                                          "\"linear\"",
                                          "\"failed\"",
                                          "\"-chat\"",
                                          "\"http://a\"",
                                          "\"https://a.b_c-d:80?e=@f\\\\g\"",
                                          "\"http://me@a/\"",
                                          "\"http://a/b c\"",
                                          "\"https://a/caf\\u00e9\"",
                                          "\"ftp://a/b\"",
                                          NULL};
static const char *const for_others[] = {
    "-0.0",
    "1e-12",
    "1e-9",
    "1e-6",
    "0.5",
    "0.9999999",
    "1.0",
    "1.5",
    "0.999",
    "0.9995",
    "-0.9995",
    "10.5",
    "16",
    "17",
    "1024",
    "1025",
    "2",
    "3",
    "33",
    "90",
    "90.5",
    "100",
    "100.5",
    "101",
    "179.9",
    "180",
    "1000",
    "1001",
    "16384",
    "16385",
    "60000",
    "60001",
    "1e9",
    "1.1e9",
    "-1.1e9",
    "1e15",
    "1.1e15",
    "1e300",
    "[1]",
    "[0,1]",
    "[1,0]",
    "[1,2]",
    "[1,1.5]",
    "[0,0,0]",
    "[0.5,0.5,0.5]",
    "[1,2,3]",
    "[-1,0,1]",
    "[1,2,\"x\"]",
    "[1,2,1e16]",
    "[1,2,3,4]",
    "[1,2,3,4,0.5]",
    "[1,2,3,4,1]",
    "[-2,-2,3,4,0]",
    "65536",
    "65537",
    "256",
    "257",
    "4",
    "1048576",
    "1048577",
    "1125899906842624",
    "1125899906842625",
    "{\"grid\":\"t\",\"kelvin\":2}",
    "[[1,2,3,4,0]]",
    "[\"Z\",\"Z\"]",
    "[\"Z\",\"transmittance\"]",
    "[[0,1]]",
    "[[0,[1,2,3]]]",
    "[[0,0.5],[1,0.25]]",
    "[[0,1],[1,[1,2,3]]]",
    "{\"x\":1}",
    "{\"angle\":1}",
    "{\"below\":1,\"survive\":0.5}",
    "{\"below\":0.5,\"survive\":1}",
    "{\"kind\":\"sphere\",\"radius\":1}",
    "{\"kind\":\"box\",\"size\":[1,0,1]}",
    "{\"kind\":\"homogeneous\"}",
    "{\"start\":0.5}",
    "{\"start\":0.5,\"rate\":0}",
    "{\"start\":[0,0.5,1],\"rate\":[0,0,0]}",
    "{\"start\":0.5,\"rate\":[0,0,0]}",
    "{\"keys\":[]}",
    "{\"keys\":[[0,0.5],[1,0.25]],\"interpolation\":\"hold\"}",
    "{\"keys\":[[0,[1,2,3]],[1,[0,0,0]]]}",
    "{\"keys\":[[0,[1,2,3]],[1,2]]}",
    "{\"keys\":[[0,0.5,1]]}",
    "{\"keys\":[[0,0.5]],\"interpolation\":\"cubic\"}",
    "{\"keys\":[[0,0.5]],\"start\":1,\"rate\":0}",
    "{\"lissajous\":{\"center\":0.5,\"amplitude\":0.1,\"frequency_rad\":1}}",
    "{\"lissajous\":{\"center\":[1,1,1],\"amplitude\":[0.1,0,0],\"frequency_rad\":[1,1,1],\"phase_rad\":[0,0,0]}}",
    "{\"lissajous\":{\"center\":[1,1,1],\"amplitude\":0.1,\"frequency_rad\":1}}",
    "{\"lissajous\":{\"center\":0.5}}",
    "{\"lissajous\":0.5}",
    "{\"orbit\":{\"radius\":2,\"period\":5}}",
    "{\"orbit\":{\"radius\":2,\"period\":0}}",
    "{\"orbit\":{\"radius\":2,\"period\":5,\"axis\":[0,0,0]}}",
    "{\"orbit\":{\"radius\":-2,\"period\":5}}",
    "{\"orbit\":{}}",
    "{\"orbit\":{\"radius\":2,\"period\":5},\"start\":[0,0,0],\"rate\":[0,0,0]}",
    NULL};

// Also in objects.
static const char *const for_object_strings[] = {
    "\"plane\"", "\"union\"", "\"diffuse\"",  "\"mirror\"", "\"dielectric\"", "\"exact\"", "\"schlick\"",
    "\"srgb\"",  "\"a.png\"", "\"/b/a.EXR\"", "\"a#.png\"", "\"a#/b.png\"",   "\".png\"",  NULL};
static const char *const for_object_others[] = {
    "0.05",
    "10",
    "32",
    "[1,0.5]",
    "{\"sigma_a\":1}",
    "{\"kind\":\"mirror\"}",
    "{\"kind\":\"diffuse\",\"texture\":{\"file\":\"a.png\"}}",
    "{\"kind\":\"diffuse\",\"texture\":{\"file\":\"a.png\",\"size\":1}}",
    "{\"kind\":\"dielectric\",\"ior\":2,\"f0\":0}",
    "{\"kind\":\"dielectric\",\"ior\":2,\"fresnel\":\"none\",\"f90\":0}",
    "{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}",
    "[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}]",
    "{\"kind\":\"plane\",\"point\":[0,0,0],\"material\":{\"kind\":\"mirror\"}}",
    NULL};

static void check_replacements(const char *text, const char *path, const char *const replacements[])
{
    for (size_t i = 0; replacements[i]; i++) {
        char *change = xasprintf("%s = %s", path, replacements[i]);
        char *edited = json_edit_set(text, path, replacements[i]);

        schema_agreement_assert(edited, change);
        free(edited);
        free(change);
    }
}

static void check_name(const char *text, const char *path, const char *name)
{
    char *quoted = xasprintf("\"%s\"", name);
    const char *const replacements[] = {quoted, NULL};

    check_replacements(text, path, replacements);
    free(quoted);
}

// Names that the code reads from tables: a new one that the schema lacks, or spells otherwise, is a disagreement.
static void check_names(const char *text, const char *path)
{
    const char *methods[JOB_METHOD_COUNT + 1], *densities[DENSITY_RULES_LIMIT], *lights[LIGHT_RULES_LIMIT];

    job_method_list(methods);
    for (size_t i = 0; methods[i]; i++)
        check_name(text, path, methods[i]);
    density_rules_list(densities);
    for (size_t i = 0; densities[i]; i++)
        check_name(text, path, densities[i]);
    light_rules_list(lights);
    for (size_t i = 0; lights[i]; i++)
        check_name(text, path, lights[i]);
}

static void check_place(const char *text, const struct json_place *place)
{
    const char *dot = strrchr(place->path, '.');
    char *change = xasprintf("%s removed", place->path);
    char *key = xasprintf("%sx", dot ? dot + 1 : place->path);
    char *edited = json_edit_set(text, place->path, NULL);

    schema_agreement_assert(edited, change);
    free(edited);
    free(change);
    if (!strchr(key, ']')) {
        change = xasprintf("%s renamed", place->path);
        edited = json_edit_rename(text, place->path, key);
        schema_agreement_assert(edited, change);
        free(edited);
        free(change);
    }
    free(key);
    check_replacements(text, place->path, for_all);
    check_replacements(text, place->path, place->is_string ? for_strings : for_others);
    if (place->is_string) check_names(text, place->path);
    if (strncmp(place->path, "scene.objects", 13) == 0)
        check_replacements(text, place->path, place->is_string ? for_object_strings : for_object_others);
}

void schema_agreement_check_places(const char *text, const char *prefix)
{
    struct schema_verdicts verdicts = schema_agreement_judge(text);
    size_t count;
    struct json_place *places = json_edit_places(text, &count);

    if (!verdicts.schema || (!verdicts.code && !strstr(verdicts.error.message, "not rendered yet")))
        fail_msg("schema %d, code %d: %s", verdicts.schema, verdicts.code, verdicts.error.message);
    for (size_t i = 0; i < count; i++)
        if (strncmp(places[i].path, prefix, strlen(prefix)) == 0) check_place(text, &places[i]);
    json_edit_free_places(places, count);
}

int schema_agreement_load(void **state)
{
    char *text = job_text_load("schema.json");
    struct error error = {0};
    bool ok = json_parse(&schema_root, text, strlen(text), &error);

    if (!ok) print_error("schema.json: %s\n", error.message);
    free(text);
    return ok ? 0 : -1;
}

int schema_agreement_drop(void **state)
{
    json_delete(schema_root);
    return 0;
}
