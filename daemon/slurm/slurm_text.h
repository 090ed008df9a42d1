// What Slurm's commands print, read strictly. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;

enum { SLURM_NO_LIMIT = -1 };

enum slurm_phase {
    SLURM_WAITS, // it is in Slurm's queue
    SLURM_RUNS,
    SLURM_ENDS, // its processes are being ended
    SLURM_IS_OVER,
    SLURM_OTHER // suspended, being resized, or what this program does not know
};

// One job. Texts are borrowed from what was read.
struct slurm_row {
    int64_t job;
    enum slurm_phase phase;
    const char *state;   // Slurm's word: "RUNNING"
    const char *machine; // "": none yet
    int64_t left_s;      // until its time is over; SLURM_NO_LIMIT: never, or unknown
    const char *name;
    const char *reason; // "None", "Resources", ...
};

// What `sbatch --parsable` prints: the job's id, with or without the cluster's name.
bool slurm_read_job(const char *text, int64_t *job, struct error *error);
// A duration: "5:00", "1:00:00", "2-12:00:00", "UNLIMITED", ...
bool slurm_read_time(const char *text, int64_t *seconds, struct error *error);
// What squeue prints by slurm_commands_make_look, its heading included: an answer without it is none. Changes `text`.
// False, with the line that is wrong, if `take` says so, too.
bool slurm_read_rows(char *text, bool (*take)(void *user, const struct slurm_row *row, struct error *error), void *user,
                     struct error *error);
