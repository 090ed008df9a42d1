// A bad machine for LD_PRELOAD: disks that are slow, fail, tear a write or answer as a network does; a jumping clock.
// SPDX-License-Identifier: Apache-2.0
//
// LD_MACHINE_SHIM names a file with one struct machine, which whoever breaks the machine may change at any time.
// LD_MACHINE_NAMES names a file: a line "INODE PATH" is added to it for each file that marchd has given a name.
// Only regular files on the two disks are concerned. A "one in" of N hits each N-th call; 0: none.
// What a call reports is true: a write that fails may have written a part, a write that succeeds wrote all.
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

struct disk {
    int64_t device; // st_dev
    int64_t delay_us;
    int64_t one_write_in, one_sync_in, one_rename_in; // fail: EIO
    int64_t late_us;            // the daemon does not see part files that are younger, as if another machine wrote them
    int64_t one_lost_rename_in; // is done, and answers ENOENT, as a repeated call of a network file system
    int64_t one_tear_in;        // writes half of the bytes; the daemon dies, a worker gets EIO
};

struct machine {
    int64_t clock_ms; // what CLOCK_REALTIME is ahead by
    struct disk disks[2];
};

static const struct machine *machine;
static int names_fd = -1;
static bool is_daemon;
static int64_t writes, syncs, renames, answers;

__attribute__((constructor)) static void begin(void)
{
    const char *path = getenv("LD_MACHINE_SHIM"), *names = getenv("LD_MACHINE_NAMES");
    int fd = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;

    is_daemon = strcmp(program_invocation_short_name, "marchd") == 0;
    if (is_daemon && names) names_fd = open(names, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (fd < 0) return;
    machine = mmap(NULL, sizeof *machine, PROT_READ, MAP_SHARED, fd, 0);
    if (machine == MAP_FAILED) machine = NULL;
    close(fd);
}

static const struct disk *disk_of(int fd)
{
    struct stat status;

    if (!machine || fd <= STDERR_FILENO || fd == names_fd || fstat(fd, &status) != 0) return NULL;
    if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) return NULL;
    for (int i = 0; i < 2; i++)
        if ((int64_t)status.st_dev == machine->disks[i].device) return &machine->disks[i];
    return NULL;
}

static bool is_hit(int64_t one_in, int64_t *count)
{
    return one_in > 0 && __atomic_add_fetch(count, 1, __ATOMIC_RELAXED) % one_in == 0;
}

static void delay(const struct disk *disk)
{
    struct timespec time = {.tv_sec = disk->delay_us / 1000000, .tv_nsec = disk->delay_us % 1000000 * 1000};

    if (disk->delay_us > 0) nanosleep(&time, NULL);
}

static ssize_t put(int fd, const void *bytes, size_t size, int64_t offset)
{
    return offset < 0 ? syscall(SYS_write, fd, bytes, size) : syscall(SYS_pwrite64, fd, bytes, size, offset);
}

static ssize_t write_badly(int fd, const void *bytes, size_t size, int64_t offset)
{
    const struct disk *disk = disk_of(fd);

    if (!disk) return put(fd, bytes, size, offset);
    delay(disk);
    if (is_hit(disk->one_tear_in, &writes)) {
        put(fd, bytes, size / 2, offset);
        if (is_daemon) kill(getpid(), SIGKILL);
    } else if (!is_hit(disk->one_write_in, &writes)) {
        return put(fd, bytes, size, offset);
    }
    errno = EIO;
    return -1;
}

static bool sync_fails(int fd)
{
    const struct disk *disk = disk_of(fd);

    if (disk) delay(disk);
    return disk && is_hit(disk->one_sync_in, &syncs);
}

static int fail(void)
{
    errno = EIO;
    return -1;
}

ssize_t write(int fd, const void *bytes, size_t size)
{
    return write_badly(fd, bytes, size, -1);
}

ssize_t pwrite(int fd, const void *bytes, size_t size, off_t offset)
{
    return write_badly(fd, bytes, size, offset);
}

ssize_t pwrite64(int fd, const void *bytes, size_t size, off_t offset)
{
    return write_badly(fd, bytes, size, offset);
}

int fsync(int fd)
{
    return sync_fails(fd) ? fail() : (int)syscall(SYS_fsync, fd);
}

int fdatasync(int fd)
{
    return sync_fails(fd) ? fail() : (int)syscall(SYS_fdatasync, fd);
}

// Adds the name that a file got to the list of names.
static void note_name(int folder_fd, const char *name)
{
    char link[64], folder[PATH_MAX] = "", line[2 * PATH_MAX];
    struct stat status;
    ssize_t length;
    int count;

    if (names_fd < 0 || fstatat(folder_fd, name, &status, AT_SYMLINK_NOFOLLOW) != 0) return;
    snprintf(link, sizeof link, "/proc/self/fd/%d", folder_fd);
    length = readlink(link, folder, sizeof folder - 1);
    if (length < 0) return;
    count = snprintf(line, sizeof line, "%llu %s/%s\n", (unsigned long long)status.st_ino, folder, name);
    syscall(SYS_write, names_fd, line, count);
}

int renameat(int from_fd, const char *from, int to_fd, const char *to)
{
    const struct disk *disk = disk_of(to_fd);
    int status;

    if (disk) delay(disk);
    if (disk && is_hit(disk->one_rename_in, &renames)) return fail();
    status = (int)syscall(SYS_renameat2, from_fd, from, to_fd, to, 0);
    if (status == 0) note_name(to_fd, to);
    if (status != 0 || !disk || !is_hit(disk->one_lost_rename_in, &answers)) return status;
    errno = ENOENT;
    return -1;
}

// Whether a part file is too young to be seen.
static bool is_late(int folder_fd, const char *name)
{
    const struct disk *disk = is_daemon && name[0] != '/' ? disk_of(folder_fd) : NULL;
    const char *end = strrchr(name, '.');
    struct stat status;
    struct timespec now;

    if (!disk || disk->late_us == 0 || !end || strcmp(end, ".part") != 0) return false;
    if (syscall(SYS_newfstatat, folder_fd, name, &status, AT_SYMLINK_NOFOLLOW) != 0) return false;
    syscall(SYS_clock_gettime, CLOCK_REALTIME, &now);
    return (now.tv_sec - status.st_mtim.tv_sec) * 1000000 + (now.tv_nsec - status.st_mtim.tv_nsec) / 1000 <
           disk->late_us;
}

int openat(int folder_fd, const char *name, int flags, ...)
{
    va_list arguments;
    mode_t mode;

    va_start(arguments, flags);
    mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    if (!is_late(folder_fd, name)) return (int)syscall(SYS_openat, folder_fd, name, flags, mode);
    errno = ENOENT;
    return -1;
}

int fstatat(int folder_fd, const char *restrict name, struct stat *restrict status, int flags)
{
    if (!is_late(folder_fd, name)) return (int)syscall(SYS_newfstatat, folder_fd, name, status, flags);
    errno = ENOENT;
    return -1;
}

static void shift(int64_t *seconds, int64_t *nanoseconds)
{
    int64_t ahead_ms = machine ? machine->clock_ms : 0;

    *seconds += ahead_ms / 1000;
    *nanoseconds += ahead_ms % 1000 * 1000000;
    if (*nanoseconds >= 1000000000) {
        *seconds += 1;
        *nanoseconds -= 1000000000;
    } else if (*nanoseconds < 0) {
        *seconds -= 1;
        *nanoseconds += 1000000000;
    }
}

int clock_gettime(clockid_t clock, struct timespec *now)
{
    int status = (int)syscall(SYS_clock_gettime, clock, now);
    int64_t seconds = now->tv_sec, nanoseconds = now->tv_nsec;

    if (status != 0 || (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE)) return status;
    shift(&seconds, &nanoseconds);
    now->tv_sec = seconds;
    now->tv_nsec = nanoseconds;
    return 0;
}

int gettimeofday(struct timeval *restrict now, void *restrict zone)
{
    struct timespec time;

    (void)zone;
    clock_gettime(CLOCK_REALTIME, &time);
    now->tv_sec = time.tv_sec;
    now->tv_usec = time.tv_nsec / 1000;
    return 0;
}

time_t time(time_t *now)
{
    struct timespec time;

    clock_gettime(CLOCK_REALTIME, &time);
    if (now) *now = time.tv_sec;
    return time.tv_sec;
}
