#include "tests/support/true_light.h"

#include "core/alloc.h"
#include "core/job.h"
#include "tests/support/load_grid.h"
#include "tests/support/load_texture.h"
#include "tests/support/render_frame.h"
#include "worker/image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

struct true_light true_light_compare(const struct job *job, enum gl_backend backend)
{
    size_t count = (size_t)job->width_px * (size_t)job->height_px;
    double *truth = xcalloc(7 * count, sizeof *truth);
    float *seen = xcalloc(7 * count, sizeof *seen);
    struct still_inputs inputs;
    struct true_light light;
    struct still *still = xcalloc(1, sizeof *still);
    struct image image;

    render_frame_on(backend, job, &image);
    load_grid_inputs(&inputs, job, 0);
    load_texture_inputs(&inputs, job);
    still_init_with_inputs(still, job, job_frame_time(job, 0), &inputs);
    for (size_t i = 0; i < count; ++i) {
        struct reference_pixel pixel =
            reference_measure_pixel(still, (int)(i % (size_t)job->width_px), (int)(i / (size_t)job->width_px), NULL);

        for (size_t c = 0; c < 3; ++c) {
            seen[3 * i + c] = image.rgba[4 * i + c];
            truth[3 * i + c] = pixel.radiance[c];
            seen[3 * (count + i) + c] = image.transmittance[4 * i + c];
            truth[3 * (count + i) + c] = pixel.transmittance[c];
        }
        seen[6 * count + i] = image.rgba[4 * i + 3];
        truth[6 * count + i] = pixel.alpha;
    }
    light.radiance = reference_image_error(seen, truth, 3 * count);
    light.transmittance = reference_image_error(seen + 3 * count, truth + 3 * count, 3 * count);
    light.alpha = reference_image_error(seen + 6 * count, truth + 6 * count, count);
    print_message("relative RMSE of radiance %.2e (largest %.2e at %zu), transmittance %.2e, alpha %.2e\n",
                  light.radiance.relative_rmse, light.radiance.largest, light.radiance.largest_index / 3,
                  light.transmittance.relative_rmse, light.alpha.relative_rmse);
    load_texture_finish(&inputs);
    load_grid_finish(&inputs);
    image_finish(&image);
    free(still);
    free(truth);
    free(seen);
    return light;
}

bool true_light_is_within(const struct true_light *light, double tolerance)
{
    return light->radiance.relative_rmse <= tolerance && light->transmittance.relative_rmse <= tolerance &&
           light->alpha.relative_rmse <= tolerance;
}
