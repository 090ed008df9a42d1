// SPDX-License-Identifier: Apache-2.0
#include "reference/reference.h"

#include "reference/trace.h"
#include "reference/transmittance.h"

#include <math.h>

// An image whose values are all below it counts as black: its errors are absolute.
static const double BLACK = 1e-6;

static struct reference_pixel measure(const struct still *still, double x, double y, uint64_t seed,
                                      const struct integrate_accuracy *accuracy)
{
    struct ray ray = camera_pinhole_ray(&still->camera, x, y);
    struct trace_result traced = trace_ray(still, &ray, seed, accuracy);
    struct reference_pixel pixel = {.ray_count = traced.ray_count,
                                    .cut_count = traced.cut_count,
                                    .cut_throughput = traced.cut_throughput,
                                    .cut_by_depth = traced.cut_by_depth,
                                    .is_converged = traced.is_converged};
    double sum = 0.0;

    for (int c = 0; c < 3; c++) {
        pixel.radiance[c] = traced.radiance[c];
        pixel.transmittance[c] = traced.transmittance[c];
        sum += traced.transmittance[c];
    }
    pixel.alpha = still->has_background ? 1.0 : 1.0 - sum / 3.0;
    return pixel;
}

struct reference_pixel reference_measure_pixel(const struct still *still, int x, int y,
                                               const struct integrate_accuracy *accuracy)
{
    return measure(still, x + 0.5, y + 0.5, 0, accuracy);
}

struct reference_pixel reference_measure_samples(const struct job *job, const struct still_inputs *inputs, int x, int y,
                                                 const struct reference_sample *samples, size_t count,
                                                 const struct integrate_accuracy *accuracy)
{
    static const struct still_inputs NOTHING;
    struct reference_pixel mean = {.is_converged = true};
    double squares[3] = {0.0, 0.0, 0.0}, share = 1.0 / (double)count;

    for (size_t i = 0; i < count; i++) {
        struct reference_pixel pixel;
        struct still still;

        still_init_with_inputs(&still, job, samples[i].time, inputs ? inputs : &NOTHING);
        pixel = measure(&still, x + samples[i].x, y + samples[i].y, samples[i].seed, accuracy);
        for (int c = 0; c < 3; c++) {
            double off = pixel.radiance[c] - mean.radiance[c];

            // The mean and the sum of squares about it: Welford, Technometrics 4, 1962.
            mean.radiance[c] += off / (double)(i + 1);
            squares[c] += off * (pixel.radiance[c] - mean.radiance[c]);
            mean.transmittance[c] += pixel.transmittance[c] * share;
        }
        mean.alpha += pixel.alpha * share;
        mean.ray_count += pixel.ray_count * share;
        mean.cut_count += pixel.cut_count * share;
        mean.cut_throughput += pixel.cut_throughput * share;
        mean.cut_by_depth += pixel.cut_by_depth * share;
        mean.is_converged = mean.is_converged && pixel.is_converged;
    }
    for (int c = 0; c < 3 && count > 1; c++)
        mean.radiance_error[c] = sqrt(squares[c] / ((double)count * (double)(count - 1)));
    return mean;
}

static double mean_transmittance(const struct still_media *media, const struct ray *ray, double near, double far)
{
    double share[3];

    transmittance(media->list, media->count, ray, near, far, 1e-7, share);
    return (share[0] + share[1] + share[2]) / 3.0;
}

// A finite end of the media along the ray, at which halving starts.
static double last_density(const struct still_media *media, const struct ray *ray, double near, double far)
{
    double last = near;

    far = transmittance_reach(media->list, media->count, ray, near, far);
    for (size_t m = 0; m < media->count; m++) {
        const struct density *density = &media->list[m].density;
        struct span_list spans = {0};

        density->spans(density->field, ray, near, far, &spans);
        if (spans.count > 0) last = fmax(last, spans.spans[spans.count - 1].end);
        span_list_finish(&spans);
    }
    return last;
}

double reference_measure_depth(const struct still *still, int x, int y)
{
    // Doubles have no more digits.
    const int halvings = 60;
    struct ray ray = camera_pinhole_ray(&still->camera, x + 0.5, y + 0.5);
    double near = still->camera.clip_near, before = near, after, surface;
    struct still_media media;
    struct object_walk walk;

    objects_walk(&still->objects, &ray, INFINITY, &walk);
    surface = walk.pieces[0].end;
    media = still_media(still, walk.pieces[0].region);
    after = last_density(&media, &ray, near, fmin(still->camera.clip_far, surface));
    if (!(near < after) || mean_transmittance(&media, &ray, near, after) > 0.5)
        return isinf(surface) ? 0.0 : surface * vec3_dot(ray.direction, still->camera.forward);
    for (int i = 0; i < halvings; i++) {
        double middle = 0.5 * (before + after);

        if (mean_transmittance(&media, &ray, near, middle) > 0.5) {
            before = middle;
        } else {
            after = middle;
        }
    }
    return after * vec3_dot(ray.direction, still->camera.forward);
}

struct reference_error reference_image_error(const float *image, const double *reference, size_t count)
{
    struct reference_error error = {0};
    double error_squares = 0.0, squares = 0.0, brightest = 0.0;

    for (size_t i = 0; i < count; i++) {
        double difference = fabs(image[i] - reference[i]);

        // Not "difference > largest": a NaN must not pass.
        if (!(difference <= error.largest)) {
            error.largest = isnan(difference) ? INFINITY : difference;
            error.largest_index = i;
        }
        error_squares += difference * difference;
        squares += reference[i] * reference[i];
        brightest = fmax(brightest, fabs(reference[i]));
    }
    if (count == 0) return error;
    error.relative_rmse = brightest < BLACK ? sqrt(error_squares / (double)count) : sqrt(error_squares / squares);
    if (isnan(error.relative_rmse)) error.relative_rmse = INFINITY;
    return error;
}
