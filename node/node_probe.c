// SPDX-License-Identifier: Apache-2.0
#include "node/node_probe.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/output_root.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { NAME_SIZE = 64, OLD_S = 3600 };

#define PREFIX ".marchd-probe-"

static const char *const side_names[] = {[NODE_PROBE_DAEMON] = "daemon", [NODE_PROBE_NODE] = "node"};

void node_probe_add(struct node_probe *probe, const char *path, const char *id)
{
    struct node_probe_root root = {.path = xstrdup(path)};

    snprintf(root.id, sizeof root.id, "%s", id);
    probe->roots = xgrow(probe->roots, &probe->capacity, probe->count + 1, sizeof probe->roots[0]);
    probe->roots[probe->count++] = root;
}

void node_probe_finish(struct node_probe *probe)
{
    for (size_t i = 0; i < probe->count; i++)
        free(probe->roots[i].path);
    free(probe->roots);
    *probe = (struct node_probe){0};
}

static void format_name(const struct node_probe *probe, enum node_probe_side side, char name[static NAME_SIZE])
{
    snprintf(name, NAME_SIZE, PREFIX "%.16s-%s", probe->token, side_names[side]);
}

static bool is_output(const struct node_probe_root *root)
{
    return root->id[0] != '\0';
}

// A descriptor of the root, which is readable where files are looked for. -1 with the error set.
static int open_root(const struct node_probe_root *root, struct error *error)
{
    int fd = is_output(root) ? output_root_open(root->path, root->id, error)
                             : open(root->path, O_PATH | O_DIRECTORY | O_CLOEXEC);

    if (fd >= 0) return fd;
    if (!is_output(root)) error_set_errno(error, errno, "input root %s", root->path);
    return -1;
}

// Files of probes that were cut off, by the clock of the file system.
static void remove_old(int root_fd, time_t now)
{
    int fd = openat(root_fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *folder = fd >= 0 ? fdopendir(fd) : NULL;
    const struct dirent *entry;
    struct stat status;

    if (!folder && fd >= 0) close(fd);
    while (folder && (entry = readdir(folder))) {
        if (strncmp(entry->d_name, PREFIX, strlen(PREFIX)) != 0) continue;
        if (fstatat(root_fd, entry->d_name, &status, AT_SYMLINK_NOFOLLOW) != 0) continue;
        if (S_ISREG(status.st_mode) && now - status.st_mtime > OLD_S) (void)unlinkat(root_fd, entry->d_name, 0);
    }
    if (folder) closedir(folder);
}

static bool write_file(struct node_probe_root *root, int root_fd, const char *name, struct error *error)
{
    int fd = openat(root_fd, name, O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, 0644);
    struct stat status;
    bool ok = fd >= 0 && fsync(fd) == 0 && fstat(fd, &status) == 0;

    if (ok) {
        root->written = (struct node_probe_file){.inode = status.st_ino, .uid = status.st_uid};
        remove_old(root_fd, status.st_mtime);
    } else {
        error_set_errno(error, errno, "cannot write to %s", root->path);
    }
    if (fd >= 0) close(fd);
    return ok;
}

static bool note_folder(struct node_probe_root *root, int root_fd, struct error *error)
{
    struct stat status;

    if (fstat(root_fd, &status) == 0) {
        root->written.inode = status.st_ino;
        return true;
    }
    error_set_errno(error, errno, "input root %s", root->path);
    return false;
}

static void leave_out_missing_inputs(struct node_probe *probe)
{
    for (size_t i = probe->count; i-- > 0;) {
        struct node_probe_root *root = &probe->roots[i];

        if (is_output(root) || access(root->path, F_OK) == 0) continue;
        free(root->path);
        *root = probe->roots[--probe->count];
    }
}

bool node_probe_write(struct node_probe *probe, enum node_probe_side side, struct error *error)
{
    char name[NAME_SIZE];
    bool ok = true;

    format_name(probe, side, name);
    if (side == NODE_PROBE_DAEMON) leave_out_missing_inputs(probe);
    for (size_t i = 0; ok && i < probe->count; i++) {
        struct node_probe_root *root = &probe->roots[i];
        int fd = open_root(root, error);

        ok = fd >= 0 && (is_output(root) ? write_file(root, fd, name, error) : note_folder(root, fd, error));
        if (fd >= 0) close(fd);
    }
    return ok;
}

// False with errno.
static bool see_file(int root_fd, const char *name, struct stat *status)
{
    int fd = openat(root_fd, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC), errnum;
    bool ok = fd >= 0 && fstat(fd, status) == 0;

    errnum = errno;
    if (fd >= 0) close(fd);
    errno = errnum;
    return ok;
}

static bool look_at(const struct node_probe_root *root, int root_fd, const char *name, int limit_ms, int64_t *seen_ms,
                    struct error *error)
{
    const struct timespec pause = {.tv_nsec = NODE_PROBE_PAUSE_MS * 1000 * 1000};
    struct stat status;
    int waited_ms = 0;

    for (; !see_file(root_fd, name, &status); waited_ms += NODE_PROBE_PAUSE_MS) {
        if (errno != ENOENT && errno != ESTALE) {
            error_set_errno(error, errno, "%s: what the other machine wrote cannot be read", root->path);
            return false;
        }
        if (waited_ms >= limit_ms) {
            error_set(error, "%s: what the other machine writes there is not seen within %g s: not the same disk",
                      root->path, limit_ms / 1000.0);
            return false;
        }
        nanosleep(&pause, NULL);
    }
    if (waited_ms > *seen_ms) *seen_ms = waited_ms;
    if (status.st_ino != root->told.inode) {
        error_set(error, "%s: one file has another inode number on each machine: not the same disk", root->path);
        return false;
    }
    if (status.st_uid == geteuid() && root->told.uid == (int64_t)status.st_uid) return true;
    error_set(error,
              "%s: files of uid %lld of the other machine are of uid %lld here, where uid %lld runs: expected one uid",
              root->path, (long long)root->told.uid, (long long)status.st_uid, (long long)geteuid());
    return false;
}

static bool look_at_folder(const struct node_probe_root *root, int root_fd, struct error *error)
{
    struct stat status;

    if (strcmp(root->path, "/") == 0 || (fstat(root_fd, &status) == 0 && status.st_ino == root->told.inode))
        return true;
    error_set(error, "input root %s: it has another inode number on each machine: not the same folder", root->path);
    return false;
}

bool node_probe_look(struct node_probe *probe, enum node_probe_side other, int limit_ms, struct error *error)
{
    char name[NAME_SIZE];
    bool ok = true;

    format_name(probe, other, name);
    for (size_t i = 0; ok && i < probe->count; i++) {
        const struct node_probe_root *root = &probe->roots[i];
        int fd = open_root(root, error);

        probe->is_own_fault = fd < 0;
        ok = fd >= 0 && (is_output(root) ? look_at(root, fd, name, limit_ms, &probe->seen_ms, error)
                                         : look_at_folder(root, fd, error));
        if (fd >= 0) close(fd);
    }
    return ok;
}

void node_probe_remove(const struct node_probe *probe)
{
    for (size_t i = 0; i < probe->count; i++) {
        int fd = is_output(&probe->roots[i]) ? open_root(&probe->roots[i], NULL) : -1;

        for (int side = NODE_PROBE_DAEMON; fd >= 0 && side <= NODE_PROBE_NODE; side++) {
            char name[NAME_SIZE];

            format_name(probe, (enum node_probe_side)side, name);
            (void)unlinkat(fd, name, 0);
        }
        if (fd >= 0) close(fd);
    }
}

void node_probe_write_json(const struct node_probe *probe, const char *fault, struct json_writer *writer)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "token", probe->token);
    json_write_string_member(writer, "fault", fault);
    json_write_integer_member(writer, "seen_ms", probe->seen_ms);
    json_write_key(writer, "roots");
    json_write_begin_array(writer);
    for (size_t i = 0; i < probe->count; i++) {
        const struct node_probe_root *root = &probe->roots[i];
        char inode[24];

        snprintf(inode, sizeof inode, "%llu", (unsigned long long)root->written.inode);
        json_write_begin_object(writer);
        json_write_string_member(writer, "path", root->path);
        json_write_string_member(writer, "id", root->id);
        json_write_string_member(writer, "inode", inode);
        json_write_integer_member(writer, "uid", root->written.uid);
        json_write_end_object(writer);
    }
    json_write_end_array(writer);
    json_write_end_object(writer);
}

// NULL: an answer names a root that was not asked about.
static struct node_probe_root *find_root(struct node_probe *probe, bool is_answer, const char *path, const char *id)
{
    for (size_t i = 0; i < probe->count; i++)
        if (strcmp(probe->roots[i].path, path) == 0) return &probe->roots[i];
    if (is_answer) return NULL;
    node_probe_add(probe, path, id);
    return &probe->roots[probe->count - 1];
}

static bool read_root(struct node_probe *probe, bool is_answer, const struct json_node *object, struct error *error)
{
    struct json_node path = json_node_child(object, "path"), id = json_node_child(object, "id");
    struct json_node inode = json_node_child(object, "inode"), uid = json_node_child(object, "uid");
    const char *path_text, *id_text, *inode_text;
    struct node_probe_root *root;
    int64_t uid_number;

    if (!json_read_string(&path, &path_text, error) || !json_read_string(&id, &id_text, error) ||
        !json_read_string(&inode, &inode_text, error) || !json_read_integer(&uid, 0, UINT32_MAX, &uid_number, error))
        return false;
    root = find_root(probe, is_answer, path_text, id_text);
    if (!root) return json_fail_expected(&path, error, "a root of the probe");
    root->told = (struct node_probe_file){.inode = strtoull(inode_text, NULL, 10), .uid = uid_number};
    return true;
}

bool node_probe_read_json(struct node_probe *probe, const struct json_node *object, struct error *error)
{
    struct json_node token = json_node_child(object, "token"), fault = json_node_child(object, "fault");
    struct json_node roots = json_node_child(object, "roots"), seen = json_node_child(object, "seen_ms"), root = {0};
    const char *token_text, *fault_text;
    bool is_answer = probe->token[0] != '\0';

    if (json_read_string(&fault, &fault_text, NULL)) {
        error_set(error, "%s", fault_text);
        return false;
    }
    if (!json_read_string(&token, &token_text, error)) return false;
    if (!root_marker_is_id(token_text) || (probe->token[0] && strcmp(probe->token, token_text) != 0)) {
        error_set(error, "token: expected that of the probe");
        return false;
    }
    memcpy(probe->token, token_text, sizeof probe->token);
    if (!json_read_integer(&seen, 0, INT32_MAX, &probe->seen_ms, error)) return false;
    while (json_node_next(&roots, &root))
        if (!read_root(probe, is_answer, &root, error)) return false;
    return true;
}
