// Feeding of the watchdog by a loop that runs, and by one that hangs.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/watchdog.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cmocka.h>

static int listen_as_manager(void **state)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);

    snprintf(address.sun_path, sizeof address.sun_path, "%s", temp_folder_path(state, "notify"));
    assert_int_equal(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
    setenv("NOTIFY_SOCKET", address.sun_path, 1);
    return fd;
}

static int count_fed(int fd)
{
    char text[64];
    int count = 0;

    for (ssize_t length; (length = recv(fd, text, sizeof text - 1, 0)) > 0; count++) {
        text[length] = '\0';
        assert_string_equal(text, "WATCHDOG=1");
    }
    return count;
}

static void on_end(uv_timer_t *timer)
{
    uv_close((uv_handle_t *)timer, NULL);
    watchdog_close(timer->data);
}

static void block(uv_timer_t *timer)
{
    usleep(400000);
    on_end(timer);
}

static void a_running_loop_feeds_the_watchdog(void **state)
{
    int fd = listen_as_manager(state), fed = 0;
    struct watchdog *watchdog;
    uint64_t start_ms;
    uv_loop_t loop;

    setenv("WATCHDOG_USEC", "200000", 1);
    uv_loop_init(&loop);
    start_ms = uv_now(&loop);
    watchdog = watchdog_open(&loop);
    assert_non_null(watchdog);
    while ((fed += count_fed(fd)) < 4)
        uv_run(&loop, UV_RUN_ONCE);
    // The watchdog is fed twice per interval, and not more often.
    uv_update_time(&loop);
    assert_true(uv_now(&loop) - start_ms >= 3 * 100);
    watchdog_close(watchdog);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    close(fd);
}

static void a_loop_that_hangs_does_not(void **state)
{
    int fd = listen_as_manager(state);
    uv_loop_t loop;
    uv_timer_t hang;

    setenv("WATCHDOG_USEC", "400000", 1);
    uv_loop_init(&loop);
    uv_timer_init(&loop, &hang);
    hang.data = watchdog_open(&loop);
    uv_timer_start(&hang, block, 0, 0);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    assert_int_equal(count_fed(fd), 0);
    close(fd);
}

static void without_a_manager_nothing_is_fed(void **state)
{
    uv_loop_t loop;

    unsetenv("WATCHDOG_USEC");
    uv_loop_init(&loop);
    assert_null(watchdog_open(&loop));
    watchdog_close(NULL);
    assert_int_equal(uv_loop_close(&loop), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_running_loop_feeds_the_watchdog, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_loop_that_hangs_does_not, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(without_a_manager_nothing_is_fed),
    };

    unsetenv("WATCHDOG_PID");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
