// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_json.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_check.h"
#include "core/job/job_hash.h"
#include "core/job/job_notes.h"
#include "core/job/job_notify.h"
#include "core/job/quality_json.h"
#include "core/job/schedule_json.h"
#include "core/scene/scene_json.h"

#include <math.h>
#include <string.h>

static const int64_t FPS_PART_MAX = 1000 * 1000 * 1000; // fits the EXR attribute's 32 bits
static const double FPS_MAX = 1000.0;
static const double FPS_DECIMALS = 1e6;
static const double TIME_MAX = 1e9; // s

static bool read_version(const struct json_node *document, struct error *error)
{
    struct json_node node = json_node_child(document, "version");
    int64_t version;

    if (json_read_integer(&node, JOB_VERSION, JOB_VERSION, &version, NULL)) return true;
    return json_fail_expected(&node, error, "1");
}

static bool read_name(struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node node = json_node_child(document, "name");
    const char *text;

    if (!json_read_string(&node, &text, error)) return false;
    if (!*text || strlen(text) > JOB_NAME_LIMIT || !job_notes_is_printable(text))
        return json_fail_expected(&node, error, "1 to 128 printable bytes");
    job->name = xstrdup(text);
    return true;
}

static bool read_frames(struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node node = json_node_child(document, "frames");
    struct error cause = {0};
    const char *text;

    if (!json_read_string(&node, &text, error)) return false;
    if (frame_range_parse(&job->frames, text, &cause)) return true;
    return json_fail(&node, error, "%s", cause.message);
}

static void set_fps(struct job *job, int64_t numerator, int64_t denominator)
{
    int64_t a = numerator, b = denominator;

    while (b != 0) {
        int64_t remainder = a % b;

        a = b;
        b = remainder;
    }
    job->fps_numerator = numerator / a;
    job->fps_denominator = denominator / a;
}

static bool read_fps(struct job *job, const struct json_node *document, struct error *error)
{
    static const char expected[] = "a number in (0, 1000] with at most 6 decimals, or [numerator, denominator]";
    struct json_node node = json_node_child(document, "fps");
    struct json_node over = json_node_element(&node, 0), under = json_node_element(&node, 1);
    int64_t numerator, denominator;
    double fps, scaled;

    if (json_node_type(&node) == JSON_ARRAY && json_node_count(&node) == 2) {
        if (!json_read_integer(&over, 1, FPS_PART_MAX, &numerator, error) ||
            !json_read_integer(&under, 1, FPS_PART_MAX, &denominator, error))
            return false;
        if ((double)numerator > FPS_MAX * (double)denominator)
            return json_fail_expected(&node, error, "at most 1000 frames a second");
        set_fps(job, numerator, denominator);
        return true;
    }
    if (json_node_type(&node) != JSON_NUMBER || !json_read_number(&node, 1.0 / FPS_DECIMALS, FPS_MAX, &fps, NULL))
        return json_fail_expected(&node, error, expected);
    scaled = round(fps * FPS_DECIMALS);
    if (scaled / FPS_DECIMALS != fps) return json_fail_expected(&node, error, expected);
    set_fps(job, (int64_t)scaled, (int64_t)FPS_DECIMALS);
    return true;
}

static bool read_resolution(struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node node = json_node_child(document, "resolution");
    struct json_node first = json_node_element(&node, 0), second = json_node_element(&node, 1);
    int64_t width, height;

    if (json_node_type(&node) != JSON_ARRAY || json_node_count(&node) != 2)
        return json_fail_expected(&node, error, "[width, height] in pixels");
    if (!json_read_integer(&first, 1, JOB_RESOLUTION_LIMIT, &width, error) ||
        !json_read_integer(&second, 1, JOB_RESOLUTION_LIMIT, &height, error))
        return false;
    if (width * height > JOB_PIXEL_LIMIT)
        return json_fail(&node, error, "expected at most %d pixels in all, got %d", JOB_PIXEL_LIMIT,
                         (int)(width * height));
    job->width_px = (int)width;
    job->height_px = (int)height;
    return true;
}

static bool read_aovs(struct job_output *output, const struct json_node *node, struct error *error)
{
    static const char *const names[] = {"Z", "transmittance", NULL};
    struct json_node child = {0};
    int choice;

    if (json_node_is_absent(node)) return true;
    if (!json_check_array(node, 0, 2, error)) return false;
    while (json_node_next(node, &child)) {
        bool *has;

        if (!json_read_enum(&child, names, &choice, error)) return false;
        has = choice == 0 ? &output->has_depth : &output->has_transmittance;
        if (*has) return json_fail(&child, error, "\"%s\" is there twice", names[choice]);
        *has = true;
    }
    return true;
}

static bool read_path(struct job_output *output, const struct json_node *node, const char *output_root,
                      struct error *error)
{
    struct error cause = {0};
    const char *pattern;

    if (!json_read_string(node, &pattern, error)) return false;
    output->path_is_absolute = *pattern == '/';
    if (output_root) pattern = output_path_below(pattern, output_root, &cause);
    if (pattern && output_path_parse(&output->path, pattern, &cause)) return true;
    return json_fail(node, error, "%s", cause.message);
}

// An absent key leaves `*choice` unchanged.
static bool read_choice(const struct json_node *object, const char *key, const char *const names[], int *choice,
                        struct error *error)
{
    struct json_node node = json_node_child(object, key);

    return json_node_is_absent(&node) || json_read_enum(&node, names, choice, error);
}

static bool read_output(struct job_output *output, const struct json_node *document, const char *output_root,
                        struct error *error)
{
    static const char *const keys[] = {"path", "pixel", "compression", "aovs", "existing", NULL};
    static const char *const pixels[] = {"half", "float", NULL};
    static const char *const compressions[] = {"none", "rle", "zips", "zip", "piz", NULL};
    static const char *const existings[] = {"verify", "overwrite", "fail", NULL};
    struct json_node node = json_node_child(document, "output"), path = json_node_child(&node, "path");
    struct json_node aovs = json_node_child(&node, "aovs");
    int pixel = JOB_PIXEL_HALF, compression = JOB_COMPRESSION_ZIP, existing = JOB_EXISTING_VERIFY;

    if (!json_check_object(&node, error) || !json_check_keys(&node, keys, error) ||
        !read_path(output, &path, output_root, error) || !read_choice(&node, "pixel", pixels, &pixel, error) ||
        !read_choice(&node, "compression", compressions, &compression, error) ||
        !read_choice(&node, "existing", existings, &existing, error) || !read_aovs(output, &aovs, error))
        return false;
    output->pixel = (enum job_pixel)pixel;
    output->compression = (enum job_compression)compression;
    output->existing = (enum job_existing)existing;
    return true;
}

// What random paths of a scene of objects alone fly through.
static void add_vacuum(struct job *job)
{
    bool has_walks = job->scene.orders > 1 || job->quality.method == JOB_METHOD_PATHS;

    if (has_walks && job->scene.object_count > 0 && job->scene.medium_count == 0) scene_add_vacuum(&job->scene);
}

static bool read_job(struct job *job, const struct json_node *document, const char *output_root, struct error *error)
{
    static const char *const keys[] = {"version",  "name",   "frames",      "fps",   "time_offset", "resolution",
                                       "camera",   "lights", "background",  "scene", "quality",     "output",
                                       "priority", "order",  "frame_limit", "pool",  "after",       "comment",
                                       "tags",     "notify", NULL};
    struct json_node time_offset = json_node_child(document, "time_offset");
    struct scene_times times;

    if (!json_check_object(document, error) || !read_version(document, error) ||
        !json_check_keys(document, keys, error) || !read_name(job, document, error) ||
        !read_frames(job, document, error) || !read_fps(job, document, error) || !read_resolution(job, document, error))
        return false;
    if (!json_node_is_absent(&time_offset) &&
        !json_read_number(&time_offset, -TIME_MAX, TIME_MAX, &job->time_offset, error))
        return false;
    if (!schedule_from_json(job, document, error) || !job_after_from_json(&job->after, document, error) ||
        !job_notes_from_json(&job->notes, document, error) || !job_notify_from_json(&job->notify, document, error))
        return false;
    times = (struct scene_times){job_time_span(job), (double)job->fps_denominator / (double)job->fps_numerator};
    if (!scene_from_json(&job->scene, document, &times, error) || !quality_from_json(&job->quality, document, error) ||
        !read_output(&job->output, document, output_root, error))
        return false;
    add_vacuum(job);
    return job_check(job, document, error);
}

bool job_from_json(struct job *job, const struct json_node *document, const char *output_root, struct error *error)
{
    *job = (struct job){0};
    if (read_job(job, document, output_root, error)) {
        job_hash_picture(job, job->hash);
        return true;
    }
    job_finish(job);
    return false;
}

bool job_parse(struct job *job, const char *text, size_t length, const char *output_root, struct error *error)
{
    struct cJSON *root = NULL;
    struct json_node document;
    bool ok = false;

    *job = (struct job){0};
    if (length > JOB_DOCUMENT_LIMIT) {
        error_set(error, "expected a job of at most %d bytes, got %zu", JOB_DOCUMENT_LIMIT, length);
        goto out;
    }
    if (!json_parse(&root, text, length, error)) goto out;
    document = json_node_root(root);
    ok = job_from_json(job, &document, output_root, error);
out:
    json_delete(root);
    return ok;
}
