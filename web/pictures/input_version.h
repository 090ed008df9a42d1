// Which version of a file that jobs read is there, and of the file that its header names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct json_writer;

// Writes elements of an array: the path and what the file system says of it, and the same of the data file that a NRRD
// header names below `root`. Of a file that is not there the path stands alone.
void input_version_write(const char *path, const char *root, struct json_writer *writer);
