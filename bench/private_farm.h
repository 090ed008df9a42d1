// A daemon of our own for a measurement, and the requests that it gets.
// SPDX-License-Identifier: Apache-2.0
//
// Whatever fails ends the program with a message.
#pragma once

#include "core/json/json_write.h"
#include "core/wire/message_stream.h"

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

#include <sys/types.h>

struct message;

struct private_farm {
    char programs[PATH_MAX]; // folder of marchd and stub-worker
    char scratch[64];        // removed by private_farm_finish, with `out`
    char out[80];            // the output root of the next start
    char socket_path[108];
    char worker[128]; // script that starts the stub in one of its modes
    pid_t daemon;
    int fd;
    struct message_stream stream;
    struct json_writer request;
    int outputs; // counted, so that no two jobs write the same files
};

_Noreturn void private_farm_give_up(const char *what);
void private_farm_sleep_ms(long ms);

void private_farm_init(struct private_farm *farm);
void private_farm_finish(struct private_farm *farm); // the daemon is stopped
// Writes the program that workers are; `mode` of stub-worker, or NULL: the real worker.
void private_farm_write_worker(struct private_farm *farm, const char *mode);
// Frames are written to memory from the next start on, not to the disk of the scratch folder.
void private_farm_use_memory(struct private_farm *farm);
// Returns once it listens. `options` end in NULL.
void private_farm_start(struct private_farm *farm, const char *const options[]);
void private_farm_stop(struct private_farm *farm);

// Asks for a method with the given params, a JSON object; the caller finishes the answer. Returns its bytes.
size_t private_farm_ask(struct private_farm *farm, const char *method, const char *params, struct message *answer);
int64_t private_farm_submit(struct private_farm *farm, const char *range, bool paused); // the job's id
void private_farm_wait(struct private_farm *farm, int64_t job);
double private_farm_run_job(struct private_farm *farm, const char *range); // seconds
// Has all frames of the job looked for again, which are there. Seconds.
double private_farm_run_again(struct private_farm *farm, int64_t job);

double private_farm_processor_s(pid_t pid); // of all threads
double private_farm_memory_mib(pid_t pid);  // resident

void private_farm_print_row(const char *what, double value, const char *unit, const char *target);
