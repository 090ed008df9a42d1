// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/job/job_document.h"
#include "cli/job/json_set.h"
#include "cli/program/options.h"
#include "cli/render/output_root.h"
#include "cli/verify/verify_ask.h"
#include "cli/verify/verify_list.h"
#include "cli/verify/verify_names.h"
#include "cli/verify/verify_print.h"
#include "cli/verify/verify_sequence.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/frame_range.h"
#include "core/job/job.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static enum exit_status report(const struct options *options, const struct verify_list *list,
                               const struct verify_sequence sequences[], size_t count)
{
    (options->json ? verify_print_json : verify_print_text)(list, sequences, count);
    return verify_print_is_good(sequences, count) ? EXIT_STATUS_DONE : EXIT_STATUS_FAILED;
}

// The files must be sorted by sequence.
static enum exit_status judge_sequences(const struct options *options, struct verify_list *list, size_t count,
                                        const struct frame_range *range)
{
    const struct verify_expected expected = {.range = range};
    struct verify_sequence *sequences = xcalloc(count + 1, sizeof *sequences);
    enum exit_status status;

    for (size_t i = 0, first = 0, next; i < count; i++, first = next) {
        for (next = first; next < list->count && list->files[next].sequence == i;)
            next++;
        verify_sequence_judge(&sequences[i], list, first, next - first, &expected);
    }
    status = report(options, list, sequences, count);
    for (size_t i = 0; i < count; i++)
        verify_sequence_finish(&sequences[i]);
    free(sequences);
    return status;
}

static enum exit_status verify_folder(const struct options *options, const char *folder, struct error *error)
{
    enum exit_status status = EXIT_STATUS_USAGE;
    struct verify_list list = {0};
    struct frame_range range = {0};

    if (options->out || options->set_count > 0) {
        error_set(error, "%s: --out and --set are for a job file, and this is a folder", folder);
        goto out;
    }
    if (options->range && !frame_range_parse(&range, options->range, error)) {
        error_prefix(error, "--frames");
        goto out;
    }
    status = EXIT_STATUS_FAILED;
    if (!verify_list_read(&list, folder, error)) goto out;
    if (list.count == 0) {
        error_set(error, "%s: there is no EXR file", folder);
        goto out;
    }
    status = verify_ask(&list, options, NULL, error);
    if (status == EXIT_STATUS_DONE)
        status = judge_sequences(options, &list, verify_names_sort(&list), options->range ? &range : NULL);
out:
    verify_list_finish(&list);
    frame_range_finish(&range);
    return status;
}

static int compare_frames(const void *left, const void *right)
{
    const struct verify_file *a = left, *b = right;

    return (a->frame > b->frame) - (a->frame < b->frame);
}

// A missing folder has none of the frames.
static bool read_files_of(struct verify_list *list, const struct job *job, const char *root, struct error *error)
{
    const struct output_path *path = &job->output.path;
    char *folder = xasprintf("%s%s%s", root, *path->folder ? "/" : "", path->folder);
    bool ok = true;

    if (access(folder, F_OK) != 0 && errno == ENOENT)
        *list = (struct verify_list){.folder = xstrdup(folder)};
    else
        ok = verify_list_read(list, folder, error);
    free(folder);
    verify_list_keep(list, path, &job->frames);
    if (list->count > 0) qsort(list->files, list->count, sizeof *list->files, compare_frames);
    return ok;
}

static enum exit_status verify_frames(const struct options *options, const struct job *job, const char *document,
                                      const char *root, struct error *error)
{
    struct verify_sequence sequence = {0};
    struct verify_list list = {0};
    enum exit_status status = EXIT_STATUS_FAILED;
    struct verify_expected expected = {.range = &job->frames, .is_job = true};
    char *pattern = xasprintf("%s%0*d%s", job->output.path.prefix, job->output.path.pad, 0, job->output.path.suffix);

    memset(pattern + strlen(job->output.path.prefix), '#', (size_t)job->output.path.pad);
    expected.pattern = pattern;
    if (read_files_of(&list, job, root, error)) status = verify_ask(&list, options, document, error);
    if (status == EXIT_STATUS_DONE) {
        verify_sequence_judge(&sequence, &list, 0, list.count, &expected);
        status = report(options, &list, &sequence, 1);
    }
    verify_sequence_finish(&sequence);
    verify_list_finish(&list);
    free(pattern);
    return status;
}

// Refuses EXR files, by their first bytes.
static bool check_is_text(const char *path, struct error *error)
{
    static const unsigned char magic[] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char first[sizeof magic] = {0};
    FILE *file = fopen(path, "re");
    size_t count = file ? fread(first, 1, sizeof first, file) : 0;

    if (file) fclose(file);
    if (count < sizeof magic || memcmp(first, magic, sizeof magic) != 0) return true;
    error_set(error, "%s: expected a folder of EXR files or a job file, got an EXR file", path);
    return false;
}

static enum exit_status verify_job(const struct options *options, const char *path, struct error *error)
{
    char *document = job_document_load(path, options->sets, options->set_count, error);
    enum exit_status status = EXIT_STATUS_USAGE;
    struct job job = {0};
    char *root = NULL;

    if (!document) goto out;
    if (options->range && !json_set_text(&document, "frames", options->range, error)) goto out;
    root = output_root_choose(options->out, false, &document, error);
    // An absolute path may be below a farm's output root, which is unknown here.
    if (root && job_document_check(path, document, "/", &job, error))
        status = verify_frames(options, &job, document, job.output.path_is_absolute ? "" : root, error);
out:
    job_finish(&job);
    free(document);
    free(root);
    return status;
}

enum exit_status command_verify(const struct options *options, struct error *error)
{
    const char *operand = options->operands[0];
    struct stat entry;

    if (!isnan(options->tolerance) && !(options->tolerance > 0 && options->tolerance <= 1)) {
        error_set(error, "--tolerance: expected a number in (0, 1], got %g", options->tolerance);
        return EXIT_STATUS_USAGE;
    }
    if (stat(operand, &entry) == 0 && S_ISDIR(entry.st_mode)) return verify_folder(options, operand, error);
    if (stat(operand, &entry) == 0 && S_ISREG(entry.st_mode) && !check_is_text(operand, error))
        return EXIT_STATUS_USAGE;
    return verify_job(options, operand, error);
}
