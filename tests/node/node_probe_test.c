// SPDX-License-Identifier: Apache-2.0
#include "node/node_probe.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "tests/support/temp_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static const char id[] = "0123456789abcdef0123456789abcdef", other_id[] = "f123456789abcdef0123456789abcdef";

struct pair {
    struct node_probe daemon, node;
    struct error error;
};

static int count_files(void **state, const char *folder)
{
    DIR *entries = opendir(temp_folder_path(state, folder));
    int count = -2;

    assert_non_null(entries);
    while (readdir(entries))
        count++;
    closedir(entries);
    return count;
}

static void make_root(void **state, const char *name, const char *root_id)
{
    char file[64], text[64];

    assert_int_equal(mkdir(temp_folder_path(state, name), 0755), 0);
    snprintf(file, sizeof file, "%s/.marchd-root", name);
    snprintf(text, sizeof text, "root %s\n", root_id);
    assert_true(file_write_atomic(temp_folder_path(state, file), text, strlen(text), NULL));
}

// What `from` wrote is told to `to`, which may have said what is wrong.
static bool tell(const struct node_probe *from, const char *fault, struct node_probe *to, struct error *error)
{
    struct json_writer writer = {0};
    struct cJSON *root;
    struct json_node object;
    bool ok;

    node_probe_write_json(from, fault, &writer);
    assert_true(json_parse(&root, writer.text, writer.length, error));
    object = json_node_root(root);
    ok = node_probe_read_json(to, &object, error);
    json_delete(root);
    json_writer_finish(&writer);
    return ok;
}

// The daemon's part up to what the node is told.
static void begin(void **state, struct pair *pair)
{
    *pair = (struct pair){0};
    root_marker_make_id(pair->daemon.token);
    node_probe_add(&pair->daemon, temp_folder_path(state, "root"), id);
    assert_true(node_probe_write(&pair->daemon, NODE_PROBE_DAEMON, &pair->error));
    assert_true(tell(&pair->daemon, NULL, &pair->node, &pair->error));
}

static bool answer(struct pair *pair)
{
    return node_probe_look(&pair->node, NODE_PROBE_DAEMON, 0, &pair->error) &&
           node_probe_write(&pair->node, NODE_PROBE_NODE, &pair->error);
}

static void end(struct pair *pair)
{
    node_probe_finish(&pair->daemon);
    node_probe_finish(&pair->node);
}

static void both_see_one_folder(void **state)
{
    struct pair pair;

    make_root(state, "root", id);
    begin(state, &pair);
    assert_true(answer(&pair));
    assert_int_equal(count_files(state, "root"), 3);
    pair.node.seen_ms = 350;
    assert_true(tell(&pair.node, NULL, &pair.daemon, &pair.error));
    assert_int_equal(pair.daemon.seen_ms, 350);
    assert_true(node_probe_look(&pair.daemon, NODE_PROBE_NODE, 0, &pair.error));
    node_probe_remove(&pair.daemon);
    assert_int_equal(count_files(state, "root"), 1);
    end(&pair);
}

static void assert_refused(struct pair *pair, const char *what)
{
    assert_false(answer(pair));
    assert_non_null(strstr(pair->error.message, what));
    end(pair);
}

static void a_folder_that_the_node_does_not_see(void **state)
{
    struct pair pair;

    make_root(state, "root", id);
    make_root(state, "other", other_id);
    make_root(state, "copy", id);
    begin(state, &pair);
    assert_int_equal(rename(temp_folder_path(state, "root"), temp_folder_path(state, "away")), 0);
    assert_refused(&pair, "/root");

    assert_int_equal(rename(temp_folder_path(state, "away"), temp_folder_path(state, "root")), 0);
    begin(state, &pair);
    assert_int_equal(rename(temp_folder_path(state, "root"), temp_folder_path(state, "away")), 0);
    assert_int_equal(rename(temp_folder_path(state, "other"), temp_folder_path(state, "root")), 0);
    assert_refused(&pair, "is another one");

    assert_int_equal(rename(temp_folder_path(state, "root"), temp_folder_path(state, "other")), 0);
    assert_int_equal(rename(temp_folder_path(state, "away"), temp_folder_path(state, "root")), 0);
    begin(state, &pair);
    assert_int_equal(rename(temp_folder_path(state, "root"), temp_folder_path(state, "away")), 0);
    assert_int_equal(rename(temp_folder_path(state, "copy"), temp_folder_path(state, "root")), 0);
    assert_refused(&pair, "is not seen within 0 s: not the same disk");
}

static void a_file_that_is_another_one(void **state)
{
    struct pair pair;

    make_root(state, "root", id);
    begin(state, &pair);
    pair.node.roots[0].told.inode++;
    assert_refused(&pair, "another inode number on each machine");
    begin(state, &pair);
    pair.node.roots[0].told.uid++;
    assert_refused(&pair, "expected one uid");
}

static void what_the_node_says_is_wrong(void **state)
{
    struct pair pair;

    make_root(state, "root", id);
    begin(state, &pair);
    assert_true(answer(&pair));
    assert_false(tell(&pair.node, "no such folder", &pair.daemon, &pair.error));
    assert_string_equal(pair.error.message, "no such folder");
    root_marker_make_id(pair.node.token);
    assert_false(tell(&pair.node, NULL, &pair.daemon, &pair.error));
    assert_non_null(strstr(pair.error.message, "token"));
    end(&pair);
}

static void an_answer_names_no_other_roots(void **state)
{
    struct pair pair;

    make_root(state, "root", id);
    begin(state, &pair);
    node_probe_add(&pair.node, "/etc/shadow", "");
    assert_false(tell(&pair.node, NULL, &pair.daemon, &pair.error));
    assert_non_null(strstr(pair.error.message, "expected a root of the probe"));
    assert_int_equal(pair.daemon.count, 1);
    end(&pair);
}

static void whose_fault_it_is_is_known(void **state)
{
    struct pair pair;

    make_root(state, "root", id);
    begin(state, &pair);
    assert_false(node_probe_look(&pair.daemon, NODE_PROBE_NODE, 0, &pair.error));
    assert_false(pair.daemon.is_own_fault);
    assert_int_equal(rename(temp_folder_path(state, "root"), temp_folder_path(state, "away")), 0);
    assert_false(node_probe_look(&pair.daemon, NODE_PROBE_NODE, 0, &pair.error));
    assert_true(pair.daemon.is_own_fault);
    end(&pair);
}

static void begin_inputs(void **state, struct pair *pair)
{
    *pair = (struct pair){0};
    root_marker_make_id(pair->daemon.token);
    node_probe_add(&pair->daemon, temp_folder_path(state, "missing"), "");
    node_probe_add(&pair->daemon, temp_folder_path(state, "inputs"), "");
    node_probe_add(&pair->daemon, "/", "");
    assert_true(node_probe_write(&pair->daemon, NODE_PROBE_DAEMON, &pair->error));
    assert_int_equal(pair->daemon.count, 2);
    assert_true(tell(&pair->daemon, NULL, &pair->node, &pair->error));
}

static void an_input_root_is_one_folder(void **state)
{
    struct pair pair;

    assert_int_equal(mkdir(temp_folder_path(state, "inputs"), 0755), 0);
    begin_inputs(state, &pair);
    for (size_t i = 0; i < pair.node.count; i++)
        if (strcmp(pair.node.roots[i].path, "/") == 0) pair.node.roots[i].told.inode++;
    assert_true(answer(&pair));
    end(&pair);
    begin_inputs(state, &pair);
    for (size_t i = 0; i < pair.node.count; i++)
        pair.node.roots[i].told.inode++;
    assert_refused(&pair, "another inode number on each machine: not the same folder");
}

static void an_input_root_has_to_be_there(void **state)
{
    struct pair pair = {0};

    assert_int_equal(mkdir(temp_folder_path(state, "inputs"), 0755), 0);
    root_marker_make_id(pair.daemon.token);
    node_probe_add(&pair.daemon, temp_folder_path(state, "inputs"), "");
    assert_true(node_probe_write(&pair.daemon, NODE_PROBE_DAEMON, &pair.error));
    assert_true(tell(&pair.daemon, NULL, &pair.node, &pair.error));
    assert_true(answer(&pair));
    assert_int_equal(count_files(state, "inputs"), 0);
    assert_int_equal(rmdir(temp_folder_path(state, "inputs")), 0);
    assert_refused(&pair, "input root");
}

static void files_of_probes_that_were_cut_off(void **state)
{
    const struct timespec old[2] = {{.tv_sec = 1000000}, {.tv_sec = 1000000}};
    struct pair pair;
    char path[256];

    make_root(state, "root", id);
    begin(state, &pair);
    snprintf(path, sizeof path, "%s/.marchd-probe-%.16s-daemon", pair.daemon.roots[0].path, pair.daemon.token);
    end(&pair);
    begin(state, &pair);
    assert_int_equal(access(path, F_OK), 0);
    end(&pair);
    assert_int_equal(utimensat(AT_FDCWD, path, old, 0), 0);
    begin(state, &pair);
    assert_int_equal(access(path, F_OK), -1);
    end(&pair);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(both_see_one_folder, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_folder_that_the_node_does_not_see, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_file_that_is_another_one, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_the_node_says_is_wrong, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(an_answer_names_no_other_roots, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(whose_fault_it_is_is_known, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(an_input_root_is_one_folder, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(an_input_root_has_to_be_there, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(files_of_probes_that_were_cut_off, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
