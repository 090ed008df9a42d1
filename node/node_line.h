// The lines that the daemon and a node exchange: a word, the number of a worker where it is about one, and a rest.
// SPDX-License-Identifier: Apache-2.0
//
// A node speaks on the standard streams of a program that a launcher (srun, ssh) started. Messages of workers pass
// through as they are. What a shell prints before the node's first line is no line of a node.
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

enum { NODE_PROTOCOL = 1, NODE_LINE_HEAD_SIZE = 40, NODE_NO_WORKER = -1 };

// In an order to start a worker, as the limit of its memory: its share of the node's.
enum { NODE_MEMORY_SHARE = -1 };

enum node_word {
    NODE_HELLO,   // from the node, first: an object that says what it is
    NODE_WELCOME, // to the node, after it: an object that says what is wanted
    NODE_REFUSED, // either way: a JSON string that says why; the end
    NODE_PROBE,   // to the node: an object; see node_probe.h
    NODE_PROBED,  // from the node: an object
    NODE_START,   // to: worker, an object of worker_child_params
    NODE_STARTED, // from: worker, its pid
    NODE_FAILED,  // from: worker, a JSON string that says why it was not started
    NODE_TO,      // to: worker, a message for it
    NODE_FROM,    // from: worker, a message of it
    NODE_LOG,     // from: worker, a JSON string of its standard error
    NODE_KILL,    // to: worker
    NODE_ENDED,   // from: worker, its exit status and signal
    NODE_BEAT,    // either way
    NODE_WORD_COUNT
};

struct node_line {
    enum node_word word;
    int worker;       // NODE_NO_WORKER: the line is about none
    const char *rest; // borrowed, ends where the line ends; may be empty
    size_t length;    // of the rest
};

// `bytes` is a line without its newline.
bool node_line_read(struct node_line *line, const char *bytes, size_t length, struct error *error);
// Writes what comes before the rest; returns its length. The rest and a newline follow.
size_t node_line_write_head(char head[static NODE_LINE_HEAD_SIZE], enum node_word word, int worker);
