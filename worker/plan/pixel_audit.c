// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/pixel_audit.h"

#include "core/job/job.h"
#include "worker/audit/interpolation_map.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"

#include <string.h>

bool pixel_audit_trace(const struct pixel_audit *audit, const struct pixel *points, size_t count, float *rgba,
                       enum renderer_fault *fault, struct error *error)
{
    struct renderer_result result;
    struct image traced = {0};
    bool ok =
        plan_list_render(audit->params, audit->planned, audit->frame, points, (int)count, 1, &traced, &result, error);

    *fault = result.fault;
    if (ok) memcpy(rgba, traced.rgba, 4 * count * sizeof *rgba);
    image_finish(&traced);
    return ok;
}

bool pixel_audit_measure(const struct pixel_audit *audit, struct audit_verdict *verdict, enum renderer_fault *fault,
                         struct error *error)
{
    struct pixel points[PIXEL_AUDIT_RAYS];
    float traced[4 * PIXEL_AUDIT_RAYS];
    struct audit_samples samples = {0};
    struct interpolation_map map;
    bool ok;

    interpolation_map_init(&map, audit->image, audit->planned->output.pixel);
    interpolation_map_draw(&map, audit->planned, audit->frame, PIXEL_AUDIT_RAYS, points);
    ok = pixel_audit_trace(audit, points, PIXEL_AUDIT_RAYS, traced, fault, error);
    for (size_t i = 0; ok && i < PIXEL_AUDIT_RAYS; i++) {
        struct audit_sample sample = interpolation_map_compare(&map, points[i], &traced[4 * i]);

        audit_samples_append(&samples, &sample);
    }
    if (ok) *verdict = audit_estimate(&(struct audit_evidence){.own = &samples, .change = -1.0, .pool_change = -1.0});
    audit_samples_finish(&samples);
    interpolation_map_finish(&map);
    return ok;
}
