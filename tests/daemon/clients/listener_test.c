// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/listener.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/loop/memory_return.h"
#include "daemon/loop/work_desk.h"
#include "daemon/users/rights.h"
#include "tests/support/temp_folder.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cmocka.h>

enum { CONNECTIONS = 40, OF_A_TURN = 16, OTHER_FILES = 4 }; // others: what the system opens to look up a user

static int count_files(void)
{
    DIR *files = opendir("/proc/self/fd");
    int count = 0;

    while (readdir(files))
        count++;
    closedir(files);
    return count;
}

static void connect_all(const char *path, int fds[static CONNECTIONS])
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};

    assert_true(strlen(path) < sizeof address.sun_path);
    strcpy(address.sun_path, path);
    for (int i = 0; i < CONNECTIONS; i++) {
        fds[i] = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        assert_int_equal(connect(fds[i], (struct sockaddr *)&address, sizeof address), 0);
    }
}

static void on_message(void *user, struct client *client, struct message *message)
{
}

static void on_gone(void *user, struct client *client)
{
}

static void connections_are_accepted_by_turns_and_descriptors(void **state)
{
    char *path = xstrdup(temp_folder_path(state, "socket"));
    struct rlimit limit, few;
    struct listener *listener;
    struct error error = {0};
    int fds[CONNECTIONS], before;
    uv_loop_t loop;
    const struct rights rights = {.daemon_uid = geteuid(), .admin_gid = -1};
    struct listener_params params = {.path = path, .rights = &rights, .on_message = on_message, .on_gone = on_gone};

    uv_loop_init(&loop);
    params.turns = loop_turns_open(&loop);
    params.desk = work_desk_create(&loop);
    params.memory = memory_return_open(&loop);
    listener = listener_open(&loop, &params, &error);
    if (!listener) fail_msg("%s", error.message);
    uv_run(&loop, UV_RUN_NOWAIT);
    connect_all(path, fds);
    before = count_files();
    uv_run(&loop, UV_RUN_NOWAIT);
    assert_in_range(count_files() - before, 1, OF_A_TURN + OTHER_FILES);
    // Without descriptors the others wait, and the loop does not look at them again and again.
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &limit), 0);
    few = (struct rlimit){.rlim_cur = 3, .rlim_max = limit.rlim_max};
    before = count_files();
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
    for (int turn = 0; turn < 100; turn++)
        uv_run(&loop, UV_RUN_NOWAIT);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &limit), 0);
    for (int turn = 0; turn < 100; turn++)
        uv_run(&loop, UV_RUN_NOWAIT);
    assert_int_equal(count_files(), before); // accepting is paused for a second
    for (int i = 0; i < CONNECTIONS; i++)
        close(fds[i]);
    listener_close(listener);
    memory_return_close(params.memory);
    loop_turns_close(params.turns);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    work_desk_destroy(params.desk);
    free(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(connections_are_accepted_by_turns_and_descriptors, temp_folder_create,
                                        temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
