// An MP4 from numbered PNG files, by ffmpeg.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

bool film_has_ffmpeg(struct error *error); // the message says what to install
// Reads FOLDER/000000.png, 000001.png, ..., in sRGB; `out` appears only when it is complete, and says its colours.
// `rate` is frames a second as ffmpeg reads it: "24", "24000/1001".
bool film_encode(const char *folder, const char *rate, const char *out, struct error *error);
// Makes a folder for the pictures. Returns its path, owned by the caller; NULL on failure.
char *film_create_folder(struct error *error);
void film_remove_folder(const char *folder); // and the files in it; accepts NULL
