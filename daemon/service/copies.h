// `marchd --backup` and `--restore`: the store copied to a file and put back, without a daemon of its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct options;

// Do what options->backup_file or options->restore_file asks for, and say so on standard output, or why not on standard
// error. They return the exit status.
int copies_back_up(const struct options *options);
int copies_restore(const struct options *options);
