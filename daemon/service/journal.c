// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/journal.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

enum { OWNER_LIMIT = 256 };

const char journal_socket_path[] = "/run/systemd/journal/socket";

// Any thread of the daemon may log; each line is one datagram. The address is resolved for each datagram, so that a
// restarted journal is found.
static int journal_fd = -1;
static struct sockaddr_un journal_address;
static _Atomic long lost_count;

static bool is_stderr(const char *stream)
{
    uintmax_t device, inode;
    struct stat status;

    if (!stream || sscanf(stream, "%ju:%ju", &device, &inode) != 2 || fstat(STDERR_FILENO, &status) != 0) return false;
    return status.st_dev == device && status.st_ino == inode;
}

struct entry {
    char *bytes;
    size_t length;
};

static void add_bytes(struct entry *entry, const void *bytes, size_t count)
{
    memcpy(entry->bytes + entry->length, bytes, count);
    entry->length += count;
}

// The value is written with its length, little-endian, because a line feed in it would begin another field.
static void add_text(struct entry *entry, const char *name, const char *value, size_t limit)
{
    size_t length = strnlen(value, limit);
    unsigned char size[8];

    for (size_t i = 0; i < sizeof size; i++)
        size[i] = (unsigned char)((uint64_t)length >> (8 * i));
    add_bytes(entry, name, strlen(name));
    add_bytes(entry, "\n", 1);
    add_bytes(entry, size, sizeof size);
    add_bytes(entry, value, length);
    add_bytes(entry, "\n", 1);
}

static void add_integer(struct entry *entry, const char *name, int64_t value)
{
    char text[64];
    int length = snprintf(text, sizeof text, "%s=%" PRId64 "\n", name, value);

    add_bytes(entry, text, (size_t)length);
}

size_t journal_format_entry(char entry[static JOURNAL_ENTRY_SIZE], enum log_level level,
                            const struct log_subject *subject, const char *line)
{
    static const int priorities[] = {7, 6, 4, 3}; // of syslog
    struct entry made = {.bytes = entry};

    add_text(&made, "MESSAGE", line, LOG_LINE_SIZE);
    add_integer(&made, "PRIORITY", priorities[level]);
    add_text(&made, "SYSLOG_IDENTIFIER", "marchd", OWNER_LIMIT);
    if (subject->job) add_integer(&made, "MARCHD_JOB", subject->job);
    if (subject->job && subject->attempt) {
        add_integer(&made, "MARCHD_FRAME", subject->frame);
        add_integer(&made, "MARCHD_ATTEMPT", subject->attempt);
    }
    if (subject->worker) add_integer(&made, "MARCHD_WORKER", subject->worker);
    if (subject->owner) add_text(&made, "MARCHD_OWNER", subject->owner, OWNER_LIMIT);
    return made.length;
}

static bool send_line(enum log_level level, const struct log_subject *subject, const char *line)
{
    char entry[JOURNAL_ENTRY_SIZE];
    size_t length = journal_format_entry(entry, level, subject, line);

    return sendto(journal_fd, entry, length, MSG_DONTWAIT | MSG_NOSIGNAL, (const struct sockaddr *)&journal_address,
                  sizeof journal_address) >= 0;
}

static void report_lost(void)
{
    long lost = lost_count;
    char line[64];

    if (lost == 0) return;
    snprintf(line, sizeof line, "the journal lost %ld lines", lost);
    if (send_line(LOG_WARN, &(struct log_subject){0}, line)) lost_count -= lost;
}

static void send_to_journal(enum log_level level, const struct log_subject *subject, const char *line)
{
    report_lost();
    if (!send_line(level, subject, line)) lost_count++;
}

bool journal_open(const char *stream, const char *socket_path)
{
    journal_close();
    if (!is_stderr(stream) || strlen(socket_path) >= sizeof journal_address.sun_path) return false;
    if (access(socket_path, W_OK) != 0) return false;
    journal_address = (struct sockaddr_un){.sun_family = AF_UNIX};
    memcpy(journal_address.sun_path, socket_path, strlen(socket_path));
    journal_fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (journal_fd >= 0) log_set_sink(send_to_journal);
    return journal_fd >= 0;
}

void journal_close(void)
{
    log_set_sink(NULL);
    if (journal_fd >= 0) close(journal_fd);
    journal_fd = -1;
    lost_count = 0;
}
