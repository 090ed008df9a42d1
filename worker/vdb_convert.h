// Turns OpenVDB files into NanoVDB ones with the program that OpenVDB's authors ship for it, nanovdb_convert.
#pragma once

#include <stdbool.h>

struct error;

// `*nvdb_path` (owned by the caller, NULL on failure) is a new temporary file, which the caller removes.
bool vdb_convert(const char *path, char **nvdb_path, struct error *error);
