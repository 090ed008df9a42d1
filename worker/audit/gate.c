// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/gate.h"

#include "core/base/error.h"
#include "core/base/hash.h"
#include "core/job/job.h"
#include "worker/model/scene_features.h"
#include "worker/picture/image.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

static const char *pixel_name(enum job_pixel pixel)
{
    return pixel == JOB_PIXEL_HALF ? "half" : "float";
}

static bool check_channel(const char *name, bool found, bool expected, struct error *error)
{
    if (found == expected) return true;
    error_set(error, "channels: expected %s%s", expected ? "" : "no ", name);
    return false;
}

// NaN, from a damaged file, is not within the limit.
static bool check_rays(const struct image_exr_facts *facts, const struct job *job, struct error *error)
{
    if (!scene_features_of(job, NULL).has_paths) return true;
    if (facts->rays.is_known && facts->rays.cut_share >= 0.0 && facts->rays.cut_share <= job->quality.max_cut)
        return true;
    if (facts->rays.is_known)
        error_set(error,
                  "marchd:cutShare: expected at most %g (max_cut), got %g: a larger max_depth or a smaller "
                  "min_throughput cuts fewer rays",
                  job->quality.max_cut, facts->rays.cut_share);
    else
        error_set(error, "marchd:cutShare: expected what rays cut by max_depth and min_throughput may have cost, got "
                         "nothing");
    return false;
}

static bool check_error(const struct audit_result *audit, double tolerance, bool accepts_missed, struct error *error)
{
    // NaN, from a damaged file, is neither a tolerance nor within one.
    if (audit->error >= 0.0 && audit->error <= tolerance) return true;
    if (!audit->is_missed)
        error_set(error, "marchd:error: expected at most %g (tolerance), got %g", tolerance, audit->error);
    else if (!accepts_missed || !(audit->error >= 0.0) || isinf(audit->error))
        error_set(error, "marchd:missed: expected an error of at most %g (tolerance), got %g, the least that was found",
                  tolerance, audit->error);
    else
        return true;
    return false;
}

bool gate_check_audit(const struct audit_result *audit, const struct gate_tolerance *limits, struct error *error)
{
    double tolerance = limits->given > 0.0 ? limits->given : limits->job;

    if (audit->kind == AUDIT_NONE) {
        if (tolerance <= 0.0) return true;
        error_set(error, "marchd:error: expected the frame's measured error, at most %g (tolerance), got nothing",
                  tolerance);
        return false;
    }
    if (limits->given <= 0.0 && (limits->job <= 0.0 || audit->tolerance < limits->job)) tolerance = audit->tolerance;
    if (!check_error(audit, tolerance, limits->accepts_missed, error)) return false;
    if (isfinite(audit->error95)) return true;
    error_set(error, "marchd:error95: expected what the error is below with a confidence of 95 %%, got %g",
              audit->error95);
    return false;
}

// Says what else the file may show: the names and hashes of its header tell.
static bool fail_hash(const struct image_exr_facts *facts, const struct gate_params *params, struct error *error)
{
    const char *name = facts->job_name;

    if (!facts->job_hash[0])
        error_set(error, "marchd:jobHash: expected %s, got nothing", params->picture_hash);
    else if (!strcmp(facts->sequence_hash, params->job->hash))
        error_set(error, "rendered before a file that its job reads was changed (marchd:jobHash: expected %s, got %s)",
                  params->picture_hash, facts->job_hash);
    else if (name[0] && strcmp(name, params->job->name) != 0)
        error_set(error, "rendered from another job, \"%s\" (marchd:jobHash: expected %s, got %s)", name,
                  params->picture_hash, facts->job_hash);
    else
        error_set(error, "rendered from an older version of this job (marchd:jobHash: expected %s, got %s)",
                  params->picture_hash, facts->job_hash);
    return false;
}

static bool check_facts(const struct image_exr_facts *facts, const struct gate_params *params, struct error *error)
{
    const struct job *job = params->job;
    const struct gate_tolerance tolerance = {.job = job->quality.tolerance,
                                             .given = params->tolerance,
                                             .accepts_missed =
                                                 params->accepts_missed && job->quality.on_miss == JOB_ON_MISS_PUBLISH};

    if (strcmp(facts->job_hash, params->picture_hash) != 0) return fail_hash(facts, params, error);
    if (facts->frame != params->frame) {
        error_set(error, "marchd:frame: expected %d, got %d", params->frame, facts->frame);
        return false;
    }
    if (facts->width_px != job->width_px || facts->height_px != job->height_px) {
        error_set(error, "size: expected %d x %d, got %d x %d", job->width_px, job->height_px, facts->width_px,
                  facts->height_px);
        return false;
    }
    if (facts->pixel != job->output.pixel) {
        error_set(error, "pixel: expected %s, got %s", pixel_name(job->output.pixel), pixel_name(facts->pixel));
        return false;
    }
    return check_rays(facts, job, error) && gate_check_audit(&facts->audit, &tolerance, error) &&
           check_channel("A", facts->has_alpha, true, error) &&
           check_channel("Z", facts->has_depth, job->output.has_depth, error) &&
           check_channel("transmittance", facts->has_transmittance, job->output.has_transmittance, error);
}

static bool describe_file(int fd, struct published_file *file, struct error *error)
{
    struct stat status;

    if (fstat(fd, &status) < 0) {
        error_set_errno(error, errno, "file");
        return false;
    }
    file->inode = (uint64_t)status.st_ino;
    return hash_file(fd, file->hash, &file->size_bytes, error);
}

// Reads all values and keeps none. Only a file that is refused is read into memory, to say which value is not finite.
static bool check_values(int fd, int thread_count, struct error *error)
{
    struct image image = {0};
    bool is_finite;
    bool ok = image_exr_scan(fd, &is_finite, thread_count, error);

    if (!ok || is_finite) return ok;
    ok = image_exr_read(fd, &image, NULL, thread_count, error) && image_is_finite(&image, false, error);
    image_finish(&image);
    return ok;
}

bool gate_check(const struct gate_params *params, struct gate_result *result, struct error *error)
{
    struct gate_result unwanted;
    int fd = params->fd;
    bool ok;

    if (!result) result = &unwanted;
    // The header comes first: it is cheap, and a file of another job need not be read whole.
    *result = (struct gate_result){0};
    ok = image_exr_read(fd, NULL, &result->facts, 1, error) && check_facts(&result->facts, params, error) &&
         check_values(fd, params->thread_count, error) && describe_file(fd, &result->file, error);
    return ok;
}
