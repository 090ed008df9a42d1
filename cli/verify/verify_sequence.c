// SPDX-License-Identifier: Apache-2.0
#include "cli/verify/verify_sequence.h"

#include "cli/verify/verify_list.h"
#include "core/base/alloc.h"
#include "core/job/frame_range.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Frame numbers as text, in ascending order: "0-9,12-20x2".
struct spans {
    FILE *out;
    char *text;
    size_t length;
    int64_t first, last, step, count; // of the span that may still grow
};

static void spans_init(struct spans *spans)
{
    *spans = (struct spans){0};
    spans->out = open_memstream(&spans->text, &spans->length);
    if (!spans->out) abort();
}

static void end_span(struct spans *spans)
{
    const char *comma = ftell(spans->out) > 0 ? "," : "";

    if (spans->count == 0) return;
    fprintf(spans->out, "%s%" PRId64, comma, spans->first);
    if (spans->count > 2 || (spans->count == 2 && spans->step == 1)) {
        fprintf(spans->out, "-%" PRId64, spans->last);
        if (spans->step > 1) fprintf(spans->out, "x%" PRId64, spans->step);
    } else if (spans->count == 2) {
        fprintf(spans->out, ",%" PRId64, spans->last);
    }
    spans->count = 0;
}

// Ends a pair that turned out to be no span: its second number may begin one.
static void split_pair(struct spans *spans)
{
    int64_t last = spans->last;

    spans->count = 1;
    end_span(spans);
    spans->first = last;
    spans->count = 1;
}

// Adds `count` numbers from `first` on.
static void spans_add(struct spans *spans, int64_t first, int64_t step, int64_t count)
{
    int64_t gap = first - spans->last;

    if (spans->count == 2 && spans->step > 1 && gap != spans->step) split_pair(spans);
    if (spans->count > 0 && (count == 1 || step == gap) && (spans->count == 1 || spans->step == gap)) {
        spans->step = gap;
        spans->count += count;
    } else {
        end_span(spans);
        spans->first = first;
        spans->step = step;
        spans->count = count;
    }
    spans->last = first + (count - 1) * step;
}

static char *spans_finish(struct spans *spans)
{
    end_span(spans);
    fclose(spans->out);
    return spans->text;
}

static int64_t common_divisor(int64_t a, int64_t b)
{
    while (b != 0) {
        int64_t rest = a % b;

        a = b;
        b = rest;
    }
    return a;
}

// Millions of frames may be missing between two files: they are counted, not listed.
static void find_gaps(struct verify_sequence *sequence, const struct verify_file *files, struct spans *missing)
{
    int64_t step = 0;

    for (size_t i = 1; i < sequence->file_count; i++)
        step = common_divisor((int64_t)files[i].frame - files[i - 1].frame, step);
    for (size_t i = 1; i < sequence->file_count && step > 0; i++) {
        int64_t count = ((int64_t)files[i].frame - files[i - 1].frame) / step - 1;

        if (count < 1) continue;
        spans_add(missing, files[i - 1].frame + step, step, count);
        sequence->missing_count += count;
    }
}

static int compare_frames(const void *left, const void *right)
{
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;

    return (a > b) - (a < b);
}

static void find_missing(struct verify_sequence *sequence, const struct verify_file *files,
                         const struct frame_range *range, struct spans *missing)
{
    size_t count = (size_t)frame_range_count(range), next = 0;
    int32_t *wanted = xmalloc((count + 1) * sizeof *wanted);

    for (size_t i = 0; i < count; i++)
        wanted[i] = frame_range_at(range, (int64_t)i);
    qsort(wanted, count, sizeof *wanted, compare_frames);
    for (size_t i = 0; i < count; i++) {
        while (next < sequence->file_count && files[next].frame < wanted[i])
            next++;
        if (next < sequence->file_count && files[next].frame == wanted[i]) continue;
        spans_add(missing, wanted[i], 1, 1);
        sequence->missing_count++;
    }
    free(wanted);
}

static void list_frames(struct verify_sequence *sequence, const struct verify_file *files,
                        const struct frame_range *range)
{
    struct spans found, missing;

    spans_init(&found);
    spans_init(&missing);
    for (size_t i = 0; i < sequence->file_count; i++)
        if (files[i].frame >= 0 && (i == 0 || files[i].frame != files[i - 1].frame))
            spans_add(&found, files[i].frame, 1, 1);
    if (range)
        find_missing(sequence, files, range, &missing);
    else
        find_gaps(sequence, files, &missing);
    sequence->frames = spans_finish(&found);
    sequence->missing = spans_finish(&missing);
}

struct vote {
    const char *text;
    size_t file;
};

static int compare_votes(const void *left, const void *right)
{
    const struct vote *a = left, *b = right;
    int order = strcmp(a->text, b->text);

    return order ? order : (a->file > b->file) - (a->file < b->file);
}

// Blames the files whose text differs from the most frequent one; in a tie the text of the earliest file is right.
// Files with an unknown text (NULL) are not blamed.
static void blame_odd_ones(struct verify_file *files, size_t file_count, char *const texts[], const char *what)
{
    struct vote *votes = xcalloc(file_count + 1, sizeof *votes);
    size_t count = 0, most = 0, usual = 0;

    for (size_t i = 0; i < file_count; i++)
        if (texts[i]) votes[count++] = (struct vote){texts[i], i};
    qsort(votes, count, sizeof *votes, compare_votes);
    for (size_t first = 0, next; first < count; first = next) {
        for (next = first; next < count && !strcmp(votes[first].text, votes[next].text);)
            next++;
        if (next - first < most || (next - first == most && votes[first].file > votes[usual].file)) continue;
        most = next - first;
        usual = first;
    }
    for (size_t i = 0; i < count; i++)
        if (strcmp(votes[i].text, votes[usual].text) != 0)
            verify_file_blame(&files[votes[i].file], "%s %s, most files of the sequence have %s", what, votes[i].text,
                              votes[usual].text);
    free(votes);
}

// Where a job has a tolerance, all its frames have an error.
static void blame_unmeasured(struct verify_file *files, size_t file_count)
{
    bool is_measured = false;

    for (size_t i = 0; i < file_count; i++)
        is_measured = is_measured || files[i].accuracy.audit[0];
    for (size_t i = 0; i < file_count && is_measured; i++)
        if (files[i].picture_hash[0] && !files[i].is_draft && !files[i].accuracy.audit[0])
            verify_file_blame(&files[i], "it has no measured error, other files of the sequence have one");
}

static void compare_with_each_other(struct verify_file *files, size_t file_count)
{
    char **sizes = xcalloc(file_count + 1, sizeof *sizes), **jobs = xcalloc(file_count + 1, sizeof *jobs);

    for (size_t i = 0; i < file_count; i++) {
        const char *hash = files[i].sequence_hash[0] ? files[i].sequence_hash : files[i].picture_hash;

        if (!files[i].is_known) continue;
        sizes[i] = xasprintf("%d x %d", files[i].width_px, files[i].height_px);
        if (*hash) jobs[i] = xstrdup(hash);
    }
    blame_odd_ones(files, file_count, sizes, "its size is");
    blame_odd_ones(files, file_count, jobs, "it is of another job, or of another version of it:");
    blame_unmeasured(files, file_count);
    for (size_t i = 0; i < file_count; i++) {
        free(sizes[i]);
        free(jobs[i]);
    }
    free(sizes);
    free(jobs);
}

static void check_frames(struct verify_file *files, size_t file_count)
{
    for (size_t i = 0; i < file_count; i++) {
        struct verify_file *file = &files[i];

        if (i > 0 && file->frame >= 0 && file->frame == files[i - 1].frame)
            verify_file_blame(file, "frame %" PRId32 " is there twice, in %s too", file->frame, files[i - 1].name);
        if (file->is_known && file->picture_hash[0] && file->frame >= 0 && file->frame != file->header_frame)
            verify_file_blame(file, "its name says frame %" PRId32 ", its header %" PRId32, file->frame,
                              file->header_frame);
    }
}

// Replaces the digits of the first file's number by number signs.
static char *find_pattern(const struct verify_file *file)
{
    char *pattern = xstrdup(file->name);

    memset(pattern + file->digits_start, '#', file->digit_count);
    return pattern;
}

void verify_sequence_judge(struct verify_sequence *sequence, struct verify_list *list, size_t first, size_t file_count,
                           const struct verify_expected *expected)
{
    struct verify_file *files = list->files + first;

    *sequence =
        (struct verify_sequence){.first = first, .file_count = file_count, .worst = SIZE_MAX, .most_beyond = SIZE_MAX};
    sequence->pattern = expected->pattern ? xstrdup(expected->pattern) : find_pattern(&files[0]);
    list_frames(sequence, files, expected->range);
    if (!expected->is_job) {
        compare_with_each_other(files, file_count);
        check_frames(files, file_count);
    }
    for (size_t i = first; i < first + file_count; i++) {
        const struct verify_file *file = &list->files[i];

        sequence->wrong_count += file->wrong != NULL;
        sequence->missed_count += file->accuracy.is_missed;
        if (file->accuracy.audit[0] &&
            (sequence->worst == SIZE_MAX || file->accuracy.error > list->files[sequence->worst].accuracy.error))
            sequence->worst = i;
        if (file->beyond.is_known &&
            (sequence->most_beyond == SIZE_MAX || file->beyond.error > list->files[sequence->most_beyond].beyond.error))
            sequence->most_beyond = i;
    }
}

void verify_sequence_finish(struct verify_sequence *sequence)
{
    free(sequence->pattern);
    free(sequence->frames);
    free(sequence->missing);
    *sequence = (struct verify_sequence){0};
}
