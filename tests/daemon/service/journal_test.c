// The entries that the journal gets, and that logging never blocks on it.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/journal.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cmocka.h>

static int listen_as_journal(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);

    snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    assert_int_equal(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
    return fd;
}

// The value of JOURNAL_STREAM for the present standard error.
static const char *own_stream(void)
{
    static char text[64];
    struct stat status;

    assert_int_equal(fstat(STDERR_FILENO, &status), 0);
    snprintf(text, sizeof text, "%ju:%ju", (uintmax_t)status.st_dev, (uintmax_t)status.st_ino);
    return text;
}

// Finds a field of an entry: NAME=VALUE lines, or NAME, a line feed, eight bytes of length, and the value.
struct field {
    char name[32], value[LOG_LINE_SIZE];
};

static int split(const char *entry, size_t length, struct field fields[static 8])
{
    int count = 0;

    for (const char *at = entry, *end = entry + length; at < end; count++) {
        struct field *field = &fields[count];
        size_t name_length = strcspn(at, "=\n"), size = 0;

        assert_in_range(count, 0, 7);
        snprintf(field->name, sizeof field->name, "%.*s", (int)name_length, at);
        at += name_length + 1;
        if (at[-1] == '=') {
            size = strcspn(at, "\n");
        } else {
            for (int i = 7; i >= 0; i--)
                size = size << 8 | (unsigned char)at[i];
            at += 8;
        }
        snprintf(field->value, sizeof field->value, "%.*s", (int)size, at);
        at += size;
        assert_int_equal(*at++, '\n');
    }
    return count;
}

static const char *value_of(const struct field *fields, int count, const char *name)
{
    for (int i = 0; i < count; i++)
        if (strcmp(fields[i].name, name) == 0) return fields[i].value;
    return NULL;
}

static const char *receive(int fd, const char *name)
{
    static struct field fields[8];
    static int count;
    char entry[JOURNAL_ENTRY_SIZE];
    ssize_t length = fd >= 0 ? recv(fd, entry, sizeof entry, 0) : 0;

    assert_true(length >= 0);
    if (length > 0) count = split(entry, (size_t)length, fields);
    return value_of(fields, count, name);
}

static void a_line_comes_with_its_fields(void **state)
{
    const char *path = temp_folder_path(state, "journal");
    int fd = listen_as_journal(path);

    assert_true(journal_open(own_stream(), path));
    log_about(LOG_WARN, &(struct log_subject){.job = 12, .frame = -4, .attempt = 2, .worker = 3, .owner = "ann"},
              "frame %d failed", -4);
    assert_string_equal(receive(fd, "MESSAGE"), "frame -4 failed");
    assert_string_equal(receive(-1, "PRIORITY"), "4");
    assert_string_equal(receive(-1, "SYSLOG_IDENTIFIER"), "marchd");
    assert_string_equal(receive(-1, "MARCHD_JOB"), "12");
    assert_string_equal(receive(-1, "MARCHD_FRAME"), "-4");
    assert_string_equal(receive(-1, "MARCHD_ATTEMPT"), "2");
    assert_string_equal(receive(-1, "MARCHD_WORKER"), "3");
    assert_string_equal(receive(-1, "MARCHD_OWNER"), "ann");
    journal_close();
    close(fd);
}

static void an_unknown_value_has_no_field(void **state)
{
    const char *path = temp_folder_path(state, "journal");
    int fd = listen_as_journal(path);

    assert_true(journal_open(own_stream(), path));
    log_about(LOG_ERROR, &(struct log_subject){.job = 12, .frame = 1}, "no attempt");
    assert_string_equal(receive(fd, "MARCHD_JOB"), "12");
    assert_string_equal(receive(-1, "PRIORITY"), "3");
    assert_null(receive(-1, "MARCHD_FRAME"));
    log_info("about nothing");
    assert_string_equal(receive(fd, "PRIORITY"), "6");
    for (const char *const *name = (const char *const[]){"MARCHD_JOB", "MARCHD_FRAME", "MARCHD_ATTEMPT",
                                                         "MARCHD_WORKER", "MARCHD_OWNER", NULL};
         *name; name++)
        assert_null(receive(-1, *name));
    journal_close();
    close(fd);
}

static void no_text_adds_a_field_or_an_entry(void **state)
{
    const char *path = temp_folder_path(state, "journal");
    int fd = listen_as_journal(path);

    assert_true(journal_open(own_stream(), path));
    log_about(LOG_INFO, &(struct log_subject){.job = 1, .owner = "eve\nMARCHD_JOB=2"}, "%s",
              "x\nPRIORITY=0\n\n_UID=0\nMARCHD_JOB=3");
    assert_string_equal(receive(fd, "MESSAGE"), "x\nPRIORITY=0\n\n_UID=0\nMARCHD_JOB=3");
    assert_string_equal(receive(-1, "PRIORITY"), "6");
    assert_string_equal(receive(-1, "MARCHD_JOB"), "1");
    assert_string_equal(receive(-1, "MARCHD_OWNER"), "eve\nMARCHD_JOB=2");
    assert_null(receive(-1, "_UID"));
    assert_int_equal(recv(fd, (char[8]){0}, 8, 0), -1);
    journal_close();
    close(fd);
}

static void the_longest_entry_fits(void **state)
{
    char entry[JOURNAL_ENTRY_SIZE], line[2 * LOG_LINE_SIZE], owner[4096];
    struct log_subject subject = {
        .job = INT64_MIN, .frame = INT32_MIN, .attempt = INT32_MIN, .worker = INT32_MIN, .owner = owner};

    memset(line, 'x', sizeof line - 1);
    memset(owner, 'y', sizeof owner - 1);
    line[sizeof line - 1] = owner[sizeof owner - 1] = '\0';
    assert_in_range(journal_format_entry(entry, LOG_DEBUG, &subject, line), LOG_LINE_SIZE, JOURNAL_ENTRY_SIZE);
}

static void another_standard_error_is_kept(void **state)
{
    const char *path = temp_folder_path(state, "journal");
    int fd = listen_as_journal(path);

    assert_false(journal_open(NULL, path));
    assert_false(journal_open("", path));
    assert_false(journal_open("1:1", path));
    assert_false(journal_open(own_stream(), temp_folder_path(state, "nothing")));
    log_info("on standard error");
    assert_int_equal(recv(fd, (char[8]){0}, 8, 0), -1);
    close(fd);
}

static void logging_does_not_wait_for_a_journal_that_does_not_read(void **state)
{
    const char *path = temp_folder_path(state, "journal");
    int fd = listen_as_journal(path), taken = 0;
    char entry[JOURNAL_ENTRY_SIZE];

    assert_true(journal_open(own_stream(), path));
    for (int i = 0; i < 5000; i++)
        log_info("line %d", i);
    while (recv(fd, entry, sizeof entry, 0) > 0)
        taken++;
    assert_in_range(taken, 1, 4999);
    log_info("one more");
    snprintf(entry, sizeof entry, "the journal lost %d lines", 5000 - taken);
    assert_string_equal(receive(fd, "MESSAGE"), entry);
    assert_string_equal(receive(fd, "MESSAGE"), "one more");
    log_info("and another");
    assert_string_equal(receive(fd, "MESSAGE"), "and another");
    journal_close();
    close(fd);
}

static void a_restarted_journal_is_found(void **state)
{
    const char *path = temp_folder_path(state, "journal");
    int fd = listen_as_journal(path);

    assert_true(journal_open(own_stream(), path));
    close(fd);
    unlink(path);
    log_info("lost");
    fd = listen_as_journal(path);
    log_info("heard");
    assert_string_equal(receive(fd, "MESSAGE"), "the journal lost 1 lines");
    assert_string_equal(receive(fd, "MESSAGE"), "heard");
    journal_close();
    close(fd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_line_comes_with_its_fields, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(an_unknown_value_has_no_field, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(no_text_adds_a_field_or_an_entry, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(the_longest_entry_fits),
        cmocka_unit_test_setup_teardown(another_standard_error_is_kept, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(logging_does_not_wait_for_a_journal_that_does_not_read, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_restarted_journal_is_found, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
