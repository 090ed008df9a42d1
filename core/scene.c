#include "core/scene.h"

static void finish_medium(struct scene_medium *medium)
{
    struct scene_fold_fractal *fold_fractal = &medium->density.fold_fractal;

    timeline_finish(&fold_fractal->offset);
    timeline_finish(&fold_fractal->radius);
    timeline_finish(&fold_fractal->rotate_x_rad);
    timeline_finish(&fold_fractal->rotate_y_rad);
    timeline_finish(&fold_fractal->exponent);
    timeline_finish(&fold_fractal->scale);
    timeline_finish(&medium->sigma_s);
    timeline_finish(&medium->sigma_a);
    timeline_finish(&medium->emission);
    for (size_t i = 0; i < medium->lobe_count; i++) {
        timeline_finish(&medium->lobes[i].g);
        timeline_finish(&medium->lobes[i].weight);
    }
}

void scene_finish(struct scene *scene)
{
    timeline_finish(&scene->camera.position);
    timeline_finish(&scene->camera.target);
    timeline_finish(&scene->camera.up);
    timeline_finish(&scene->camera.fov);
    for (size_t i = 0; i < scene->light_count; i++) {
        timeline_finish(&scene->lights[i].intensity);
        timeline_finish(&scene->lights[i].position);
        timeline_finish(&scene->lights[i].direction);
    }
    for (size_t i = 0; i < scene->medium_count; i++)
        finish_medium(&scene->media[i]);
    timeline_finish(&scene->background);
    *scene = (struct scene){0};
}

static bool medium_is_constant(const struct scene_medium *medium)
{
    const struct scene_fold_fractal *fold_fractal = &medium->density.fold_fractal;

    for (size_t i = 0; i < medium->lobe_count; i++)
        if (!timeline_is_constant(&medium->lobes[i].g) || !timeline_is_constant(&medium->lobes[i].weight)) return false;
    return timeline_is_constant(&fold_fractal->offset) && timeline_is_constant(&fold_fractal->radius) &&
           timeline_is_constant(&fold_fractal->rotate_x_rad) && timeline_is_constant(&fold_fractal->rotate_y_rad) &&
           timeline_is_constant(&fold_fractal->exponent) && timeline_is_constant(&fold_fractal->scale) &&
           timeline_is_constant(&medium->sigma_s) && timeline_is_constant(&medium->sigma_a) &&
           timeline_is_constant(&medium->emission);
}

bool scene_is_constant(const struct scene *scene)
{
    for (size_t i = 0; i < scene->light_count; i++)
        if (!timeline_is_constant(&scene->lights[i].intensity) || !timeline_is_constant(&scene->lights[i].position) ||
            !timeline_is_constant(&scene->lights[i].direction))
            return false;
    for (size_t i = 0; i < scene->medium_count; i++)
        if (!medium_is_constant(&scene->media[i])) return false;
    return timeline_is_constant(&scene->camera.position) && timeline_is_constant(&scene->camera.target) &&
           timeline_is_constant(&scene->camera.up) && timeline_is_constant(&scene->camera.fov) &&
           timeline_is_constant(&scene->background);
}
