// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_backup.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/store/store_counts.h"
#include "daemon/store/store_lock.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"
#include "daemon/store/store_sum.h"
#include "daemon/store/store_tokens.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <sqlite3.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { BUSY_TIMEOUT_MS = 5000, JUMP = 1000 };

static bool sync_folder_of(const char *path)
{
    char *copy = xstrdup(path);
    int fd = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool ok = fd >= 0 && fsync(fd) == 0;

    if (fd >= 0) close(fd);
    free(copy);
    return ok;
}

static bool copy_pages(sqlite3 *from, sqlite3 *to, struct error *error)
{
    sqlite3_backup *backup = sqlite3_backup_init(to, "main", from, "main");

    if (backup) {
        sqlite3_backup_step(backup, -1);
        if (sqlite3_backup_finish(backup) == SQLITE_OK)
            return store_sql_execute(to, "PRAGMA journal_mode = DELETE", "end the backup", error);
    }
    store_sql_set_error(error, to, "write the backup");
    return false;
}

static bool check_rows(sqlite3 *db, int version, int64_t known, const char *what, struct error *error)
{
    int64_t damaged = 0;

    if (!store_sum_count_damaged(db, version, &damaged, error)) return false;
    if (damaged <= known) return true;
    error_set(error, "%s has %lld damaged rows", what, (long long)damaged);
    return false;
}

// Rows that were damaged since they were looked at would otherwise replace good ones.
static bool check_copy(sqlite3 *copy, int64_t known, struct error *error)
{
    int version;

    return store_sum_register(copy, error) && store_schema_check(copy, &version, error) &&
           check_rows(copy, version, known, "store: the new backup is dropped: it", error);
}

// The file is made here, for SQLite would make it readable by all.
static bool write_part(sqlite3 *db, const char *part, int64_t known, struct error *error)
{
    sqlite3 *copy = NULL;
    bool ok = false;
    int fd;

    unlink(part);
    fd = open(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd < 0) {
        error_set_errno(error, errno, "cannot make %s", part);
        return false;
    }
    close(fd);
    if (sqlite3_open_v2(part, &copy, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL) == SQLITE_OK)
        ok = copy_pages(db, copy, error) && check_copy(copy, known, error);
    else
        store_sql_set_error(error, copy, "open the backup");
    sqlite3_close(copy);
    return ok;
}

bool store_backup_write(sqlite3 *db, const char *path, int64_t known, struct error *error)
{
    char *part = xasprintf("%s.part", path);
    bool ok = write_part(db, part, known, error);

    if (ok && (rename(part, path) != 0 || !sync_folder_of(path))) {
        error_set_errno(error, errno, "cannot write %s", path);
        ok = false;
    }
    if (!ok) unlink(part);
    free(part);
    return ok;
}

// Opens a file that must be a store. NULL on failure.
static sqlite3 *open_store_file(const char *path, int *version, struct error *error)
{
    sqlite3 *db = NULL;
    bool ok = false;

    if (access(path, R_OK) != 0) {
        error_set_errno(error, errno, "cannot read %s", path);
        return NULL;
    }
    if (sqlite3_open_v2(path, &db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL) == SQLITE_OK) {
        sqlite3_busy_timeout(db, BUSY_TIMEOUT_MS);
        ok = store_schema_check(db, version, error) && store_sum_register(db, error);
        if (!ok && !store_sql_is_readable(db)) error_set(error, "%s is damaged, or no copy of a queue", path);
        if (ok && *version == 0) {
            error_set(error, "%s is empty", path);
            ok = false;
        }
    } else {
        store_sql_set_error(error, db, "open the file");
    }
    if (ok) return db;
    sqlite3_close(db);
    return NULL;
}

bool store_backup_save(const char *folder, const char *path, struct error *error)
{
    char *queue = xasprintf("%s/queue.db", folder);
    int version = 0;
    sqlite3 *db = open_store_file(queue, &version, error);
    bool ok = db && check_rows(db, version, 0, queue, error) && store_backup_write(db, path, 0, error);

    sqlite3_close(db);
    free(queue);
    return ok;
}

// Ids and epochs of the copy, raised above what the folder knows of.
static bool raise_counts(sqlite3 *db, const char *folder, bool *has_counts, struct error *error)
{
    struct store_counts counts, known;

    *has_counts = store_counts_read(folder, &known);
    if (!store_sql_read_integer(db, "SELECT epoch FROM daemon", &counts.epoch, error)) return false;
    if (!store_sql_read_integer(db,
                                "SELECT max((SELECT coalesce(max(id), 0) FROM job),"
                                " (SELECT coalesce(max(job), 0) FROM frame))",
                                &counts.last_job_id, error))
        return false;
    counts.epoch += JUMP;
    if (!*has_counts) counts.last_job_id += JUMP;
    return store_counts_raise(folder, &counts, error);
}

static bool move(const char *folder, const char *from_name, const char *to_name, struct error *error)
{
    char *from = xasprintf("%s/%s", folder, from_name), *to = xasprintf("%s/%s", folder, to_name);
    bool ok = rename(from, to) == 0 || errno == ENOENT;

    if (!ok) error_set_errno(error, errno, "cannot rename %s to %s", from, to_name);
    free(from);
    free(to);
    return ok;
}

static void remove_file(const char *folder, const char *name)
{
    char *path = xasprintf("%s/%s", folder, name);

    unlink(path);
    free(path);
}

static bool is_there(const char *folder, const char *name)
{
    char *path = xasprintf("%s/%s", folder, name);
    bool found = access(path, F_OK) == 0;

    free(path);
    return found;
}

// A log beside the new file would be taken for its own. A process that is killed meanwhile leaves no store that is part
// old and part new, but none, and `queue.db.restored`.
static bool switch_files(const char *folder, struct error *error)
{
    bool ok;

    if (is_there(folder, "queue.db")) remove_file(folder, "queue.db.replaced-wal");
    ok = move(folder, "queue.db", "queue.db.replaced", error) &&
         move(folder, "queue.db-wal", "queue.db.replaced-wal", error);
    remove_file(folder, "queue.db-shm");
    return ok && move(folder, STORE_RESTORED_NAME, "queue.db", error);
}

bool store_backup_end_restore(const char *folder, struct error *error)
{
    if (is_there(folder, "queue.db")) remove_file(folder, STORE_RESTORED_NAME);
    if (!is_there(folder, STORE_RESTORED_NAME)) return true;
    log_info("store: a restore that was cut off is ended: the queue that it put aside is queue.db.replaced");
    return switch_files(folder, error);
}

// Root restores for the daemon's user, whose folder it is.
static bool give_to_owner(const char *folder, const char *path, struct error *error)
{
    struct stat status;

    if (stat(folder, &status) == 0 && (geteuid() != 0 || lchown(path, status.st_uid, status.st_gid) == 0)) return true;
    error_set_errno(error, errno, "cannot give %s to the owner of %s", path, folder);
    return false;
}

static bool put_in_place(const char *folder, sqlite3 *db, bool *has_counts, struct error *error)
{
    char *ready = xasprintf("%s/" STORE_RESTORED_NAME, folder), *counts = xasprintf("%s/counts", folder);
    bool ok = store_backup_write(db, ready, 0, error) && store_tokens_forget(ready, error) &&
              give_to_owner(folder, ready, error) && raise_counts(db, folder, has_counts, error) &&
              give_to_owner(folder, counts, error) && switch_files(folder, error);

    if (ok && !sync_folder_of(ready)) {
        error_set_errno(error, errno, "cannot sync %s", folder);
        ok = false;
    }
    free(ready);
    free(counts);
    return ok;
}

// Names what the copy lacks: ids tell which jobs came after it.
static void log_fall_back(const char *folder, int64_t last_of_copy)
{
    struct store_counts known;

    log_error("store: queue.db cannot be read: it is kept as queue.db.replaced, and the backup is in its place");
    store_counts_read(folder, &known);
    if (known.last_job_id > last_of_copy)
        log_error("store: the backup has no job after %lld: those up to %lld are lost, submit them again",
                  (long long)last_of_copy, (long long)known.last_job_id);
}

bool store_backup_fall_back(const char *folder, struct error *error)
{
    char *path = xasprintf("%s/" STORE_BACKUP_NAME, folder);
    int version = 0;
    int64_t last = 0;
    bool has_counts, ok = false;
    sqlite3 *db = access(path, R_OK) == 0 ? open_store_file(path, &version, error) : NULL;

    if (db) {
        ok = check_rows(db, version, 0, path, error) &&
             store_sql_read_integer(db, "SELECT coalesce(max(id), 0) FROM job", &last, error) &&
             put_in_place(folder, db, &has_counts, error);
    }
    if (ok) log_fall_back(folder, last);
    sqlite3_close(db);
    free(path);
    return ok;
}

bool store_backup_restore(const char *folder, const char *path, bool *has_counts, struct error *error)
{
    char *lock = xasprintf("%s/lock", folder);
    int version = 0, lock_fd = store_lock_take(folder, STORE_LOCK_WAIT_MS, error);
    sqlite3 *db = lock_fd >= 0 && give_to_owner(folder, lock, error) ? open_store_file(path, &version, error) : NULL;
    bool ok = db && check_rows(db, version, 0, path, error) && put_in_place(folder, db, has_counts, error);

    sqlite3_close(db);
    if (lock_fd >= 0) close(lock_fd);
    free(lock);
    return ok;
}
