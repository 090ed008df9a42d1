// The requests of a chart to its worker: the scene's extent and truth, seconds and error of a setting, error maps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/chart/chart_points.h"
#include "cli/peer/worker_child.h"
#include "cli/program/exit_status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct chart_scale;
struct error;
struct interrupt;
struct json_node;
struct options;

struct chart_query {
    const struct options *options; // borrowed
    struct interrupt *interrupt;   // borrowed
    int64_t frame;
    const char *truth_path; // borrowed; the truth of pictures with one sample; ".N" is appended for N samples
    struct worker_child child;
};

// When the worker ends, `error` has its last words, and the status is EXIT_STATUS_NO_DAEMON.
enum exit_status chart_query_start(struct chart_query *query, struct error *error);
void chart_query_stop(struct chart_query *query, bool at_once);
enum exit_status chart_query_restart(struct chart_query *query, struct error *error);

// `document` with another quality. A missing camera.clip is set to the distances of `clip` (NULL: stays missing). Owned
// by the caller; NULL, with the reason, when the result is no valid job.
char *chart_query_document(const char *document, const char *quality, const struct chart_scale *clip,
                           struct error *error);
// `quality` with another number of samples; owned by the caller.
char *chart_query_with_samples(const char *quality, int samples);
// Sets the job's name; "job" where it has none.
void chart_query_set_name(const struct json_node *job, struct chart_facts *facts);
bool chart_query_is_there(const char *path);

struct chart_truth_facts {
    struct chart_facts facts; // without a name
    char truth[16];
    int64_t pixels;
};

// The extent of the scene.
enum exit_status chart_query_scale(struct chart_query *query, const char *document, struct chart_scale *scale,
                                   struct error *error);
// The two documents are the scene in finer and coarser steps.
enum exit_status chart_query_truth(struct chart_query *query, const char *finer, const char *coarser, int samples,
                                   double seconds, struct chart_truth_facts *facts, struct error *error);
// Sets the point's outcome; `reason` says why it was refused.
enum exit_status chart_query_point(struct chart_query *query, const char *document,
                                   const struct chart_truth_facts *facts, int samples, double limit_s,
                                   struct chart_point *point, struct error *reason);

// The hash of the shader that renders a setting.
enum exit_status chart_query_program(struct chart_query *query, const char *document, char hash[static HASH_TEXT_SIZE],
                                     struct error *error);

// The planner's choice for that frame alone; `quality` is owned by the caller.
enum exit_status chart_query_plan(struct chart_query *query, const char *document, char **quality, struct error *error);

struct chart_strip_picture {
    char *document, *label; // owned
};

// Pictures with maps of their errors against the one that was added last. The zero value is empty.
struct chart_strip {
    struct chart_strip_picture *pictures; // owned
    size_t count;
};

void chart_strip_add(struct chart_strip *strip, char *document, char *label); // takes over both
void chart_strip_finish(struct chart_strip *strip);
enum exit_status chart_query_strip(struct chart_query *query, const struct chart_strip *strip, const char *path,
                                   struct error *error);
