// How much of a picture's light the orders of scattering that a job models leave out: in numbers, as JSON, in words.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct json_node;
struct json_writer;

enum { JOB_BEYOND_WHY_SIZE = 160, JOB_BEYOND_TEXT_SIZE = 320, JOB_BEYOND_PERCENT_SIZE = 16 };

// The zero value says nothing: all orders are modelled, or nobody asked.
struct job_beyond {
    bool is_known;
    double error;                  // relative RMSE of the modelled orders against all, [0, 1]
    double error95;                // upper bound of `error` with a confidence of 95 %, [0, 1]
    char why[JOB_BEYOND_WHY_SIZE]; // why it is not known; empty where it is, or where nothing is said
};

bool job_beyond_is_told(const struct job_beyond *beyond); // known, or why not
// True where it is known and more than a tolerance, which is above 0.
bool job_beyond_is_over(const struct job_beyond *beyond, double tolerance);

// Writes the member "beyond" where something is told: an object with error and error95, or with why.
void job_beyond_write(const struct job_beyond *beyond, struct json_writer *writer);
// Reads that member of `object`; absent or null: the zero value, as on failure.
bool job_beyond_read(struct job_beyond *beyond, const struct json_node *object, struct error *error);

// Writes a share as percent, in two digits, and all three of 100; without the sign.
void job_beyond_percent(double share, char text[static JOB_BEYOND_PERCENT_SIZE]);
// Writes a sentence without its full stop about a job that models `orders` (struct scene); empty where nothing is told.
void job_beyond_describe(const struct job_beyond *beyond, int orders, char text[static JOB_BEYOND_TEXT_SIZE]);
