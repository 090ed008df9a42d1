// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/pixel_samples.h"

#include "core/job/job.h"

static const uint32_t ALL_SAMPLES = UINT32_MAX; // the index for random numbers that a pixel's samples share

int pixel_samples_count(const struct job *job)
{
    return job->quality.samples > 1 ? job->quality.samples : 1;
}

void pixel_samples_strata(int count, int *columns, int *rows)
{
    *rows = 1;
    for (int side = 2; side * side <= count; ++side)
        if (count % side == 0) *rows = side;
    *columns = count / *rows;
}

uint32_t pixel_samples_frame_seed(const struct job *job, int32_t frame)
{
    return scene_is_constant(&job->scene) ? 0 : (uint32_t)frame;
}

static double time_of_share(const struct job *job, int32_t frame, double share)
{
    double open_s = job->scene.camera.shutter * (double)job->fps_denominator / (double)job->fps_numerator;

    return job_frame_time(job, frame) + share * open_s;
}

double pixel_samples_time(const struct job *job, int32_t frame, int index)
{
    return time_of_share(job, frame, (index + 0.5) / pixel_samples_count(job));
}

double pixel_samples_middle(const struct job *job, int32_t frame)
{
    return time_of_share(job, frame, 0.5);
}

static uint32_t hash(uint32_t value)
{
    uint32_t state = value * 747796405u + 2891336453u;
    uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;

    return (word >> 22) ^ word;
}

static uint32_t start(int x, int y, uint32_t index, uint32_t frame)
{
    return hash(hash(hash(hash(frame) + index) + (uint32_t)y) + (uint32_t)x);
}

static uint32_t draw(uint32_t *state)
{
    uint32_t bits = hash(*state);

    *state = *state * 747796405u + 2891336453u;
    return bits;
}

static uint32_t permute(uint32_t index, uint32_t count, uint32_t seed)
{
    uint32_t top = 31 - (uint32_t)__builtin_clz(count - 1);
    uint32_t mask = (2u << top) - 1, shift = top / 2 + 1;

    do {
        uint32_t key = seed;

        for (int round = 0; round < 3; ++round) {
            key = hash(key);
            index = (index * (key | 1) + (key >> 16)) & mask;
            index ^= index >> shift;
        }
    } while (index >= count);
    return (index + hash(seed ^ 0x5bd1e995u) % count) % count;
}

struct pixel_point pixel_samples_point(const struct job *job, int32_t frame, int x, int y, int index)
{
    uint32_t seed = pixel_samples_frame_seed(job, frame), state, stratum, across, down;
    int count = pixel_samples_count(job), columns, rows;

    if (count == 1) return (struct pixel_point){(float)x + 0.5f, (float)y + 0.5f};
    pixel_samples_strata(count, &columns, &rows);
    state = start(x, y, ALL_SAMPLES, seed);
    stratum = permute((uint32_t)index, (uint32_t)count, draw(&state));
    state = start(x, y, (uint32_t)index, seed);
    across = (((stratum % (uint32_t)columns) << 20) + (draw(&state) >> 12)) / (uint32_t)columns;
    down = (((stratum / (uint32_t)columns) << 20) + (draw(&state) >> 12)) / (uint32_t)rows;
    return (struct pixel_point){(float)x + (float)across * 0x1p-20f, (float)y + (float)down * 0x1p-20f};
}
