// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/root_look.h"

#include "core/job/output_root.h"
#include "tests/support/temp_folder.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cmocka.h>

enum { NOBODY = 65534 };

static const char farm[] = "0123456789abcdef0123456789abcdef";

static struct root_look look_at(const char *root, const char *id)
{
    struct root_look look = {.path = root, .farm = farm, .state_folder = "/var/lib/marchd"};

    strcpy(look.id, id);
    root_look_run(&look);
    return look;
}

static void unknown_folder_is_marked_once(void **state)
{
    struct root_look first = look_at(*state, ""), second = look_at(*state, first.id), other = look_at(*state, "");
    char found[ROOT_MARKER_ID_SIZE];

    assert_true(first.is_there && first.was_marked);
    assert_true(second.is_there && !second.was_marked);
    assert_true(other.is_there && !other.was_marked);
    assert_string_equal(other.id, first.id);
    assert_memory_equal(&second.place, &first.place, sizeof first.place);
    assert_true(root_marker_find_farm(*state, "/var/lib/marchd", found));
    assert_string_equal(found, farm);
}

static void known_root_is_neither_made_nor_marked(void **state)
{
    struct root_look bare = look_at(*state, farm), missing = look_at(temp_folder_path(state, "none"), farm);

    assert_false(bare.is_there || bare.was_marked);
    assert_non_null(strstr(bare.error.message, "has no .marchd-root (is its disk mounted?)"));
    assert_int_equal(access(temp_folder_path(state, ROOT_MARKER_NAME), F_OK), -1);
    assert_false(missing.is_there);
    assert_non_null(strstr(missing.error.message, "is not there: No such file or directory"));
    assert_int_equal(access(temp_folder_path(state, "none"), F_OK), -1);
}

static void other_root_is_not_the_one(void **state)
{
    struct root_look look = look_at(*state, "");
    char id[ROOT_MARKER_ID_SIZE];

    memcpy(id, look.id, sizeof id);
    id[0] = id[0] == '0' ? '1' : '0';
    look = look_at(*state, id);
    assert_false(look.is_there);
    assert_non_null(strstr(look.error.message, "is another one: its .marchd-root says "));
}

static void a_link_that_leads_elsewhere_is_away_until_it_leads_back(void **state)
{
    const char *link = temp_folder_path(state, "link"), *root = temp_folder_path(state, "root");
    const char *other = temp_folder_path(state, "other");
    struct root_look first, look;

    mkdir(root, 0755);
    mkdir(other, 0755);
    assert_int_equal(symlink(root, link), 0);
    first = look_at(link, "");
    assert_true(first.is_there);
    assert_int_equal(unlink(link), 0);
    assert_int_equal(symlink(other, link), 0);
    look = look_at(link, first.id);
    assert_false(look.is_there || look.was_marked);
    assert_non_null(strstr(look.error.message, "is not the folder that it was"));
    assert_true(look_at(other, "").is_there); // marked by another farm
    look = look_at(link, first.id);
    assert_false(look.is_there);
    assert_non_null(strstr(look.error.message, "is another one"));
    assert_int_equal(unlink(link), 0);
    assert_int_equal(symlink(root, link), 0);
    look = look_at(link, first.id);
    assert_true(look.is_there);
    assert_memory_equal(&look.place, &first.place, sizeof first.place);
}

static void empty_marker_gets_the_expected_id(void **state)
{
    struct root_look look;

    close(open(temp_folder_path(state, ROOT_MARKER_NAME), O_WRONLY | O_CREAT, 0644));
    look = look_at(*state, farm);
    assert_true(look.is_there && look.was_marked);
    assert_string_equal(look.id, farm);
}

// The daemon is not root, whose `touch` makes such a marker.
static void empty_marker_of_another_user_is_made_anew_in_a_folder_of_ours(void **state)
{
    const char *marker = temp_folder_path(state, ROOT_MARKER_NAME);
    bool is_root = geteuid() == 0;
    struct root_look closed, look;

    close(open(marker, O_WRONLY | O_CREAT, 0444));
    assert_int_equal(chmod(*state, 0555), 0);
    assert_int_equal(is_root ? chown(*state, NOBODY, NOBODY) : 0, 0);
    assert_int_equal(is_root ? seteuid(NOBODY) : 0, 0);
    closed = look_at(*state, farm);
    assert_int_equal(chmod(*state, 0755), 0);
    look = look_at(*state, farm);
    assert_int_equal(is_root ? seteuid(0) : 0, 0);
    assert_false(closed.is_there);
    assert_non_null(strstr(closed.error.message, "empty marker: cannot write .marchd-root: Permission denied"));
    assert_true(look.is_there && look.was_marked);
    assert_string_equal(look.id, farm);
}

static void root_of_an_older_version_is_known_by_a_folder_of_its_jobs(void **state)
{
    char a[] = "old/a", b[] = "old/b", *folders[] = {a, b};
    struct root_look look = {.path = *state, .farm = farm, .state_folder = "/s", .folders = folders, .folder_count = 2};

    root_look_run(&look);
    assert_false(look.is_there || look.was_marked);
    assert_non_null(strstr(look.error.message, "holds no folder of its jobs"));
    mkdir(temp_folder_path(state, "old"), 0755);
    mkdir(temp_folder_path(state, "old/b"), 0755);
    root_look_run(&look);
    assert_true(look.is_there && look.was_marked);
}

// A daemon that may open no file sees no root, which says nothing of the root.
static void shortage_of_descriptors_is_not_the_root_away(void **state)
{
    struct root_look marked = look_at(*state, ""), look;
    struct rlimit limit, none;

    assert_int_equal(getrlimit(RLIMIT_NOFILE, &limit), 0);
    none = limit;
    none.rlim_cur = 3;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    look = look_at(*state, marked.id);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &limit), 0);
    assert_true(!look.is_there && look.is_unknown);
    look = look_at(temp_folder_path(state, "none"), marked.id);
    assert_false(look.is_there || look.is_unknown);
}

// What the descriptor of a checked root opens is in that root, whatever the path leads to by then.
static void folder_of_an_open_root_is_not_of_its_successor(void **state)
{
    const char *root = temp_folder_path(state, "root"), *gone = temp_folder_path(state, "gone");
    struct root_look look;
    int root_fd;

    mkdir(root, 0755);
    look = look_at(root, "");
    root_fd = output_root_open(root, look.id, NULL);
    assert_true(root_fd >= 0 && output_root_is_at(root_fd, root));
    assert_int_equal(rename(root, gone), 0);
    mkdir(root, 0755);
    assert_false(output_root_is_at(root_fd, root));
    assert_int_equal(mkdirat(root_fd, "frames", 0755), 0);
    assert_int_equal(access(temp_folder_path(state, "gone/frames"), F_OK), 0);
    assert_int_equal(output_root_open(root, look.id, NULL), OUTPUT_ROOT_AWAY);
    close(root_fd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(unknown_folder_is_marked_once, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(known_root_is_neither_made_nor_marked, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(other_root_is_not_the_one, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_link_that_leads_elsewhere_is_away_until_it_leads_back, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(empty_marker_gets_the_expected_id, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(empty_marker_of_another_user_is_made_anew_in_a_folder_of_ours,
                                        temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(root_of_an_older_version_is_known_by_a_folder_of_its_jobs, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(shortage_of_descriptors_is_not_the_root_away, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(folder_of_an_open_root_is_not_of_its_successor, temp_folder_create,
                                        temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
