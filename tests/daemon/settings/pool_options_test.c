// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/pool_options.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_command(const struct pool_options *pool, const char *node, const char *const expected[])
{
    char **command = pool_options_format_command(pool, node);
    size_t count = 0;

    for (; expected[count]; count++) {
        assert_non_null(command[count]);
        assert_string_equal(command[count], expected[count]);
    }
    assert_null(command[count]);
    pool_options_free_command(command);
}

static void a_pool_of_ssh(void **state)
{
    static const char *const expected[] = {"ssh",
                                           "-T",
                                           "-o",
                                           "BatchMode=yes",
                                           "-o",
                                           "ConnectTimeout=20",
                                           "-F",
                                           "/etc/marchd/ssh/config",
                                           "--",
                                           "ben",
                                           "/opt/marchd/march-worker",
                                           "--node",
                                           NULL};
    struct pool_options pool;

    assert_true(pool_options_read(
        &pool,
        "big launcher=ssh nodes=anna=4,ben workers=2  program=/opt/marchd/march-worker "
        "heartbeat=7.5 landlock=optional ssh-config=/etc/marchd/ssh/config threads=3 worker-memory=4G backend=egl",
        NULL));
    assert_string_equal(pool.name, "big");
    assert_int_equal(pool.node_count, 2);
    assert_string_equal(pool.nodes[0].name, "anna");
    assert_int_equal(pool.nodes[0].worker_count, 4);
    assert_int_equal(pool.nodes[1].worker_count, 2);
    assert_int_equal(pool_options_worker_count(&pool), 6);
    assert_int_equal(pool.heartbeat_ms, 7500);
    assert_false(pool.wants_landlock);
    assert_int_equal(pool.thread_count, 3);
    assert_true(pool.memory_bytes == INT64_C(4) << 30);
    assert_string_equal(pool.backend, "egl");
    assert_command(&pool, "ben", expected);
    pool_options_finish(&pool);
}

static void a_pool_of_a_command(void **state)
{
    static const char *const expected[] = {"/usr/bin/run on", "--host=x7:1", "a  b", "--node", NULL};
    struct pool_options pool;

    assert_true(
        pool_options_read(&pool, "p nodes='x7 y'  command=\"'/usr/bin/run on' --host={node}:1 'a  b' --node\"", NULL));
    assert_int_equal(pool.launcher, POOL_COMMAND);
    assert_int_equal(pool.node_count, 2);
    assert_int_equal(pool_options_worker_count(&pool), 2);
    assert_int_equal(pool.heartbeat_ms, 30000);
    assert_true(pool.wants_landlock);
    assert_command(&pool, "x7", expected);
    pool_options_finish(&pool);
}

static void a_pool_of_slurm(void **state)
{
    static const char *const expected[] = {
        "srun",       "--jobid=77", "--exact",           "--quiet",           "--mpi=none", "--nodes=1",
        "--ntasks=1", "--chdir=/",  "--cpus-per-task=6", "/opt/march-worker", "--node",     NULL};
    struct pool_options pool;

    assert_true(pool_options_read(&pool,
                                  "big launcher=slurm workers=3 threads=2 program=/opt/march-worker partition=gpu "
                                  "account=film gres=gpu:3 time=2:00:00 min=1 max=20 idle=90 keep=30 lease=/fast/lease "
                                  "arguments='--qos=low --comment=\"a b\"'",
                                  NULL));
    assert_int_equal(pool.launcher, POOL_SLURM);
    assert_int_equal(pool.node_count, 20);
    assert_string_equal(pool.nodes[19].name, "big.20");
    assert_int_equal(pool_options_worker_count(&pool), 60);
    assert_string_equal(pool.slurm.partition, "gpu");
    assert_string_equal(pool.slurm.account, "film");
    assert_string_equal(pool.slurm.gres, "gpu:3");
    assert_string_equal(pool.slurm.time, "2:00:00");
    assert_int_equal(pool.slurm.min, 1);
    assert_int_equal(pool.slurm.max, 20);
    assert_int_equal(pool.slurm.idle_ms, 90000);
    assert_int_equal(pool.slurm.keep_ms, 30000);
    assert_string_equal(pool.slurm.lease_folder, "/fast/lease");
    assert_int_equal(pool.slurm.arguments.count, 2);
    assert_string_equal(pool.slurm.arguments.words[1], "--comment=a b");
    assert_command(&pool, "77", expected);
    pool_options_finish(&pool);

    assert_true(pool_options_read(&pool, "p launcher=slurm", NULL));
    assert_int_equal(pool.node_count, 1);
    assert_int_equal(pool.slurm.cpu_count, 1);
    assert_null(pool.slurm.partition);
    pool_options_finish(&pool);
}

static void faults_name_their_place(void **state)
{
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"", "--pool: expected the pool's name"},
        {"a[b] nodes=a command=x", "--pool: expected the pool's name"},
        {"p nodes=a command=x tags=a;b", "--pool: p: tags: expected letters, digits and -._@:, got \"a;b\""},
        {"p nodes=a command=x users=", "--pool: p: users: expected NAME,NAME,..., got nothing"},
        {"p nodes=a command=x users=anna,@", "--pool: p: users: expected names of users, and of groups after @"},
        {"p", "--pool: p: expected nodes="},
        {"p nodes=a", "--pool: p: expected command="},
        {"p nodes=a launcher=ssh command=x", "--pool: p: command: expected with launcher=command only"},
        {"p nodes=a command=''", "--pool: p: command: expected a program"},
        {"p nodes=a,b,a command=x", "--pool: p: nodes: a stands there twice"},
        {"p nodes=-oProxyCommand=x launcher=ssh",
         "--pool: p: nodes: expected a machine's name, got \"-oProxyCommand\""},
        {"p nodes=a;b launcher=ssh", "--pool: p: nodes: expected a machine's name, got \"a;b\""},
        {"p nodes=a=0 launcher=ssh", "nodes: expected a whole number from 1 to 1024"},
        {"p nodes=a launcher=ssh ssh-config=x", "--pool: p: ssh-config: expected an absolute path, got \"x\""},
        {"p nodes=a command=x ssh-config=/x", "--pool: p: ssh-config: expected with launcher=ssh only"},
        {"p nodes=a launcher=ssh program='x;y'", "--pool: p: program: expected a path of letters"},
        {"p launcher=slurm nodes=a", "--pool: p: nodes: expected max=COUNT"},
        {"p launcher=slurm max=2 min=3", "--pool: p: min: expected at most max, which is 2"},
        {"p launcher=slurm command=x", "--pool: p: command: expected with launcher=command only"},
        {"p launcher=slurm keep=5", "keep: expected seconds from 10"},
        {"p launcher=slurm lease=x", "lease: expected an absolute path, got \"x\""},
        {"p launcher=slurm gres='a b'", "gres: expected printable characters without blanks"},
        {"p nodes=a launcher=ssh partition=x", "--pool: p: partition: expected with launcher=slurm only"},
        {"p nodes=a launcher=ssh heartbeat=0.1", "heartbeat: expected seconds from 1"},
        {"p nodes=a launcher=ssh landlock=yes", "landlock: expected required or optional, got \"yes\""},
        {"p nodes=a launcher=ssh colour=red", "--pool: p: colour: expected launcher, nodes"},
        {"p nodes=a launcher=ssh red", "--pool: p: expected KEY=VALUE, got \"red\""},
        {"p nodes=a command=\"x", "--pool: expected another \" at the end"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct pool_options pool;
        struct error error = {0};

        assert_false(pool_options_read(&pool, cases[i].text, &error));
        if (!strstr(error.message, cases[i].expected)) fail_msg("%s: %s", cases[i].text, error.message);
    }
}

static void a_table_holds_pools_of_different_names(void **state)
{
    struct pool_table table = {0}, other = {0};
    struct error error = {0};

    assert_true(pool_table_add(&table, "p nodes=a command=x", NULL));
    assert_true(pool_table_add(&table, "q nodes=a command=x", NULL));
    assert_false(pool_table_add(&table, "p nodes=b command=x", &error));
    assert_string_equal(error.message, "--pool: there is a pool p already");
    assert_int_equal(table.count, 2);
    assert_true(pool_table_add(&other, "p nodes=a command=x", NULL));
    assert_false(pool_table_is_same(&table, &other));
    assert_true(pool_table_add(&other, "q nodes=a command=x", NULL));
    assert_true(pool_table_is_same(&table, &other));
    pool_table_finish(&table);
    pool_table_finish(&other);
}

static void tags_and_users_are_the_terms_of_a_pool(void **state)
{
    const gid_t root_group = 0, other_group = 4711;
    struct pool_options pool;
    char *users;

    assert_true(
        pool_options_read(&pool, "p nodes=a command=x tags=gpu,big users=anna,1007,@root,@no-such-group", NULL));
    assert_true(pool_terms_have_tag(&pool.terms, "gpu"));
    assert_true(pool_terms_have_tag(&pool.terms, "big"));
    assert_false(pool_terms_have_tag(&pool.terms, "p"));
    assert_true(pool_terms_let(&pool.terms, 1001, "anna", NULL, 0));
    assert_true(pool_terms_let(&pool.terms, 1007, "carl", NULL, 0));
    assert_true(pool_terms_let(&pool.terms, 1001, "ben", &root_group, 1));
    assert_false(pool_terms_let(&pool.terms, 1001, "ben", &other_group, 1));
    assert_false(pool_terms_let(&pool.terms, 1001, "root", NULL, 0));
    users = pool_terms_format_users(&pool.terms);
    assert_string_equal(users, "anna, 1007, @root, @no-such-group");
    free(users);
    pool_options_finish(&pool);
}

static void terms_change_without_the_rest(void **state)
{
    struct pool_table table = {0}, other = {0};

    assert_true(pool_table_add(&table, "p nodes=a tags=x command=x", NULL));
    assert_true(pool_table_add(&other, "p nodes=a command=x users=anna", NULL));
    assert_true(pool_table_add(&other, "local tags=cpu users=ben", NULL));
    assert_true(pool_table_is_same(&table, &other));
    assert_true(pool_table_swap_terms(&table, &other));
    assert_false(pool_terms_have_tag(&table.pools[0].terms, "x"));
    assert_false(pool_terms_let(&table.pools[0].terms, 1, "ben", NULL, 0));
    assert_true(pool_terms_have_tag(&table.local, "cpu"));
    assert_true(pool_terms_let(&other.local, 1, "anna", NULL, 0));
    pool_table_finish(&other);
    assert_true(pool_table_add(&other, "p nodes=a command=x users=anna", NULL));
    assert_true(pool_table_add(&other, "local tags=cpu users=ben", NULL));
    assert_false(pool_table_swap_terms(&table, &other));
    pool_table_finish(&table);
    pool_table_finish(&other);
}

static void the_pool_of_this_machine_has_terms_alone(void **state)
{
    struct pool_table table = {0};
    struct error error = {0};

    assert_false(pool_table_add(&table, "local nodes=a command=x", &error));
    assert_string_equal(error.message, "--pool: local: expected tags=... or users=..., got \"nodes=a\"");
    assert_false(pool_table_add(&table, "local tags=a;b", &error));
    assert_string_equal(error.message, "--pool: local: tags: expected letters, digits and -._@:, got \"a;b\"");
    pool_table_finish(&table);
}

static void all_pools_together_have_a_limit(void **state)
{
    struct pool_table table = {0};
    struct error error = {0};

    (void)state;
    assert_true(pool_table_add(&table, "p launcher=slurm max=58 workers=1024", NULL));
    assert_false(pool_table_add(&table, "q launcher=slurm max=1 workers=609", &error));
    assert_string_equal(error.message, "--pool: expected at most 60000 workers of all pools, got 60001");
    assert_true(pool_table_add(&table, "q launcher=slurm max=1 workers=608", NULL));
    pool_table_finish(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pool_of_ssh),
        cmocka_unit_test(a_pool_of_a_command),
        cmocka_unit_test(a_pool_of_slurm),
        cmocka_unit_test(faults_name_their_place),
        cmocka_unit_test(a_table_holds_pools_of_different_names),
        cmocka_unit_test(all_pools_together_have_a_limit),
        cmocka_unit_test(tags_and_users_are_the_terms_of_a_pool),
        cmocka_unit_test(terms_change_without_the_rest),
        cmocka_unit_test(the_pool_of_this_machine_has_terms_alone),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
