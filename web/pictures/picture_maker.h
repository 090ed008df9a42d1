// Has a worker make one picture or explain one job: a process of its own, which reads what that takes and nothing else.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "web/pictures/picture_status.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

struct error;
struct explanation;
struct picture_place;
struct picture_query;

enum { PICTURE_MADE_FACTS = 400, PICTURE_LEFT_LIMIT = 4 };

struct picture_maker {
    const char *program;           // of the worker; borrowed, like the next two
    const char *folder;            // absolute; its own, and empty between two pictures
    const atomic_bool *is_stopped; // it gives up at once
    int folder_fd;                 // owned; the same
    int64_t memory_bytes;
    int limit_ms;
    pid_t left[PICTURE_LEFT_LIMIT]; // workers that were killed, while a disk held them, and have not ended yet; 0: none
};

extern const char picture_maker_file[]; // the name of what it makes, in its folder

// Makes the folder, where it is missing.
bool picture_maker_open(struct picture_maker *maker, struct error *error);
void picture_maker_close(struct picture_maker *maker);
// Makes the PNG, or the JSON of the header, as that file. It returns after the worker has ended, or was killed. `facts`
// receives what is known of a picture, as one JSON object of numbers. PICTURE_BUSY, too, while a disk holds
// PICTURE_LEFT_LIMIT workers.
enum picture_status picture_maker_run(struct picture_maker *maker, const struct picture_place *place,
                                      const struct picture_query *query, char facts[static PICTURE_MADE_FACTS + 1],
                                      struct error *error);
// Makes what worker.explain says of the job, as that file.
enum picture_status picture_maker_explain(struct picture_maker *maker, const struct explanation *explanation,
                                          struct error *error);
void picture_maker_sweep(const struct picture_maker *maker); // removes what is in the folder
