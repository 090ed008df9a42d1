// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scatter_send_glue.h"

#include "core/job/job.h"
#include "core/scene/light_rules.h"
#include "worker/model/light_kind.h"
#include "worker/model/scatter_grid.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_light.h"

struct site {
    FILE *out;
    const struct scene_light *light;
    const struct light_kind *kind;
    size_t index;
};

static bool is_even(const struct site *site)
{
    return site->light->kind == SCENE_LIGHT_POINT && !site->kind->is_inverse_square;
}

// Writes the cone of a lamp's directions that may meet the grid.
static void write_cone(const struct site *site)
{
    size_t i = site->index;

    fprintf(site->out, "float walk_cone_%zu(out vec3 axis)\n{\n    float cap = scatter_source_cap(light_%zu_position, ",
            i, i);
    if (site->kind->is_sphere)
        fprintf(site->out, "light_%zu_radius);\n", i);
    else
        fputs("0.0);\n", site->out);
    fprintf(site->out,
            "    axis = cap < 2.0 ? normalize(scatter_cells_middle() - light_%zu_position) : vec3(0.0, 0.0, 1.0);\n",
            i);
    if (site->kind->is_spot)
        fprintf(site->out,
                "    float sine = sin(0.5 * light_%zu_outer);\n    if (2.0 * sine * sine < cap) {\n"
                "        cap = 2.0 * sine * sine;\n        axis = -light_%zu_direction;\n    }\n",
                i, i);
    fputs("    return cap;\n}\n", site->out);
    // Irradiance that does not fall with the distance is an intensity that grows with its square.
    if (is_even(site))
        fprintf(site->out,
                "float walk_square_%zu()\n{\n    vec3 away = scatter_cells_middle() - light_%zu_position;\n"
                "    vec3 size = scatter_cells_size();\n    return dot(away, away) + 0.25 * dot(size, size);\n}\n",
                i, i);
}

static void write_dome_power(const struct site *site)
{
    size_t i = site->index;

    fputs("    float sum = 0.0;\n", site->out);
    if (site->kind->has_image)
        fprintf(site->out,
                "    walk_random_start(uvec2(0u), 0u, 0x5e7eu, 0u);\n    for (int k = 0; k < 32; ++k) {\n"
                "        vec3 toward = light_%zu_draw();\n"
                "        sum += spectrum_mean(light_%zu_radiance(toward)) / (32.0 * max(light_%zu_density(toward), "
                "1e-30));\n    }\n",
                i, i, i);
    else
        fprintf(site->out,
                "    for (int k = -1; k < 2; k += 2)\n"
                "        sum += spectrum_mean(light_%zu_radiance(vec3(0.0, 0.0, float(k)))) / (2.0 * INV_4PI);\n",
                i);
    fputs("    return sum * scatter_cells_silhouette_mean();\n", site->out);
}

static void write_power(const struct site *site)
{
    size_t i = site->index;

    fprintf(site->out, "float walk_power_%zu()\n{\n", i);
    if (site->kind->is_dome) {
        write_dome_power(site);
    } else if (!light_rules_of(site->light->kind)->has_position) {
        fprintf(site->out,
                "    return spectrum_mean(light_%zu_intensity) * scatter_cells_silhouette(light_%zu_direction);\n", i,
                i);
    } else {
        fprintf(site->out, "    vec3 axis;\n    return spectrum_mean(light_%zu_intensity) * 6.28318530717958648", i);
        if (is_even(site)) fprintf(site->out, " * walk_square_%zu()", i);
        fprintf(site->out, " * walk_cone_%zu(axis);\n", i);
    }
    fputs("}\n", site->out);
}

static void write_lamp_begin(const struct site *site)
{
    size_t i = site->index;

    fprintf(site->out, "        vec3 axis;\n        float cap = walk_cone_%zu(axis);\n", i);
    fprintf(site->out, "        source = scatter_source_cone(light_%zu_position, ", i);
    if (site->kind->is_sphere)
        fprintf(site->out, "light_%zu_radius, axis, cap, share, vec2(walk_random(), walk_random()));\n", i);
    else
        fputs("0.0, axis, cap, share, vec2(0.0));\n", site->out);
    fprintf(site->out, "        power = light_%zu_intensity", i);
    if (is_even(site)) fprintf(site->out, " * walk_square_%zu()", i);
    if (site->kind->is_spot) {
        fputs(" * light_spot_share(", site->out);
        scene_glue_light_write_value(site->out, site->light, i);
        fputs(", -source.direction)", site->out);
    }
    fputs(";\n        return false;\n", site->out);
}

static void write_dome_begin(const struct site *site)
{
    size_t i = site->index;

    fputs("        vec3 toward = scatter_turn(vec3(0.0, 0.0, 1.0), 2.0 * share.x, share.y);\n"
          "        float density = INV_4PI;\n",
          site->out);
    if (site->kind->has_image)
        fprintf(site->out,
                "        if (walk_random() < 0.5) toward = light_%zu_draw();\n"
                "        density = 0.5 * (INV_4PI + light_%zu_density(toward));\n",
                i, i);
    fprintf(site->out,
            "        source = scatter_source_parallel(-toward, vec2(walk_random(), walk_random()));\n"
            "        source.measure /= density;\n        power = light_%zu_radiance(toward);\n        return true;\n",
            i);
}

// Each as a branch of a function of `int light`.
static void write_begins(FILE *out, const struct site *sites, size_t count)
{
    fputs("bool walk_begin(int light, vec2 share, out ScatterSource source, out Spectrum power)\n{\n", out);
    for (size_t k = 0; k < count; ++k) {
        fprintf(out, "    if (light == %zu) {\n", k);
        if (sites[k].kind->is_dome)
            write_dome_begin(&sites[k]);
        else if (light_rules_of(sites[k].light->kind)->has_position)
            write_lamp_begin(&sites[k]);
        else
            fprintf(out,
                    "        source = scatter_source_parallel(-light_%zu_direction, share);\n"
                    "        power = light_%zu_intensity;\n        return true;\n",
                    sites[k].index, sites[k].index);
        fputs("    }\n", out);
    }
    fputs("    source = ScatterSource(vec3(0.0), vec3(0.0, 0.0, 1.0), 0.0);\n    power = spectrum(0.0);\n"
          "    return false;\n}\n",
          out);
}

static void write_falls(FILE *out, const struct site *sites, size_t count)
{
    fputs("float walk_fall(int light, vec3 point)\n{\n", out);
    for (size_t k = 0; k < count; ++k)
        if (is_even(&sites[k]))
            fprintf(out,
                    "    if (light == %zu) {\n        vec3 away = point - light_%zu_position;\n"
                    "        return dot(away, away) / walk_square_%zu();\n    }\n",
                    k, sites[k].index, sites[k].index);
    fputs("    return 1.0;\n}\nbool walk_is_first(int light)\n{\n    return ", out);
    for (size_t k = 0; k < count; ++k)
        if (light_rules_of(sites[k].light->kind)->has_size) fprintf(out, "light == %zu || ", k);
    fputs("false;\n}\n", out);
}

static void write_powers(FILE *out, const struct site *sites, size_t count)
{
    fprintf(
        out,
        "const int WALK_LIGHTS = %zu;\nfloat walk_powers[%zu];\nfloat walk_powers_find()\n{\n    float all = 0.0;\n",
        count, count);
    for (size_t k = 0; k < count; ++k)
        fprintf(out, "    walk_powers[%zu] = walk_power_%zu();\n    all += walk_powers[%zu];\n", k, sites[k].index, k);
    fputs("    return all;\n}\n", out);
}

static void write_phase(FILE *out, const struct scatter_grid *grid)
{
    fprintf(out, "const int SCATTER_GRID_SETS = %zu;\nfloat walk_phase(int set, vec3 incoming, vec3 outgoing)\n{\n",
            grid->group_count);
    for (size_t group = 0; group + 1 < grid->group_count; ++group)
        fprintf(out, "    if (set == %zu) return medium_%zu_phase(incoming, outgoing);\n", group, grid->leaders[group]);
    fprintf(out, "    return medium_%zu_phase(incoming, outgoing);\n}\n", grid->leaders[grid->group_count - 1]);
}

void scatter_send_glue_write(FILE *out, const struct scene_model *model, const struct scatter_grid *grid)
{
    struct site sites[SCENE_LIGHT_LIMIT];
    size_t count = 0;

    for (size_t i = 0; i < model->job->scene.light_count; ++i) {
        const struct scene_light *light = &model->job->scene.lights[i];

        if (model->features.light_is_seen[i])
            sites[count++] = (struct site){.out = out, .light = light, .kind = light_kind_of(light), .index = i};
    }
    for (size_t k = 0; k < count; ++k) {
        if (!sites[k].kind->is_dome && light_rules_of(sites[k].light->kind)->has_position) write_cone(&sites[k]);
        write_power(&sites[k]);
    }
    write_powers(out, sites, count);
    write_begins(out, sites, count);
    write_falls(out, sites, count);
    write_phase(out, grid);
}
