// SPDX-License-Identifier: Apache-2.0
#include "cli/verify/verify_print.h"

#include "cli/terminal/print.h"
#include "cli/terminal/table.h"
#include "cli/verify/verify_list.h"
#include "cli/verify/verify_sequence.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>

static bool is_good(const struct verify_sequence *sequence)
{
    return sequence->wrong_count == 0 && sequence->missing_count == 0;
}

bool verify_print_is_good(const struct verify_sequence *sequences, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!is_good(&sequences[i])) return false;
    return true;
}

static void print_wrong(const struct verify_list *list, const struct verify_sequence *sequences, size_t count)
{
    static const struct table_column columns[] = {{"FILE", false}, {"WHAT IS WRONG", false}};
    struct table table = {.columns = columns, .column_count = 2};

    if (verify_print_is_good(sequences, count)) return;
    for (size_t i = 0; i < count; i++) {
        for (size_t k = sequences[i].first; k < sequences[i].first + sequences[i].file_count; k++) {
            if (!list->files[k].wrong) continue;
            table_add(&table, list->files[k].name);
            table_add(&table, list->files[k].wrong);
        }
        if (sequences[i].missing_count == 0) continue;
        table_add(&table, sequences[i].pattern);
        table_add_format(&table, "missing: %s %s", sequences[i].missing_count == 1 ? "frame" : "frames",
                         sequences[i].missing);
    }
    print_table(&table);
    table_finish(&table);
}

static size_t count_drafts(const struct verify_list *list, const struct verify_sequence *sequence)
{
    size_t count = 0;

    for (size_t i = sequence->first; i < sequence->first + sequence->file_count; i++)
        count += list->files[i].is_draft;
    return count;
}

// Frames of jobs that name their method, and of drafts.
static size_t count_unmeasured(const struct verify_list *list, const struct verify_sequence *sequence)
{
    size_t count = 0;

    for (size_t i = sequence->first; i < sequence->first + sequence->file_count; i++)
        count += list->files[i].picture_hash[0] && !list->files[i].accuracy.audit[0];
    return count;
}

// What is left out shows nowhere: said of whole sequences, which are of one job mostly, by their largest.
static void print_beyond(const struct verify_list *list, const struct verify_sequence *sequence)
{
    const struct verify_file *most = sequence->most_beyond == SIZE_MAX ? NULL : &list->files[sequence->most_beyond];
    char error[JOB_BEYOND_PERCENT_SIZE], bound[JOB_BEYOND_PERCENT_SIZE];

    if (!most) return;
    job_beyond_percent(most->beyond.error, error);
    job_beyond_percent(most->beyond.error95, bound);
    printf("; the modelled orders of scattering leave out %s %% (95 %%: below %s %%)", error, bound);
}

static void print_summary(const struct verify_list *list, const struct verify_sequence *sequence)
{
    const struct verify_file *worst = sequence->worst == SIZE_MAX ? NULL : &list->files[sequence->worst];
    size_t drafts = count_drafts(list, sequence), unmeasured = count_unmeasured(list, sequence) - drafts;

    printf("%s: %zu file%s", sequence->pattern, sequence->file_count, sequence->file_count == 1 ? "" : "s");
    if (*sequence->frames) printf(", frames %s", sequence->frames);
    if (worst) {
        char text[FRAME_ACCURACY_PHRASE_SIZE];

        frame_accuracy_describe(&worst->accuracy, text);
        printf("; worst error %s", text);
        if (worst->tolerance > 0) printf(" of %.2g %%", 100 * worst->tolerance);
        printf(" in %s", worst->name);
    }
    print_beyond(list, sequence);
    if (sequence->missed_count > 0) printf("; %zu published over the tolerance", sequence->missed_count);
    if (drafts > 0) printf("; %zu draft%s, of no promised accuracy", drafts, drafts == 1 ? "" : "s");
    if (!worst && unmeasured > 0)
        printf("; %zu whose error was not measured, for %s job states its method", unmeasured,
               unmeasured == 1 ? "its" : "their");
    if (is_good(sequence))
        printf("; all well\n");
    else
        printf("; %zu wrong, %" PRId64 " missing\n", sequence->wrong_count, sequence->missing_count);
}

void verify_print_text(const struct verify_list *list, const struct verify_sequence *sequences, size_t count)
{
    print_wrong(list, sequences, count);
    for (size_t i = 0; i < count; i++)
        print_summary(list, &sequences[i]);
    if (list->part_count > 0)
        printf("%zu file%s being written (.part) left out\n", list->part_count, list->part_count == 1 ? "" : "s");
}

static void write_sequence(const struct verify_list *list, const struct verify_sequence *sequence,
                           struct json_writer *writer)
{
    const struct verify_file *worst = sequence->worst == SIZE_MAX ? NULL : &list->files[sequence->worst];

    json_write_begin_object(writer);
    json_write_string_member(writer, "pattern", sequence->pattern);
    json_write_bool_member(writer, "good", is_good(sequence));
    json_write_integer_member(writer, "files", (int64_t)sequence->file_count);
    json_write_string_member(writer, "frames", sequence->frames);
    json_write_integer_member(writer, "wrong", (int64_t)sequence->wrong_count);
    json_write_integer_member(writer, "missed", (int64_t)sequence->missed_count);
    json_write_integer_member(writer, "missing", sequence->missing_count);
    json_write_string_member(writer, "missing_frames", sequence->missing);
    json_write_integer_member(writer, "drafts", (int64_t)count_drafts(list, sequence));
    json_write_integer_member(writer, "unmeasured", (int64_t)count_unmeasured(list, sequence));
    if (worst) {
        json_write_number_member(writer, "worst_error", worst->accuracy.error);
        json_write_number_member(writer, "worst_error95", worst->accuracy.error95);
        json_write_string_member(writer, "worst_file", worst->name);
    }
    if (sequence->most_beyond != SIZE_MAX) job_beyond_write(&list->files[sequence->most_beyond].beyond, writer);
    json_write_end_object(writer);
}

static void write_file(const struct verify_file *file, struct json_writer *writer)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "file", file->name);
    if (file->frame >= 0) json_write_integer_member(writer, "frame", file->frame);
    json_write_string_member(writer, "wrong", file->wrong);
    if (file->tolerance > 0) json_write_number_member(writer, "tolerance", file->tolerance);
    if (file->is_draft) json_write_bool_member(writer, "draft", true);
    frame_accuracy_write(&file->accuracy, writer);
    job_beyond_write(&file->beyond, writer);
    json_write_end_object(writer);
}

void verify_print_json(const struct verify_list *list, const struct verify_sequence *sequences, size_t count)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    json_write_string_member(&writer, "folder", list->folder);
    json_write_bool_member(&writer, "good", verify_print_is_good(sequences, count));
    json_write_integer_member(&writer, "being_written", (int64_t)list->part_count);
    json_write_key(&writer, "sequences");
    json_write_begin_array(&writer);
    for (size_t i = 0; i < count; i++)
        write_sequence(list, &sequences[i], &writer);
    json_write_end_array(&writer);
    json_write_key(&writer, "files");
    json_write_begin_array(&writer);
    for (size_t i = 0; i < list->count; i++)
        write_file(&list->files[i], &writer);
    json_write_end_array(&writer);
    json_write_end_object(&writer);
    print_json_text(&writer);
    json_writer_finish(&writer);
}
