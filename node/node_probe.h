// Whether two machines see the same folders: each writes a file into an output root, and looks at the other's.
// SPDX-License-Identifier: Apache-2.0
//
// A wrong mount has another marker or shows no file of the other side; another numbering of users shows in the owner.
#pragma once

#include "core/job/root_marker.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct json_node;
struct json_writer;

// A file of a side as that side sees it.
struct node_probe_file {
    uint64_t inode;
    int64_t uid;
};

struct node_probe_root {
    char *path;                     // owned; absolute
    char id[ROOT_MARKER_ID_SIZE];   // of its marker; "": an input root, which is only looked for
    struct node_probe_file written; // by this side
    struct node_probe_file told;    // by the other side, of its file
};

// The zero value is empty.
struct node_probe {
    char token[ROOT_MARKER_ID_SIZE]; // of this probe; in the names of its files
    struct node_probe_root *roots;   // owned
    size_t count, capacity;
    int64_t seen_ms;   // the longest wait of a look, on either side
    bool is_own_fault; // of a look that failed: a root is not there on this side
};

enum { NODE_PROBE_PAUSE_MS = 50 }; // between two looks for a file

enum node_probe_side { NODE_PROBE_DAEMON, NODE_PROBE_NODE };

void node_probe_add(struct node_probe *probe, const char *path, const char *id); // copies
void node_probe_finish(struct node_probe *probe);

// Both block. Write makes this side's files and notes the inodes of input roots; the daemon leaves out input roots that
// it lacks. Look waits until the other side's files are seen, each at most so long. False: what is wrong is in `error`.
// Of "/", which is each machine's own, only that it is there is looked at.
bool node_probe_write(struct node_probe *probe, enum node_probe_side side, struct error *error);
bool node_probe_look(struct node_probe *probe, enum node_probe_side other, int limit_ms, struct error *error);
void node_probe_remove(const struct node_probe *probe); // the files of both sides, as far as they are there

// The objects of NODE_PROBE and NODE_PROBED: the roots and what was written; `fault`, which may be NULL, is what is
// wrong.
void node_probe_write_json(const struct node_probe *probe, const char *fault, struct json_writer *writer);
// Reads the other side's object into `told` of the roots: an empty probe gets the roots, another one has to have them.
// A fault of the other side is an error.
bool node_probe_read_json(struct node_probe *probe, const struct json_node *object, struct error *error);
