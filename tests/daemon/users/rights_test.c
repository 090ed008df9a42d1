// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/rights.h"

#include <grp.h>
#include <pwd.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

enum { DAEMON = 990, ADMINS = 995, ADA = 1000, BOB = 1001 };

static const struct rights rights = {.daemon_uid = DAEMON, .admin_gid = ADMINS};
static const struct rights without_group = {.daemon_uid = DAEMON, .admin_gid = -1};

static struct rights_peer peer_of(int64_t uid)
{
    static const gid_t groups[] = {100, 101, 1000};

    return (struct rights_peer){.uid = uid, .groups = groups, .group_count = 3};
}

static struct rights_peer admin_peer(int64_t uid)
{
    static const gid_t groups[] = {100, ADMINS, 1000};

    return (struct rights_peer){.uid = uid, .groups = groups, .group_count = 3};
}

static void an_owner_changes_only_their_own_jobs(void **state)
{
    struct rights_peer ada = peer_of(ADA);

    assert_true(rights_may_change(&rights, &ada, ADA));
    assert_false(rights_may_change(&rights, &ada, BOB));
    assert_false(rights_may_change(&rights, &ada, 0));
    assert_false(rights_is_admin(&rights, &ada));
}

static void root_and_the_daemons_user_change_any(void **state)
{
    struct rights_peer root = peer_of(0), daemon = peer_of(DAEMON);

    assert_true(rights_may_change(&rights, &root, ADA));
    assert_true(rights_may_change(&rights, &daemon, ADA));
    assert_true(rights_is_admin(&rights, &root));
    assert_true(rights_is_admin(&rights, &daemon));
}

static void members_of_the_admin_group_change_any(void **state)
{
    struct rights_peer bob = admin_peer(BOB);

    assert_true(rights_may_change(&rights, &bob, ADA));
    assert_true(rights_is_admin(&rights, &bob));
    assert_false(rights_may_change(&without_group, &bob, ADA));
}

// (gid_t)-1 is no group: it must not match the missing admin group.
static void a_group_that_does_not_exist_has_no_members(void **state)
{
    const gid_t groups[] = {(gid_t)-1};
    struct rights_peer peer = {.uid = BOB, .groups = groups, .group_count = 1};
    struct rights found;

    rights_init(&found, DAEMON, "no-such-group-as-this");
    assert_int_equal(found.admin_gid, -1);
    assert_false(rights_is_admin(&found, &peer));
}

static void an_unknown_user_changes_nothing(void **state)
{
    struct rights_peer unknown = admin_peer(-1), overflow = admin_peer(RIGHTS_OVERFLOW_UID);

    assert_false(rights_may_change(&rights, &unknown, ADA));
    assert_false(rights_may_change(&rights, &unknown, -1));
    assert_false(rights_may_change(&rights, &overflow, RIGHTS_OVERFLOW_UID));
    assert_false(rights_is_admin(&rights, &overflow));
    assert_false(rights_is_known(&unknown));
    assert_false(rights_is_known(&overflow));
}

static void a_user_without_a_connection_is_looked_up(void **state)
{
    const struct passwd *me = getpwuid(getuid());
    struct rights found;
    char *name;

    if (!me) skip();
    name = me->pw_name;
    found = (struct rights){.daemon_uid = -1, .admin_gid = (int64_t)me->pw_gid};
    assert_true(rights_user_is_admin(&found, getuid(), name));
    found.admin_gid = 0x7ffffff0;
    assert_int_equal(rights_user_is_admin(&found, getuid(), name), getuid() == 0);
    // The name belongs to another uid today.
    found.admin_gid = (int64_t)me->pw_gid;
    assert_false(rights_user_is_admin(&found, 54321, name));
    assert_false(rights_user_is_admin(&found, 54321, "nobody-of-that-name"));
}

// A token says so of its connection.
static void an_ordinary_peer_is_no_administrator_whoever_it_is(void **state)
{
    static const int64_t uids[] = {0, DAEMON, BOB};

    for (size_t i = 0; i < sizeof uids / sizeof *uids; i++) {
        struct rights_peer peer = admin_peer(uids[i]);

        assert_true(rights_is_admin(&rights, &peer));
        assert_true(rights_may_change(&rights, &peer, ADA));
        peer.is_ordinary = true;
        assert_false(rights_is_admin(&rights, &peer));
        assert_false(rights_may_change(&rights, &peer, ADA));
        assert_true(rights_may_change(&rights, &peer, uids[i]));
        assert_true(rights_is_known(&peer));
    }
}

// A token names its user by both.
static void groups_are_those_of_a_name_and_its_number(void **state)
{
    size_t count;
    gid_t *groups = rights_find_groups(0, "root", &count);

    assert_non_null(groups);
    assert_true(count > 0);
    free(groups);
    assert_null(rights_find_groups(1, "root", &count));
    assert_null(rights_find_groups(0, "there-is-no-such-user", &count));
    assert_int_equal(count, 0);
}

static void the_web_user_is_looked_up_by_name(void **state)
{
    static const char *const none[] = {NULL, "", "there-is-no-such-user"};
    struct rights_peer root = peer_of(0), ada = peer_of(ADA);
    struct rights looked_up = {0};

    assert_false(rights_is_web_user(&looked_up, &root));
    rights_set_web_user(&looked_up, "root");
    assert_true(rights_is_web_user(&looked_up, &root));
    assert_false(rights_is_web_user(&looked_up, &ada));
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        rights_set_web_user(&looked_up, none[i]);
        assert_false(rights_is_web_user(&looked_up, &root));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_ordinary_peer_is_no_administrator_whoever_it_is),
        cmocka_unit_test(groups_are_those_of_a_name_and_its_number),
        cmocka_unit_test(the_web_user_is_looked_up_by_name),
        cmocka_unit_test(an_owner_changes_only_their_own_jobs),
        cmocka_unit_test(root_and_the_daemons_user_change_any),
        cmocka_unit_test(members_of_the_admin_group_change_any),
        cmocka_unit_test(a_group_that_does_not_exist_has_no_members),
        cmocka_unit_test(an_unknown_user_changes_nothing),
        cmocka_unit_test(a_user_without_a_connection_is_looked_up),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
