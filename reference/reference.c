#include "reference/reference.h"

#include "reference/transmittance.h"

#include <math.h>

// Below it everywhere an image counts as black, and errors are absolute.
static const double BLACK = 1e-6;

static struct reference_pixel measure(const struct still *still, double x, double y,
                                      const struct integrate_accuracy *accuracy)
{
    const struct camera_pinhole *camera = &still->camera;
    struct ray ray = camera_pinhole_ray(camera, x, y);
    struct integrate_result gathered = integrate_ray(still, &ray, camera->clip_near, camera->clip_far, accuracy);
    struct reference_pixel pixel = {.is_converged = gathered.is_converged};
    double sum = 0.0;

    for (int c = 0; c < 3; c++) {
        pixel.transmittance[c] = gathered.transmittance[c];
        pixel.radiance[c] = gathered.radiance[c];
        if (still->has_background) pixel.radiance[c] += gathered.transmittance[c] * still->background[c];
        sum += gathered.transmittance[c];
    }
    pixel.alpha = still->has_background ? 1.0 : 1.0 - sum / 3.0;
    return pixel;
}

struct reference_pixel reference_measure_pixel(const struct still *still, int x, int y,
                                               const struct integrate_accuracy *accuracy)
{
    return measure(still, x + 0.5, y + 0.5, accuracy);
}

struct reference_pixel reference_measure_samples(const struct job *job, const struct still_inputs *inputs, int x, int y,
                                                 const struct reference_sample *samples, size_t count,
                                                 const struct integrate_accuracy *accuracy)
{
    static const struct still_inputs NOTHING;
    struct reference_pixel mean = {.is_converged = true};

    for (size_t i = 0; i < count; i++) {
        struct reference_pixel pixel;
        struct still still;

        still_init_with_inputs(&still, job, samples[i].time, inputs ? inputs : &NOTHING);
        pixel = measure(&still, x + samples[i].x, y + samples[i].y, accuracy);
        for (int c = 0; c < 3; c++) {
            mean.radiance[c] += pixel.radiance[c] / (double)count;
            mean.transmittance[c] += pixel.transmittance[c] / (double)count;
        }
        mean.alpha += pixel.alpha / (double)count;
        mean.is_converged = mean.is_converged && pixel.is_converged;
    }
    return mean;
}

static double mean_transmittance(const struct still *still, const struct ray *ray, double distance)
{
    double share[3];

    transmittance(still->media, still->medium_count, ray, still->camera.clip_near, distance, 1e-7, share);
    return (share[0] + share[1] + share[2]) / 3.0;
}

// An end of the media along the ray, so that halving has a finite start.
static double last_density(const struct still *still, const struct ray *ray)
{
    double near = still->camera.clip_near, last = near;
    double far = transmittance_reach(still->media, still->medium_count, ray, near, still->camera.clip_far);

    for (size_t m = 0; m < still->medium_count; m++) {
        const struct density *density = &still->media[m].density;
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
    double before = still->camera.clip_near, after = last_density(still, &ray);

    if (mean_transmittance(still, &ray, after) > 0.5) return 0.0;
    for (int i = 0; i < halvings; i++) {
        double middle = 0.5 * (before + after);

        if (mean_transmittance(still, &ray, middle) > 0.5) {
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
