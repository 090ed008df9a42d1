// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr_attributes.h"

#include "worker/picture/audit_result.h"
#include "worker/picture/image_exr.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// An absent one leaves `number` as it is.
static bool read_double(exr_context_t context, const char *name, double *number)
{
    const exr_attribute_t *found;

    if (exr_get_attribute_by_name(context, 0, name, &found) || found->type != EXR_ATTR_DOUBLE) return false;
    *number = found->d;
    return true;
}

// An absent one leaves `text` as it is.
static bool read_text(exr_context_t context, const char *name, char *text, size_t size)
{
    const exr_attribute_t *found;

    if (exr_get_attribute_by_name(context, 0, name, &found) || found->type != EXR_ATTR_STRING) return false;
    snprintf(text, size, "%s", found->string->str);
    return true;
}

static void read_traced(exr_context_t context, struct image_exr_facts *facts)
{
    double share;

    if (read_double(context, "marchd:traced", &share) && share > 0.0 && share <= 1.0) facts->traced = share;
}

static void read_beyond(exr_context_t context, struct image_exr_facts *facts)
{
    struct job_beyond found = {.is_known = true};

    if (read_double(context, "marchd:beyond", &found.error) &&
        read_double(context, "marchd:beyond95", &found.error95) && found.error >= 0.0 && found.error <= found.error95 &&
        found.error95 <= 1.0)
        facts->beyond = found;
}

static void read_fps(exr_context_t context, struct image_exr_facts *facts)
{
    const exr_attribute_t *found;

    if (exr_get_attribute_by_name(context, 0, "framesPerSecond", &found) || found->type != EXR_ATTR_RATIONAL) return;
    if (found->rational->num <= 0 || found->rational->denom == 0) return;
    facts->fps_numerator = found->rational->num;
    facts->fps_denominator = found->rational->denom;
}

static void read_plan(exr_context_t context, struct image_exr_facts *facts)
{
    char number[24];

    read_text(context, "marchd:plan", facts->plan, sizeof facts->plan);
    read_text(context, "marchd:quality", facts->quality, sizeof facts->quality);
    if (read_text(context, "marchd:planNumber", number, sizeof number)) facts->plan_number = strtoll(number, NULL, 10);
    if (facts->plan_number < 0) facts->plan_number = 0;
}

static void read_accuracy(exr_context_t context, struct image_exr_facts *facts)
{
    struct audit_result *audit = &facts->audit;
    char kind[16] = "", scope[16] = "";
    const exr_attribute_t *draft, *rays, *missed;

    facts->is_draft =
        !exr_get_attribute_by_name(context, 0, "marchd:draft", &draft) && draft->type == EXR_ATTR_INT && draft->i != 0;
    read_double(context, "marchd:samplingError", &facts->sampling_error);
    *audit = (struct audit_result){.error = NAN, .error95 = NAN, .tolerance = NAN};
    read_double(context, "marchd:error95", &audit->error95);
    read_double(context, "marchd:tolerance", &audit->tolerance);
    if (!exr_get_attribute_by_name(context, 0, "marchd:auditRays", &rays) && rays->type == EXR_ATTR_INT)
        audit->ray_count = rays->i;
    audit->is_missed = !exr_get_attribute_by_name(context, 0, "marchd:missed", &missed) &&
                       missed->type == EXR_ATTR_INT && missed->i != 0;
    read_text(context, "marchd:auditScope", scope, sizeof scope);
    audit->is_pooled = !strcmp(scope, "segment");
    read_text(context, "marchd:audit", kind, sizeof kind);
    if (read_double(context, "marchd:error", &audit->error)) audit->kind = audit_result_find_kind(kind);
}

void image_exr_attributes_read(exr_context_t context, struct image_exr_facts *facts)
{
    const exr_attribute_t *found;
    char job[32];

    read_fps(context, facts);
    read_text(context, "marchd:jobHash", facts->job_hash, sizeof facts->job_hash);
    read_text(context, "marchd:sequenceHash", facts->sequence_hash, sizeof facts->sequence_hash);
    read_text(context, "marchd:name", facts->job_name, sizeof facts->job_name);
    read_text(context, "marchd:method", facts->method, sizeof facts->method);
    read_double(context, "marchd:step", &facts->step);
    if (read_text(context, "marchd:job", job, sizeof job)) facts->job_id = strtoll(job, NULL, 10);
    if (!exr_get_attribute_by_name(context, 0, "marchd:frame", &found) && found->type == EXR_ATTR_INT)
        facts->frame = found->i;
    read_double(context, "marchd:renderSeconds", &facts->render_seconds);
    facts->rays.is_known = read_double(context, "marchd:cutShare", &facts->rays.cut_share);
    read_double(context, "marchd:raysPerPixel", &facts->rays.rays_per_pixel);
    read_double(context, "marchd:cutRays", &facts->rays.cut_rays);
    read_double(context, "marchd:cutTolerance", &facts->rays.cut_tolerance);
    read_traced(context, facts);
    read_plan(context, facts);
    read_beyond(context, facts);
    read_accuracy(context, facts);
}

struct frame_accuracy image_exr_accuracy(const struct image_exr_facts *facts)
{
    struct frame_accuracy accuracy = audit_result_accuracy(&facts->audit, facts->method);

    accuracy.plan = facts->plan_number;
    accuracy.has_cut_share = facts->rays.is_known;
    accuracy.cut_share = facts->rays.cut_share;
    accuracy.traced = facts->traced;
    return accuracy;
}
