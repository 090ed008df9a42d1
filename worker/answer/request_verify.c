// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/request_verify.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "worker/audit/gate.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/scene/scene_inputs.h"

#include <stdlib.h>
#include <unistd.h>

enum { FILE_LIMIT = 1000 };

struct verification {
    const struct job *job; // borrowed; NULL: each file is checked against its own header
    struct scene_files files;
    double tolerance; // replaces the job's and the header's; 0: neither is replaced
};

static bool check_against_job(const struct verification *verification, int fd, int32_t frame,
                              struct image_exr_facts *facts, struct error *error)
{
    struct gate_params params = {
        .fd = fd, .job = verification->job, .frame = frame, .tolerance = verification->tolerance};
    struct scene_inputs inputs = {0};
    struct gate_result result = {0};
    bool ok = scene_inputs_open(&inputs, verification->job, frame, &verification->files, NULL, error);

    params.picture_hash = inputs.picture_hash;
    if (ok) ok = gate_check(&params, &result, error);
    *facts = result.facts;
    scene_inputs_finish(&inputs);
    return ok;
}

static bool check_alone(const struct verification *verification, int fd, struct image_exr_facts *facts,
                        struct error *error)
{
    struct image image = {0};
    bool ok;

    if (!image_exr_read(fd, NULL, facts, 1, error)) return false;
    if (!facts->job_hash[0]) {
        error_set(error, "marchd:jobHash: expected the hash of a picture, got nothing");
        return false;
    }
    ok = image_exr_read(fd, &image, NULL, 1, error) && image_is_finite(&image, false, error);
    image_finish(&image);
    if (!ok) return false;
    // A job that names its method has no tolerance, and its frames no measured error.
    return gate_check_audit(&facts->audit, &(struct gate_tolerance){.given = verification->tolerance}, error);
}

static void write_facts(const struct image_exr_facts *facts, struct json_writer *writer)
{
    struct frame_accuracy accuracy = image_exr_accuracy(facts);

    json_write_integer_member(writer, "width_px", facts->width_px);
    json_write_integer_member(writer, "height_px", facts->height_px);
    json_write_integer_member(writer, "frame", facts->frame);
    json_write_string_member(writer, "picture_hash", facts->job_hash);
    json_write_string_member(writer, "sequence_hash", facts->sequence_hash);
    if (facts->audit.kind != AUDIT_NONE) json_write_number_member(writer, "tolerance", facts->audit.tolerance);
    if (facts->is_draft) json_write_bool_member(writer, "draft", true);
    frame_accuracy_write(&accuracy, writer);
    job_beyond_write(&facts->beyond, writer);
}

static void write_file(const struct verification *verification, const char *path, int32_t frame,
                       struct json_writer *writer)
{
    struct image_exr_facts facts = {0};
    struct error error = {0};
    int fd = request_open_file(path, 0, &error);
    bool ok = fd >= 0 && (verification->job ? check_against_job(verification, fd, frame, &facts, &error)
                                            : check_alone(verification, fd, &facts, &error));

    if (fd >= 0) close(fd);
    json_write_begin_object(writer);
    json_write_string_member(writer, "wrong", ok ? NULL : error.message);
    if (facts.width_px > 0) write_facts(&facts, writer);
    json_write_end_object(writer);
}

static bool write_files(const struct verification *verification, const struct json_node *params,
                        const struct request_tools *tools, struct json_writer *writer, struct error *error)
{
    struct json_node files = json_node_child(params, "files"), file = {0};
    struct json_node frames = json_node_child(params, "frames"), number = {0};

    if (!json_check_array(&files, 1, FILE_LIMIT, error)) return false;
    if (verification->job && !json_check_array(&frames, json_node_count(&files), json_node_count(&files), error))
        return false;
    json_write_begin_object(writer);
    json_write_key(writer, "files");
    json_write_begin_array(writer);
    while (json_node_next(&files, &file)) {
        const char *path;
        int64_t frame = 0;

        if (!json_read_string(&file, &path, error)) return false;
        if (verification->job && (!json_node_next(&frames, &number) ||
                                  !json_read_integer(&number, 0, FRAME_NUMBER_LIMIT - 1, &frame, error)))
            return false;
        if (tools->is_wanted && !tools->is_wanted(tools->user)) break;
        write_file(verification, path, (int32_t)frame, writer);
    }
    json_write_end_array(writer);
    json_write_end_object(writer);
    return true;
}

bool request_answer_verify(const struct json_node *params, const struct request_tools *tools,
                           struct json_writer *writer, enum message_code *code, struct error *error)
{
    struct json_node document = json_node_child(params, "document"), tolerance = json_node_child(params, "tolerance");
    struct verification verification = {0};
    struct job job = {0};
    bool ok;

    *code = MESSAGE_CODE_PARAMS;
    if (!json_node_is_absent(&tolerance) && !json_read_number(&tolerance, 0, 1, &verification.tolerance, error))
        return false;
    if (!json_node_is_absent(&document)) {
        if (!request_read_job(params, &job, error)) return false;
        verification.job = &job;
    }
    scene_files_init(&verification.files);
    ok = write_files(&verification, params, tools, writer, error);
    scene_files_finish(&verification.files);
    job_finish(&job);
    return ok;
}
