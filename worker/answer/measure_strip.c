// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/measure_requests.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/frame_range.h"
#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "worker/answer/measure.h"
#include "worker/picture/image.h"
#include "worker/sheet/error_strip.h"

#include <stdlib.h>

enum { PICTURE_LIMIT = 64 };

static const double SECONDS_MAX = 86400;

struct strip_request {
    const struct request_tools *tools;
    int32_t frame;
    const char *out;
    struct image *images;                 // owned; `count` and the truth
    struct error_strip_picture *pictures; // owned; likewise
    size_t count;
};

// Renders the picture that `node`, {document, label}, describes.
static bool render(struct strip_request *request, const struct json_node *node, size_t index, enum message_code *code,
                   struct error *error)
{
    struct json_node label = json_node_child(node, "label");
    struct error_strip_picture *picture = &request->pictures[index];
    struct image *image = &request->images[index];
    struct job job = {0};
    double seconds;
    bool ok;

    *code = MESSAGE_CODE_PARAMS;
    if (!json_read_string(&label, &picture->label, error) || !request_read_job(node, &job, error)) return false;
    *code = MESSAGE_CODE_INTERNAL;
    picture->image = image;
    ok = image_init_for_job(image, &job, error) &&
         measure_render(&(struct measure_params){.renderer = request->tools->renderer,
                                                 .job = &job,
                                                 .frame = request->frame,
                                                 .limit_s = SECONDS_MAX,
                                                 .is_wanted = request->tools->is_wanted,
                                                 .user = request->tools->user},
                        image, &seconds, error) == MEASURE_DONE;
    if (ok && (image->width_px != request->images[0].width_px || image->height_px != request->images[0].height_px)) {
        error_set(error, "expected pictures of one size");
        ok = false;
    }
    job_finish(&job);
    return ok;
}

static bool render_all(struct strip_request *request, const struct json_node *params, enum message_code *code,
                       struct error *error)
{
    struct json_node pictures = json_node_child(params, "pictures"), against = json_node_child(params, "against");
    struct json_node picture = {0};

    if (!json_check_array(&pictures, 0, PICTURE_LIMIT, error)) return false;
    request->count = json_node_count(&pictures);
    request->images = xcalloc(request->count + 1, sizeof *request->images);
    request->pictures = xcalloc(request->count + 1, sizeof *request->pictures);
    for (size_t i = 0; json_node_next(&pictures, &picture); i++)
        if (!render(request, &picture, i, code, error)) return false;
    return render(request, &against, request->count, code, error);
}

static bool write_strip(const struct strip_request *request, struct json_writer *writer, struct error *error)
{
    struct error_strip_result result;

    if (!error_strip_write(&(struct error_strip_params){.pictures = request->pictures,
                                                        .count = request->count,
                                                        .truth = request->pictures[request->count],
                                                        .out = request->out},
                           &result, error))
        return false;
    json_write_begin_object(writer);
    json_write_integer_member(writer, "width_px", result.width_px);
    json_write_integer_member(writer, "height_px", result.height_px);
    json_write_number_member(writer, "scale", result.scale);
    json_write_end_object(writer);
    return true;
}

bool measure_answer_strip(const struct json_node *params, const struct request_tools *tools, struct json_writer *writer,
                          enum message_code *code, struct error *error)
{
    struct json_node frame = json_node_child(params, "frame"), out = json_node_child(params, "out");
    struct strip_request request = {.tools = tools};
    int64_t number;
    bool ok;

    *code = MESSAGE_CODE_PARAMS;
    if (!json_read_integer(&frame, 0, FRAME_NUMBER_LIMIT - 1, &number, error) ||
        !json_read_string(&out, &request.out, error))
        return false;
    if (!request_check_renderer(tools, error)) return false;
    request.frame = (int32_t)number;
    ok = render_all(&request, params, code, error) && write_strip(&request, writer, error);
    for (size_t i = 0; request.images && i <= request.count; i++)
        image_finish(&request.images[i]);
    free(request.images);
    free(request.pictures);
    return ok;
}
