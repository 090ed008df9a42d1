// SPDX-License-Identifier: Apache-2.0
#include "cli/verify/verify_ask.h"

#include "cli/peer/worker_child.h"
#include "cli/program/interrupt.h"
#include "cli/program/options.h"
#include "cli/verify/verify_list.h"
#include "core/base/alloc.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 64 }; // files in a request; an interrupt takes effect between two requests

static char *format_params(const struct verify_list *list, size_t first, size_t count, const struct options *options,
                           const char *document)
{
    struct json_writer params = {0};

    json_write_begin_object(&params);
    json_write_key(&params, "files");
    json_write_begin_array(&params);
    for (size_t i = first; i < first + count; i++) {
        char *path = xasprintf("%s/%s", list->folder, list->files[i].name);

        json_write_string(&params, path);
        free(path);
    }
    json_write_end_array(&params);
    if (!isnan(options->tolerance)) json_write_number_member(&params, "tolerance", options->tolerance);
    if (document) {
        json_write_key(&params, "frames");
        json_write_begin_array(&params);
        for (size_t i = first; i < first + count; i++)
            json_write_integer(&params, list->files[i].frame);
        json_write_end_array(&params);
        json_write_key(&params, "document");
        json_write_raw(&params, document, strlen(document));
        json_write_string_member(&params, "root", "/");
    }
    json_write_end_object(&params);
    return params.text;
}

static int read_integer(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    int64_t integer = 0;

    json_read_integer(&node, INT32_MIN, INT32_MAX, &integer, NULL);
    return (int)integer;
}

static void read_hash(const struct json_node *object, const char *key, char hash[static HASH_TEXT_SIZE])
{
    struct json_node node = json_node_child(object, key);
    const char *text;

    if (json_read_string(&node, &text, NULL)) snprintf(hash, HASH_TEXT_SIZE, "%s", text);
}

static void note_answer(struct verify_file *file, const struct json_node *answer)
{
    struct json_node wrong = json_node_child(answer, "wrong"), tolerance = json_node_child(answer, "tolerance");
    struct json_node draft = json_node_child(answer, "draft");
    const char *text;

    if (json_read_string(&wrong, &text, NULL)) verify_file_blame(file, "%s", text);
    file->width_px = read_integer(answer, "width_px");
    file->height_px = read_integer(answer, "height_px");
    file->is_known = file->width_px > 0;
    if (!file->is_known) return;
    file->header_frame = read_integer(answer, "frame");
    read_hash(answer, "picture_hash", file->picture_hash);
    read_hash(answer, "sequence_hash", file->sequence_hash);
    json_read_number(&tolerance, 0, HUGE_VAL, &file->tolerance, NULL);
    json_read_bool(&draft, &file->is_draft, NULL);
    frame_accuracy_read(&file->accuracy, answer, NULL);
    (void)job_beyond_read(&file->beyond, answer, NULL);
}

static enum exit_status ask_batch(struct worker_child *child, struct verify_list *list, size_t first, size_t count,
                                  const char *params, struct error *error)
{
    struct message reply;
    enum exit_status status = worker_child_call(child, "worker.verify", params, &reply, error);
    struct json_node answers, answer = {0};

    if (status != EXIT_STATUS_DONE) return status;
    answers = json_node_child(&reply.body, "files");
    for (size_t i = first; i < first + count && json_node_next(&answers, &answer); i++)
        note_answer(&list->files[i], &answer);
    if (!json_check_array(&answers, count, count, error)) status = EXIT_STATUS_FAILED;
    message_finish(&reply);
    return status;
}

enum exit_status verify_ask(struct verify_list *list, const struct options *options, const char *document,
                            struct error *error)
{
    enum exit_status status = EXIT_STATUS_DONE;
    struct worker_child child = {0};
    struct interrupt interrupt;

    if (list->count == 0) return status;
    interrupt_init(&interrupt);
    if (!worker_child_start_without_gl(&child, options, &interrupt, error)) status = EXIT_STATUS_FAILED;
    for (size_t first = 0; first < list->count && status == EXIT_STATUS_DONE; first += BATCH) {
        size_t count = list->count - first < BATCH ? list->count - first : BATCH;
        char *params = format_params(list, first, count, options, document);

        status = ask_batch(&child, list, first, count, params, error);
        free(params);
    }
    worker_child_stop(&child, status != EXIT_STATUS_DONE);
    interrupt_finish(&interrupt);
    return status;
}
