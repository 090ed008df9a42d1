// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/measure.h"

#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/gl/gl_timer.h"
#include "worker/render/renderer.h"

#include <stdlib.h>

enum { REPEATS_MIN = 3, REPEATS_MAX = 15 };

static const double LONG_S = 8.0;   // linking and reading are short beside it
static const double ENOUGH_S = 1.0; // of repeats together, once there are REPEATS_MIN

struct watch {
    const struct measure_params *params;
    double end_s;
    bool is_late, is_unwanted;
};

static bool on_progress(void *user, double done)
{
    struct watch *watch = user;

    watch->is_late = done < 1.0 && clock_now_s() > watch->end_s;
    watch->is_unwanted = watch->params->is_wanted && !watch->params->is_wanted(watch->params->user);
    return !watch->is_late && !watch->is_unwanted;
}

enum measure_outcome measure_render(const struct measure_params *params, struct image *image, double *seconds,
                                    struct error *error)
{
    struct watch watch = {.params = params, .end_s = clock_now_s() + params->limit_s};
    struct renderer_result result;
    double gpu_s = 0;
    bool ok;

    renderer_forget(params->renderer);
    if (params->timer) gl_timer_begin(params->timer);
    ok = renderer_render(
        params->renderer,
        &(struct renderer_frame){
            .job = params->job, .frame = params->frame, .image = image, .on_progress = on_progress, .user = &watch},
        &result, error);
    if (params->timer) gpu_s = gl_timer_end(params->timer);
    *seconds = params->timer ? gpu_s : result.seconds;
    if (ok) return MEASURE_DONE;
    if (watch.is_unwanted) return MEASURE_UNWANTED;
    return watch.is_late ? MEASURE_TOO_SLOW : MEASURE_REFUSED;
}

static int compare(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return left < right ? -1 : left > right;
}

enum measure_outcome measure_time(const struct measure_params *params, struct image *image, double *seconds,
                                  int *repeats, struct error *error)
{
    double times[REPEATS_MAX], first_s, sum = 0;
    enum measure_outcome outcome = measure_render(params, image, &first_s, error);
    int count = 0;

    if (outcome != MEASURE_DONE) return outcome;
    if (first_s > LONG_S) times[count++] = first_s;
    while (first_s <= LONG_S && count < REPEATS_MAX && (count < REPEATS_MIN || sum < ENOUGH_S)) {
        outcome = measure_render(params, image, &times[count], error);
        if (outcome != MEASURE_DONE) return outcome;
        sum += times[count++];
    }
    qsort(times, (size_t)count, sizeof *times, compare);
    *seconds = count % 2 ? times[count / 2] : 0.5 * (times[count / 2 - 1] + times[count / 2]);
    *repeats = count;
    return MEASURE_DONE;
}
