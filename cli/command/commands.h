// The verbs of `march`: the operands, options and function of each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct error;
struct json_writer;
struct options;

// Prints data to stdout, all else to stderr. When `error` is set on return, main prints it; nothing on stdout may
// contradict it.
typedef enum exit_status command_run(const struct options *options, struct error *error);

struct command {
    const char *name;
    const char *operands; // as in the help
    size_t operand_min, operand_max;
    uint64_t options; // OPTION_BITs, OPTION_HELP and OPTION_JSON included
    const char *summary;
    const char *example;
    command_run *run;
};

const struct command *command_find(const char *name); // NULL when there is none
const struct command *command_at(size_t index);       // in the order of the help; NULL after the last
void command_fail_unknown(const char *name, struct error *error);
void command_print_help(FILE *out, const struct command *command);
void command_print_overview(FILE *out);
void command_write_overview(struct json_writer *writer); // {"verbs":[{"name","operands","summary"}]}

command_run command_submit, command_list, command_show, command_frames, command_log, command_watch, command_wait;
command_run command_pause, command_resume, command_cancel, command_delete, command_retry, command_prio;
command_run command_workers, command_status, command_metrics, command_drain, command_undrain, command_reload;
command_run command_token, command_web;
command_run command_backup, command_restore;
command_run command_validate, command_render, command_explain, command_chart, command_preview, command_verify;
command_run command_completion, command_version, command_help;
