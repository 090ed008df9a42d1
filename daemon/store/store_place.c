// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_place.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <sqlite3.h>
#include <stdlib.h>
#include <sys/stat.h>

// Zero when there is none.
static struct store_place find_log(const char *folder)
{
    char *path = xasprintf("%s/queue.db-wal", folder);
    struct stat status;
    struct store_place place = {0};

    if (stat(path, &status) == 0) place = (struct store_place){.device = status.st_dev, .inode = status.st_ino};
    free(path);
    return place;
}

void store_place_note(struct store_place *place, const char *folder)
{
    *place = find_log(folder);
}

static bool has_log(const struct store_place *place, const char *folder)
{
    struct store_place found = find_log(folder);

    return place->inode == 0 || (found.inode == place->inode && found.device == place->device);
}

bool store_place_check(const struct store_place *place, const char *folder, sqlite3 *db, struct error *error)
{
    const char *lost = NULL;
    int has_moved = 0;

    sqlite3_file_control(db, "main", SQLITE_FCNTL_HAS_MOVED, &has_moved);
    if (has_moved) {
        lost = "queue.db";
    } else if (!has_log(place, folder)) {
        lost = "queue.db-wal";
        // The log is still open: what is in it alone goes to the database.
        sqlite3_wal_checkpoint_v2(db, NULL, SQLITE_CHECKPOINT_FULL, NULL, NULL);
    }
    if (!lost) return true;
    error_set(error, "%s/%s was removed or replaced while the daemon runs: put it back, or restart the daemon", folder,
              lost);
    return false;
}
