// The marker file of an output root, whose random id tells the root from whatever else may be under its path.
// SPDX-License-Identifier: Apache-2.0
//
// The folder below a mount point looks like the root once its disk is gone: only the marker tells them apart. It is
// made once, when a farm first uses the folder. It lies in the folder itself and goes with it wherever that is mounted
// or moved. Its lines are "root ID", and "farm ID HOST STATE-FOLDER" for each farm that has used the root. Lines are
// only added, and the first line of a root counts, so that farms that begin at one moment agree. Whoever empties the
// file, or puts an empty one into a folder, asks for this folder to be the root that its farm expects there.
#pragma once

#include <stdbool.h>

struct error;

#define ROOT_MARKER_NAME ".marchd-root" // a macro because texts hold it

enum { ROOT_MARKER_ID_SIZE = 33 }; // 32 hexadecimal digits and NUL

enum root_marker_state {
    ROOT_MARKER_VALID,  // it has an id
    ROOT_MARKER_EMPTY,  // it has none: the folder is to be marked
    ROOT_MARKER_NONE,   // there is no marker
    ROOT_MARKER_UNKNOWN // it cannot be read, or is no file
};

// Reads the marker of the folder `root_fd`, which may be an O_PATH descriptor. `id` is empty unless the marker is
// valid; `error` is set where its state is unknown. Blocking, as all below.
enum root_marker_state root_marker_read(int root_fd, char id[static ROOT_MARKER_ID_SIZE], struct error *error);

// Adds "root ID" to the marker, which is made if it is missing, or if it is empty and cannot be written, and syncs. The
// id that counts is the first in the file: read it again.
bool root_marker_add_root(int root_fd, const char *id, struct error *error);
// Adds the line of a farm whose store lies in `state_folder` of this host, unless the marker has that line.
bool root_marker_add_farm(int root_fd, const char *farm, const char *state_folder, struct error *error);

// Whether the folder at `root` has been the output root of a farm whose store lay in `state_folder` of this host. Then
// `farm` is the id of the latest such farm, which differs from store_farm() where the store there is another one.
bool root_marker_find_farm(const char *root, const char *state_folder, char farm[static ROOT_MARKER_ID_SIZE]);

bool root_marker_is_id(const char *text); // 32 hexadecimal digits
void root_marker_make_id(char id[static ROOT_MARKER_ID_SIZE]);
