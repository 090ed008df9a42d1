// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/request_picture.h"

#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/sheet/view.h"

#include <fcntl.h>
#include <math.h>
#include <unistd.h>

enum { EXPOSURE_LIMIT_STOPS = 60 };

static bool is_given(const struct json_node *node)
{
    return !json_node_is_absent(node) && json_node_type(node) != JSON_NULL;
}

static bool read_pixels(const struct json_node *params, const char *key, int min, int max, int *pixels,
                        struct error *error)
{
    struct json_node node = json_node_child(params, key);
    int64_t integer;

    if (!is_given(&node)) return true;
    if (!json_read_integer(&node, min, max, &integer, error)) return false;
    *pixels = (int)integer;
    return true;
}

static bool read_view(const struct json_node *params, struct view_params *view, struct error *error)
{
    struct json_node channel = json_node_child(params, "channel"), exposure = json_node_child(params, "exposure");
    struct json_node out = json_node_child(params, "out");

    view->has_exposure = is_given(&exposure);
    return (!is_given(&channel) || json_read_string(&channel, &view->channel, error)) &&
           (!view->has_exposure ||
            json_read_number(&exposure, -EXPOSURE_LIMIT_STOPS, EXPOSURE_LIMIT_STOPS, &view->exposure, error)) &&
           read_pixels(params, "x", 0, IMAGE_SIDE_LIMIT, &view->x, error) &&
           read_pixels(params, "y", 0, IMAGE_SIDE_LIMIT, &view->y, error) &&
           read_pixels(params, "width", 1, IMAGE_SIDE_LIMIT, &view->width_px, error) &&
           read_pixels(params, "height", 1, IMAGE_SIDE_LIMIT, &view->height_px, error) &&
           read_pixels(params, "size", 1, VIEW_SIZE_LIMIT, &view->size_px, error) &&
           json_read_string(&out, &view->out, error);
}

// Opens the member `file`. A frame is no link: one that somebody put in its place is not followed.
static int open_file(const struct json_node *params, enum message_code *code, struct error *error)
{
    struct json_node node = json_node_child(params, "file");
    const char *path;
    int fd;

    *code = MESSAGE_CODE_PARAMS;
    if (!json_read_string(&node, &path, error)) return -1;
    if (path[0] != '/') {
        json_fail_expected(&node, error, "an absolute path");
        return -1;
    }
    *code = MESSAGE_CODE_INTERNAL;
    fd = request_open_file(path, O_NOFOLLOW, error);
    if (fd < 0) error_prefix(error, "%s", path);
    return fd;
}

static void write_known(struct json_writer *writer, const char *key, double number)
{
    if (!isnan(number)) json_write_number_member(writer, key, number);
}

static void write_view(const struct view_result *result, const struct image_exr_names *names,
                       struct json_writer *writer)
{
    json_write_begin_object(writer);
    json_write_integer_member(writer, "width_px", result->width_px);
    json_write_integer_member(writer, "height_px", result->height_px);
    json_write_integer_member(writer, "file_width_px", result->file_width_px);
    json_write_integer_member(writer, "file_height_px", result->file_height_px);
    write_known(writer, "exposure", result->exposure);
    write_known(writer, "near", result->near);
    write_known(writer, "far", result->far);
    json_write_key(writer, "channels");
    json_write_begin_array(writer);
    for (size_t i = 0; i < names->count; i++)
        json_write_string(writer, names->names[i]);
    json_write_end_array(writer);
    json_write_end_object(writer);
}

bool request_answer_picture(const struct json_node *params, const struct request_tools *tools,
                            struct json_writer *writer, enum message_code *code, struct error *error)
{
    struct view_params view = {.fd = -1};
    struct image_exr_names names = {0};
    struct view_result result;
    enum view_fault fault;
    bool ok;

    *code = MESSAGE_CODE_PARAMS;
    if (!read_view(params, &view, error)) return false;
    view.fd = open_file(params, code, error);
    if (view.fd < 0) return false;
    ok = view_write(&view, &result, &fault, error);
    if (!ok && fault == VIEW_FAULT_PARAMS) *code = MESSAGE_CODE_PARAMS;
    if (!ok && fault == VIEW_FAULT_OUTPUT) *code = MESSAGE_CODE_STORE;
    ok = ok && image_exr_names_read(view.fd, &names, error);
    if (ok) write_view(&result, &names, writer);
    image_exr_names_finish(&names);
    close(view.fd);
    return ok;
}

bool request_answer_header(const struct json_node *params, const struct request_tools *tools,
                           struct json_writer *writer, enum message_code *code, struct error *error)
{
    int fd = open_file(params, code, error);
    bool ok;

    if (fd < 0) return false;
    ok = image_exr_describe(fd, writer, error);
    close(fd);
    return ok;
}
