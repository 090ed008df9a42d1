// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/film/film.h"
#include "cli/film/sequence.h"
#include "cli/peer/worker_child.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool ends_in(const char *text, const char *end)
{
    size_t length = strlen(text), end_length = strlen(end);

    return length > end_length && strcmp(text + length - end_length, end) == 0;
}

// The absolute path of a file that need not exist, for the worker takes no other.
static char *make_absolute(const char *path, struct error *error)
{
    char *folder, *absolute;

    if (*path == '/') return xstrdup(path);
    folder = realpath(".", NULL);
    if (!folder) {
        error_set_errno(error, errno, "the current folder");
        return NULL;
    }
    absolute = xasprintf("%s/%s", folder, path);
    free(folder);
    return absolute;
}

static void write_sequence(struct json_writer *params, const struct options *options, const struct sequence *sequence)
{
    json_write_key(params, "files");
    json_write_begin_array(params);
    for (size_t i = 0; i < sequence->count; i++)
        json_write_string(params, sequence->files[i].path);
    json_write_end_array(params);
    if (!isnan(options->exposure)) json_write_number_member(params, "exposure", options->exposure);
}

// Prints {"out":..., and the members of the worker's answer}, or only the path.
static void print_made(const struct options *options, const char *out, const struct json_node *result)
{
    struct json_node exposure = json_node_child(result, "exposure"), member = {0};
    struct json_writer writer = {0};
    double stops;

    if (!options->json) {
        printf("%s\n", out);
        if (json_read_number(&exposure, -1e6, 1e6, &stops, NULL)) fprintf(stderr, "exposure %+.2f stops\n", stops);
        return;
    }
    json_write_begin_object(&writer);
    json_write_string_member(&writer, "out", out);
    while (json_node_next(result, &member)) {
        char *text;

        if (strcmp(member.key, "files") == 0) continue; // their folder has been removed
        text = json_node_format(&member);
        json_write_key(&writer, member.key);
        json_write_raw(&writer, text, strlen(text));
        free(text);
    }
    json_write_end_object(&writer);
    print_json_text(&writer);
    json_writer_finish(&writer);
}

static enum exit_status make_sheet(const struct options *options, const struct sequence *sequence, const char *out,
                                   struct error *error)
{
    struct json_writer params = {0};
    struct message reply;
    enum exit_status status;

    json_write_begin_object(&params);
    write_sequence(&params, options, sequence);
    json_write_key(&params, "labels");
    json_write_begin_array(&params);
    for (size_t i = 0; i < sequence->count; i++)
        json_write_string(&params, sequence->files[i].label);
    json_write_end_array(&params);
    if (options->columns > 0) json_write_integer_member(&params, "columns", options->columns);
    if (options->tile_width_px > 0) json_write_integer_member(&params, "tile_width_px", options->tile_width_px);
    json_write_string_member(&params, "out", out);
    json_write_end_object(&params);
    status = worker_child_ask(options, &(struct worker_question){.method = "worker.preview", .params = params.text},
                              &reply, error);
    json_writer_finish(&params);
    if (status != EXIT_STATUS_DONE) return status;
    print_made(options, out, &reply.body);
    message_finish(&reply);
    return status;
}

// What the user says, else what the sequence says, else 24. Owned by the caller.
static char *format_rate(const struct options *options, const struct json_node *result)
{
    struct json_node fps = json_node_child(result, "fps");
    struct json_node over = json_node_element(&fps, 0), under = json_node_element(&fps, 1);
    int64_t numerator, denominator;

    if (!isnan(options->fps)) return xasprintf("%.10g", options->fps);
    if (!json_read_integer(&over, 1, INT32_MAX, &numerator, NULL) ||
        !json_read_integer(&under, 1, UINT32_MAX, &denominator, NULL))
        return xstrdup("24");
    return xasprintf("%" PRId64 "/%" PRId64, numerator, denominator);
}

static enum exit_status make_film(const struct options *options, const struct sequence *sequence, const char *out,
                                  struct error *error)
{
    struct json_writer params = {0};
    struct message reply;
    enum exit_status status = EXIT_STATUS_FAILED;
    char *folder = NULL;

    if (!film_has_ffmpeg(error)) return status;
    folder = film_create_folder(error);
    if (!folder) return status;
    json_write_begin_object(&params);
    write_sequence(&params, options, sequence);
    json_write_string_member(&params, "folder", folder);
    json_write_end_object(&params);
    status = worker_child_ask(options, &(struct worker_question){.method = "worker.frames_png", .params = params.text},
                              &reply, error);
    json_writer_finish(&params);
    if (status == EXIT_STATUS_DONE) {
        char *rate = format_rate(options, &reply.body);

        if (film_encode(folder, rate, out, error))
            print_made(options, out, &reply.body);
        else
            status = EXIT_STATUS_FAILED;
        free(rate);
        message_finish(&reply);
    }
    film_remove_folder(folder);
    free(folder);
    return status;
}

enum exit_status command_preview(const struct options *options, struct error *error)
{
    const char *name = options->out ? options->out : "sheet.png";
    enum exit_status status = EXIT_STATUS_USAGE;
    struct sequence sequence = {0};
    char *out = NULL;

    if (!ends_in(name, ".png") && !ends_in(name, ".mp4")) {
        error_set(error, "--out: expected NAME.png or NAME.mp4, got \"%s\"", name);
        return status;
    }
    if (!isnan(options->fps) && !(options->fps > 0 && options->fps <= 1000)) {
        error_set(error, "--fps: expected a number in (0, 1000], got %g", options->fps);
        return status;
    }
    for (size_t i = 0; i < options->operand_count; i++)
        if (!sequence_add(&sequence, options->operands[i], options->range, error)) goto out;
    out = make_absolute(name, error);
    if (out) status = (ends_in(name, ".mp4") ? make_film : make_sheet)(options, &sequence, out, error);
out:
    sequence_finish(&sequence);
    free(out);
    return status;
}
