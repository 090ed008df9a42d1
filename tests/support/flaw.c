// SPDX-License-Identifier: Apache-2.0
#include "tests/support/flaw.h"

#include "core/job/job.h"
#include "worker/picture/image.h"

#include <math.h>

const char *const flaw_names[FLAW_COUNT] = {"none",
                                            "two pixels of the brightest value",
                                            "a region 20 % dim",
                                            "all 5 % bright",
                                            "a light 0.2 s late",
                                            "a light at a quarter in a region",
                                            "steps 3 times as long"};

// An eighteenth of the picture, in its middle.
static bool is_in_region(const struct image *image, int i)
{
    int x = i % image->width_px, y = i / image->width_px, width = image->width_px, height = image->height_px;

    return 8 * x >= 3 * width && 8 * x < 5 * width && 18 * y >= 7 * height && 18 * y < 11 * height;
}

static bool is_spot(const struct image *image, int i)
{
    int first = image->height_px / 2 * image->width_px + 15 * image->width_px / 32;

    return i == first || i == first + 1;
}

void flaw_spoil_values(enum flaw flaw, struct image *image)
{
    int count = image->width_px * image->height_px;
    float brightest = 0.0f;

    for (int i = 0; i < 4 * count; i++)
        if (i % 4 < 3) brightest = fmaxf(brightest, image->rgba[i]);
    for (int i = 0; i < 4 * count; i++) {
        float *value = &image->rgba[i];

        if (i % 4 == 3) continue;
        if (flaw == FLAW_SPOT && is_spot(image, i / 4)) *value = brightest;
        if (flaw == FLAW_DIM && is_in_region(image, i / 4)) *value *= 0.8f;
        if (flaw == FLAW_CONSTANT) *value *= 1.05f;
    }
}

static void dim_light(struct job *job, int32_t frame, double factor)
{
    struct timeline *intensity = &job->scene.lights[0].intensity,
                    dimmed = {.component_count = intensity->component_count};

    timeline_evaluate(intensity, job_frame_time(job, frame), dimmed.value);
    for (int c = 0; c < 3; c++)
        dimmed.value[c] *= factor;
    *intensity = dimmed;
}

bool flaw_spoil_light(enum flaw flaw, const struct job *job, int32_t frame, struct job *spoilt)
{
    *spoilt = *job;
    if (flaw != FLAW_LIGHT_MOVED && flaw != FLAW_LIGHT_GONE) return false;
    if (job->scene.light_count == 0) return false;
    if (flaw == FLAW_LIGHT_MOVED)
        spoilt->time_offset += 0.2;
    else
        dim_light(spoilt, frame, 0.25);
    return true;
}

void flaw_mix(enum flaw flaw, const struct image *spoilt, struct image *image)
{
    for (int i = 0; i < 4 * image->width_px * image->height_px; i++)
        if (i % 4 < 3 && (flaw == FLAW_LIGHT_MOVED || is_in_region(image, i / 4))) image->rgba[i] = spoilt->rgba[i];
}
