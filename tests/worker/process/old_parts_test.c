// Plays a second daemon to the real worker, after one that was killed.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/test_worker.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <cmocka.h>

static void say_job(const struct test_worker *child, int epoch, const char *members)
{
    test_worker_say(
        child,
        "{\"jsonrpc\":\"2.0\",\"method\":\"worker.job\",\"params\":{\"job\":7,\"epoch\":%d,\"root\":\"%s\",%s"
        "\"owner\":\"ada\",\"document\":{\"version\":1,\"name\":\"test\",\"frames\":\"10-99\",\"fps\":24,"
        "\"resolution\":[16,9],\"camera\":{\"position\":[0,0,4],\"target\":[0,0,0],\"fov\":30},"
        "\"scene\":{\"media\":[{\"density\":{\"kind\":\"noise\",\"frequency\":1,\"bounds\":{\"kind\":\"sphere\","
        "\"center\":[0,0,0],\"radius\":1}},\"sigma_a\":1}]},\"quality\":{\"method\":\"midpoint\",\"step\":0.1},"
        "\"output\":{\"path\":\"t.####.exr\"}}}}",
        epoch, child->root, members);
}

static void say_assign(const struct test_worker *child, const char *frames)
{
    test_worker_say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.assign\",\"params\":{\"job\":7,\"frames\":%s}}",
                    frames);
}

// The inode of a file, 0 where there is none.
static uint64_t inode_of(const struct test_worker *child, const char *name)
{
    char path[256];
    struct stat status;

    snprintf(path, sizeof path, "%s/%s", child->root, name);
    return stat(path, &status) == 0 ? (uint64_t)status.st_ino : 0;
}

static uint64_t expect_finished(struct test_worker *child)
{
    struct message message = test_worker_expect(child, "frame.finished");
    uint64_t inode = strtoull(test_worker_text_of(&message, "inode"), NULL, 10);

    message_finish(&message);
    return inode;
}

static void part_file_of_an_earlier_start_is_taken_if_it_is_of_the_frame(void **state)
{
    struct test_worker child;
    char path[256], target[256];
    uint64_t inode, wrong;

    test_worker_start_renderer(&child);
    say_job(&child, 3, "");
    say_assign(&child, "[[10,1],[12,1]]");
    inode = expect_finished(&child);
    expect_finished(&child);
    // That of frame 12 has the name of one of frame 11.
    snprintf(path, sizeof path, "%s/t.0012.exr.7.3.1.part", child.root);
    snprintf(target, sizeof target, "%s/t.0011.exr.7.3.1.part", child.root);
    assert_int_equal(rename(path, target), 0);

    say_job(&child, 4, "\"old_parts\":true,");
    say_assign(&child, "[[10,1],[11,1],[10,2,true]]");
    assert_true(expect_finished(&child) == inode);
    assert_true(inode_of(&child, "t.0010.exr.7.4.1.part") == inode);
    assert_true(inode_of(&child, "t.0010.exr.7.3.1.part") == 0);
    wrong = inode_of(&child, "t.0011.exr.7.3.1.part"); // whoever sweeps removes it
    assert_true(wrong != 0 && expect_finished(&child) != wrong);
    assert_true(expect_finished(&child) != inode); // frame 10 was to be rendered in any case
    test_worker_say(&child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\"}");
    assert_int_equal(test_worker_finish(&child), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(part_file_of_an_earlier_start_is_taken_if_it_is_of_the_frame),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
