// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_keeper.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/store/store_backup.h"
#include "daemon/store/store_repair.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"
#include "daemon/store/store_sum.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <time.h>

enum {
    BUSY_TIMEOUT_MS = 30000,
    COMMIT_S = 60 // that a commit takes at most, on a slow disk
};

struct store_keeper {
    struct store_keeper_params params;
    char *folder; // owned
    uv_timer_t timer;
    uv_work_t work;
    bool is_working, is_closing, is_closed;
    int64_t looks;
    int64_t mended;       // set by the thread: damaged rows of the latest look
    struct error trouble; // set by the thread; empty: none
    struct error told;    // the trouble that the log has
};

static void on_time(uv_timer_t *timer);
static void on_look(uv_work_t *work);
static void on_looked(uv_work_t *work, int status);
static void on_closed(uv_handle_t *handle);

struct store_keeper *store_keeper_open(uv_loop_t *loop, const struct store_keeper_params *params)
{
    struct store_keeper *keeper = xcalloc(1, sizeof *keeper);

    keeper->params = *params;
    keeper->folder = xstrdup(params->folder);
    keeper->work.data = keeper;
    uv_timer_init(loop, &keeper->timer);
    keeper->timer.data = keeper;
    uv_timer_start(&keeper->timer, on_time, (uint64_t)params->first_ms, (uint64_t)params->interval_ms);
    return keeper;
}

int64_t store_keeper_looks(const struct store_keeper *keeper)
{
    return keeper->looks;
}

static void on_time(uv_timer_t *timer)
{
    struct store_keeper *keeper = timer->data;

    if (keeper->is_working || !keeper->params.may_run(keeper->params.user)) return;
    keeper->is_working = true;
    uv_queue_work(timer->loop, &keeper->work, on_look, on_looked);
}

static bool find_status(const struct store_keeper *keeper, const char *name, struct stat *status)
{
    char *path = xasprintf("%s/%s", keeper->folder, name);
    bool found = stat(path, status) == 0;

    free(path);
    return found;
}

// A commit counts from its end, and the file's time is that of a write before.
static bool is_older_by_far(const struct stat *file, const struct stat *than)
{
    return file->st_mtim.tv_sec < than->st_mtim.tv_sec - COMMIT_S;
}

static bool has_changed(const struct store_keeper *keeper)
{
    struct stat backup, file;

    // A backup of the future is from before the clock was set back.
    if (!find_status(keeper, STORE_BACKUP_NAME, &backup) || backup.st_mtim.tv_sec > time(NULL)) return true;
    return (find_status(keeper, "queue.db", &file) && !is_older_by_far(&file, &backup)) ||
           (find_status(keeper, "queue.db-wal", &file) && !is_older_by_far(&file, &backup));
}

// The backup must not be what fills the disk.
static bool has_room(const struct store_keeper *keeper, struct error *error)
{
    struct statvfs disk;
    struct stat file;

    if (statvfs(keeper->folder, &disk) != 0 || !find_status(keeper, "queue.db", &file)) return true;
    if ((uint64_t)disk.f_bavail * disk.f_frsize >= 2 * (uint64_t)file.st_size) return true;
    error_set(error, "%s has no room for a backup of the queue: twice the %lld bytes of queue.db", keeper->folder,
              (long long)file.st_size);
    return false;
}

// The backup has the time of its beginning: what changes while it is made is newer.
static bool keep_backup(const struct store_keeper *keeper, sqlite3 *db, struct error *error)
{
    char *path = xasprintf("%s/" STORE_BACKUP_NAME, keeper->folder);
    bool is_due = has_changed(keeper), ok;
    struct timespec begun[2];
    int64_t known = 0; // damaged rows that could not be mended

    clock_gettime(CLOCK_REALTIME_COARSE, &begun[0]);
    begun[1] = begun[0];
    ok = !is_due || (has_room(keeper, error) &&
                     (keeper->mended == 0 || store_sum_count_damaged(db, STORE_SCHEMA_VERSION, &known, error)) &&
                     store_backup_write(db, path, known, error));
    if (is_due && ok) utimensat(AT_FDCWD, path, begun, 0);
    free(path);
    return ok;
}

static void on_look(uv_work_t *work)
{
    struct store_keeper *keeper = work->data;
    char *path = xasprintf("%s/queue.db", keeper->folder);
    struct error error = {0};
    sqlite3 *db = NULL;
    bool ok = sqlite3_open_v2(path, &db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL) == SQLITE_OK;

    if (!ok) store_sql_set_error(&error, db, "look at queue.db");
    sqlite3_busy_timeout(db, BUSY_TIMEOUT_MS);
    ok = ok && store_sum_register(db, &error) && store_repair(db, keeper->folder, &keeper->mended, &error) &&
         keep_backup(keeper, db, &error);
    keeper->trouble = ok ? (struct error){0} : error;
    sqlite3_close(db);
    free(path);
}

static void tell(struct store_keeper *keeper)
{
    if (strcmp(keeper->trouble.message, keeper->told.message) == 0) return;
    if (keeper->trouble.message[0])
        log_error("%s", keeper->trouble.message);
    else
        log_info("store: checked, and its backup is kept again");
    keeper->told = keeper->trouble;
}

static void finish(struct store_keeper *keeper)
{
    free(keeper->folder);
    free(keeper);
}

static void on_looked(uv_work_t *work, int status)
{
    struct store_keeper *keeper = work->data;

    (void)status;
    keeper->is_working = false;
    keeper->looks++;
    tell(keeper);
    if (keeper->is_closed)
        finish(keeper);
    else if (keeper->mended > 0 && !keeper->is_closing)
        keeper->params.on_repair(keeper->params.user);
}

static void on_closed(uv_handle_t *handle)
{
    struct store_keeper *keeper = handle->data;

    keeper->is_closed = true;
    if (!keeper->is_working) finish(keeper);
}

void store_keeper_close(struct store_keeper *keeper)
{
    if (!keeper) return;
    keeper->is_closing = true;
    uv_close((uv_handle_t *)&keeper->timer, on_closed);
}
