// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/unseen.h"

#include "core/job/job.h"
#include "core/json/json_write.h"
#include "worker/scene/scene_inputs.h"
#include "worker/scene/scene_visibility.h"

#include <stdio.h>

enum { FRAMES_SEEN = 64, FRAMES_OPENED = 3 }; // spread evenly over the job's

// Volumes whose place only their files say, and which nothing mirrors.
static size_t find_grids(const struct job *job, bool is_asked[static SCENE_MEDIUM_LIMIT], bool *has_sequence)
{
    size_t count = 0;

    *has_sequence = false;
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; i++) {
        const struct scene_density *density = &job->scene.media[i].density;
        bool is_open = density->bounds.kind == SCENE_BOUNDS_NONE || density->bounds.kind == SCENE_BOUNDS_SLAB;

        is_asked[i] = i < job->scene.medium_count && job->scene.object_count == 0 &&
                      density->kind == SCENE_DENSITY_GRID && is_open;
        count += is_asked[i];
        if (is_asked[i] && scene_density_is_sequence(density)) *has_sequence = true;
    }
    return count;
}

// Clears `is_asked` of the media that one of the frames shows. Files that are the same in all frames are opened once.
static bool look(const struct job *job, bool has_sequence, bool is_asked[static SCENE_MEDIUM_LIMIT],
                 struct error *error)
{
    int64_t count = frame_range_count(&job->frames), most = has_sequence ? FRAMES_OPENED : FRAMES_SEEN;
    int64_t seen = count < most ? count : most;
    struct scene_inputs inputs = {0};
    bool ok = true;

    for (int64_t i = 0; i < seen && ok; i++) {
        int32_t frame = frame_range_at(&job->frames, seen > 1 ? i * (count - 1) / (seen - 1) : 0);

        if (has_sequence || i == 0) {
            scene_inputs_finish(&inputs);
            ok = scene_inputs_open(&inputs, job, frame, NULL, NULL, error);
        }
        if (ok) scene_visibility_clear_seen(job, &inputs, frame, is_asked);
    }
    scene_inputs_finish(&inputs);
    return ok;
}

static void write(const struct job *job, bool has_sequence, const bool is_unseen[static SCENE_MEDIUM_LIMIT],
                  struct json_writer *writer)
{
    char place[64], text[256];

    json_write_begin_object(writer);
    json_write_key(writer, "warnings");
    json_write_begin_array(writer);
    for (size_t i = 0; i < job->scene.medium_count; i++) {
        if (!is_unseen[i]) continue;
        scene_format_medium_place(&job->scene, i, place, sizeof place);
        snprintf(text, sizeof text,
                 "%s: %s: the file's volume lies outside of the camera's view or of its clip distances", place,
                 has_sequence ? "neither the first, the middle nor the last frame shows it" : "no frame shows it");
        json_write_string(writer, text);
    }
    json_write_end_array(writer);
    json_write_end_object(writer);
}

bool unseen_answer(const struct json_node *params, const struct request_tools *tools, struct json_writer *writer,
                   enum message_code *code, struct error *error)
{
    bool is_unseen[SCENE_MEDIUM_LIMIT], has_sequence, ok;
    struct job job = {0};

    (void)tools;
    *code = MESSAGE_CODE_PARAMS;
    if (!request_read_job(params, &job, error)) return false;
    *code = MESSAGE_CODE_INTERNAL;
    ok = find_grids(&job, is_unseen, &has_sequence) == 0 || look(&job, has_sequence, is_unseen, error);
    if (ok) write(&job, has_sequence, is_unseen, writer);
    job_finish(&job);
    return ok;
}
