// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/daemon_socket.h"

#include "cli/peer/connection.h"
#include "core/base/alloc.h"
#include "core/base/error.h"

#include <pwd.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cmocka.h>

struct place {
    char folder[32];
    char *first, *second;
};

static int set_up(void **state)
{
    struct place *place = xcalloc(1, sizeof *place);

    strcpy(place->folder, "/tmp/daemon_socket.XXXXXX");
    if (!mkdtemp(place->folder) || chmod(place->folder, 0755) != 0) return -1;
    place->first = xasprintf("%s/first", place->folder);
    place->second = xasprintf("%s/second", place->folder);
    *state = place;
    return 0;
}

static int tear_down(void **state)
{
    struct place *place = *state;

    unlink(place->first);
    unlink(place->second);
    rmdir(place->folder);
    free(place->first);
    free(place->second);
    free(place);
    return 0;
}

static int listen_at(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0);

    assert_true(strlen(path) < sizeof address.sun_path);
    strcpy(address.sun_path, path);
    assert_int_equal(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(listen(fd, 4), 0);
    return fd;
}

// Tries both; returns the number of the listener that got the connection, or -1.
static int answered_by(const struct place *place, int first, int second, enum exit_status *status, struct error *error)
{
    char *const paths[] = {place->first, place->second};
    struct connection *connection = daemon_socket_connect(paths, 2, status, error);
    int fd = -1, who = -1;

    if (connection && first >= 0) fd = accept(first, NULL, NULL);
    if (fd >= 0) who = 0;
    if (connection && fd < 0 && second >= 0) fd = accept(second, NULL, NULL);
    if (fd >= 0 && who < 0) who = 1;
    if (fd >= 0) close(fd);
    connection_close(connection);
    return who;
}

static void first_that_listens_answers(void **state)
{
    struct place *place = *state;
    int first = listen_at(place->first), second = listen_at(place->second);
    enum exit_status status;

    assert_int_equal(answered_by(place, first, second, &status, NULL), 0);
    close(first);
    close(second);
}

static void one_that_is_not_there_or_left_over_is_passed_over(void **state)
{
    struct place *place = *state;
    int second = listen_at(place->second);
    enum exit_status status;

    assert_int_equal(answered_by(place, -1, second, &status, NULL), 1);
    close(listen_at(place->first)); // its daemon was killed
    assert_int_equal(answered_by(place, -1, second, &status, NULL), 1);
    close(second);
}

static void paths_that_nobody_listens_at_are_all_named(void **state)
{
    struct place *place = *state;
    struct error error = {0};
    enum exit_status status = EXIT_STATUS_DONE;

    close(listen_at(place->first));
    assert_int_equal(answered_by(place, -1, -1, &status, &error), -1);
    assert_int_equal(status, EXIT_STATUS_NO_DAEMON);
    assert_non_null(strstr(error.message, "/first (Connection refused) or /"));
    assert_non_null(strstr(error.message, "/second (No such file or directory)"));
    assert_non_null(strstr(error.message, "systemctl start marchd"));
}

static void socket_of_a_group_is_not_for_strangers(void **state)
{
    struct place *place = *state;
    struct error error = {0};
    enum exit_status status = EXIT_STATUS_DONE;
    int first, second;

    if (geteuid() != 0) {
        print_message("only root can be somebody else\n");
        skip();
    }
    first = listen_at(place->first);
    assert_int_equal(chmod(place->first, 0660), 0);
    assert_int_equal(setegid(65534), 0);
    assert_int_equal(seteuid(65534), 0);
    assert_int_equal(answered_by(place, first, -1, &status, &error), -1);
    assert_int_equal(seteuid(0), 0);
    assert_int_equal(status, EXIT_STATUS_NOT_ALLOWED);
    assert_non_null(strstr(
        error.message, "/first is not for you: its daemon is one of root's own, for root alone; nor does a daemon"));
    assert_non_null(strstr(error.message, "your own answer at /"));
    assert_non_null(strstr(error.message, "/second (No such file or directory)"));
    assert_int_equal(chown(place->first, 0, 1), 0); // group daemon
    assert_int_equal(seteuid(65534), 0);
    assert_int_equal(answered_by(place, first, -1, &status, &error), -1);
    assert_int_equal(seteuid(0), 0);
    assert_non_null(strstr(error.message, "only group daemon may connect (root adds you with `usermod -aG daemon"));

    // Another user's own daemon.
    assert_int_equal(chown(place->first, 65534, getpwuid(65534)->pw_gid), 0);
    assert_int_equal(setegid(12345), 0);
    assert_int_equal(seteuid(12345), 0);
    assert_int_equal(answered_by(place, first, -1, &status, &error), -1);
    assert_int_equal(seteuid(0), 0);
    assert_int_equal(setegid(65534), 0);
    assert_non_null(
        strstr(error.message, "/first is not for you: its daemon is one of nobody's own, for nobody alone"));
    assert_int_equal(chown(place->first, 0, 1), 0);

    // The user's own daemon.
    second = listen_at(place->second);
    assert_int_equal(chmod(place->second, 0666), 0);
    assert_int_equal(seteuid(65534), 0);
    assert_int_equal(answered_by(place, first, second, &status, &error), 1);
    assert_int_equal(seteuid(0), 0);
    assert_int_equal(setegid(0), 0);
    close(first);
    close(second);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(first_that_listens_answers, set_up, tear_down),
        cmocka_unit_test_setup_teardown(one_that_is_not_there_or_left_over_is_passed_over, set_up, tear_down),
        cmocka_unit_test_setup_teardown(paths_that_nobody_listens_at_are_all_named, set_up, tear_down),
        cmocka_unit_test_setup_teardown(socket_of_a_group_is_not_for_strangers, set_up, tear_down),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
