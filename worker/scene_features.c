#include "worker/scene_features.h"

#include "core/job.h"

static bool is_zero(const struct timeline *timeline)
{
    double value[3] = {0};

    if (!timeline_is_constant(timeline)) return false;
    timeline_evaluate(timeline, 0, value);
    return value[0] == 0 && (timeline->component_count != 3 || (value[1] == 0 && value[2] == 0));
}

static bool is_grey(const struct timeline *timeline)
{
    double value[3] = {0};

    if (timeline->component_count != 3) return true;
    if (!timeline_is_constant(timeline)) return false;
    timeline_evaluate(timeline, 0, value);
    return value[0] == value[1] && value[1] == value[2];
}

static enum lobe_feature lobe_feature_of(const struct scene_phase_lobe *lobe)
{
    if (is_zero(&lobe->weight)) return LOBE_UNSEEN;
    return is_zero(&lobe->g) ? LOBE_ISOTROPIC : LOBE_HENYEY_GREENSTEIN;
}

static struct medium_features medium_features_of(const struct scene_medium *medium)
{
    struct medium_features features = {0};

    if (is_zero(&medium->density.fold_fractal.scale)) return features;
    features.scatters = !is_zero(&medium->sigma_s);
    features.absorbs = !is_zero(&medium->sigma_a);
    features.emits = medium->has_emission && !is_zero(&medium->emission);
    features.is_seen = features.scatters || features.absorbs || features.emits;
    for (size_t i = 0; i < medium->lobe_count; ++i)
        features.lobes[i] = lobe_feature_of(&medium->lobes[i]);
    return features;
}

static bool medium_is_grey(const struct scene_medium *medium, struct medium_features features)
{
    return (!features.scatters || is_grey(&medium->sigma_s)) && (!features.absorbs || is_grey(&medium->sigma_a)) &&
           (!features.emits || is_grey(&medium->emission));
}

struct scene_features scene_features_of(const struct job *job)
{
    const struct scene *scene = &job->scene;
    struct scene_features features = {.has_depth = job->output.has_depth,
                                      .has_transmittance = job->output.has_transmittance,
                                      .has_background = scene->has_background && !is_zero(&scene->background)};
    bool scatters = false;

    for (size_t i = 0; i < scene->medium_count; ++i) {
        struct medium_features medium = medium_features_of(&scene->media[i]);

        features.media[i] = medium;
        features.has_media |= medium.is_seen;
        features.has_emission |= medium.emits;
        features.has_extinction |= medium.scatters || medium.absorbs;
        features.is_rgb |= !medium_is_grey(&scene->media[i], medium);
        scatters |= medium.scatters;
    }
    for (size_t i = 0; i < scene->light_count; ++i) {
        features.light_is_seen[i] = scatters && !is_zero(&scene->lights[i].intensity);
        features.has_lights |= features.light_is_seen[i];
        features.is_rgb |= features.light_is_seen[i] && !is_grey(&scene->lights[i].intensity);
    }
    features.is_rgb |= features.has_background && !is_grey(&scene->background);
    return features;
}
