// SPDX-License-Identifier: Apache-2.0
#include "daemon/slurm/slurm_text.h"

#include "core/base/error.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { ID_DIGITS = 10, FIELD_COUNT = 6 };

static const char heading[] = "JOBID|STATE|NODELIST|TIME_LEFT|NAME|REASON";

static const struct {
    const char *state;
    enum slurm_phase phase;
} states[] = {{"PENDING", SLURM_WAITS},     {"CONFIGURING", SLURM_WAITS},     {"REQUEUED", SLURM_WAITS},
              {"RUNNING", SLURM_RUNS},      {"COMPLETING", SLURM_ENDS},       {"COMPLETED", SLURM_IS_OVER},
              {"CANCELLED", SLURM_IS_OVER}, {"FAILED", SLURM_IS_OVER},        {"TIMEOUT", SLURM_IS_OVER},
              {"DEADLINE", SLURM_IS_OVER},  {"NODE_FAIL", SLURM_IS_OVER},     {"PREEMPTED", SLURM_IS_OVER},
              {"REVOKED", SLURM_IS_OVER},   {"OUT_OF_MEMORY", SLURM_IS_OVER}, {"BOOT_FAIL", SLURM_IS_OVER}};

// Cuts off what comes before `end`, a number of at most ID_DIGITS digits. NULL: there is none.
static const char *read_number(const char *text, int64_t *number)
{
    const char *start = text;

    *number = 0;
    while (*text >= '0' && *text <= '9' && text - start < ID_DIGITS)
        *number = *number * 10 + (*text++ - '0');
    return text > start ? text : NULL;
}

bool slurm_read_job(const char *text, int64_t *job, struct error *error)
{
    const char *end = read_number(text, job), *newline = strchr(text, '\n');

    if (end && *job > 0 && newline && newline[1] == '\0' && (*end == '\n' || *end == ';')) return true;
    error_set(error, "expected a job's id, got \"%.*s\"", (int)strcspn(text, "\n") > 60 ? 60 : (int)strcspn(text, "\n"),
              text);
    return false;
}

bool slurm_read_time(const char *text, int64_t *seconds, struct error *error)
{
    static const char *const words[] = {"UNLIMITED", "NOT_SET", "INVALID"};
    int64_t days = 0, parts[3] = {0};
    const char *end = strchr(text, '-') ? read_number(text, &days) : text - 1;
    int count = 0;

    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcmp(text, words[i]) != 0) continue;
        *seconds = SLURM_NO_LIMIT;
        return true;
    }
    while (end && count < 3 && (count == 0 || *end == ':') && (end = read_number(end + 1, &parts[count])))
        count++;
    if (!end || *end || count < 2) {
        error_set(error, "expected a time, got \"%.40s\"", text);
        return false;
    }
    *seconds = days * 86400 + (count == 3 ? parts[0] * 3600 + parts[1] * 60 + parts[2] : parts[0] * 60 + parts[1]);
    return true;
}

static bool read_row(char *line, struct slurm_row *row, struct error *error)
{
    char *fields[FIELD_COUNT];
    const char *end;

    for (int i = 0; i < FIELD_COUNT; i++) {
        fields[i] = i < FIELD_COUNT - 1 ? strsep(&line, "|") : line; // a reason may hold any character
        if (fields[i]) continue;
        error_set(error, "expected %d fields", FIELD_COUNT);
        return false;
    }
    *row = (struct slurm_row){
        .phase = SLURM_OTHER, .state = fields[1], .machine = fields[2], .name = fields[4], .reason = fields[5]};
    end = read_number(fields[0], &row->job);
    if (!end || *end || row->job == 0) {
        error_set(error, "expected a job's id, got \"%.40s\"", fields[0]);
        return false;
    }
    for (size_t i = 0; i < sizeof states / sizeof states[0]; i++)
        if (strcmp(row->state, states[i].state) == 0) row->phase = states[i].phase;
    return slurm_read_time(fields[3], &row->left_s, error);
}

bool slurm_read_rows(char *text, bool (*take)(void *user, const struct slurm_row *row, struct error *error), void *user,
                     struct error *error)
{
    size_t length = strlen(text);
    struct slurm_row row;
    char *line;
    int number = 1;

    if (length == 0 || text[length - 1] != '\n') {
        error_set(error, "squeue: its answer is cut off");
        return false;
    }
    text[length - 1] = '\0';
    line = strsep(&text, "\n");
    if (strcmp(line, heading) != 0) {
        error_set(error, "squeue: expected \"%s\", got \"%.60s\"", heading, line);
        return false;
    }
    while ((line = strsep(&text, "\n"))) {
        number++;
        if (read_row(line, &row, error) && take(user, &row, error)) continue;
        error_prefix(error, "squeue: line %d", number);
        return false;
    }
    return true;
}
