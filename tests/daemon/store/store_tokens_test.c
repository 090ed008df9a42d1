// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_tokens.h"

#include "core/base/file.h"
#include "daemon/store/store_backup.h"
#include "daemon/store/store_reader.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sum.h"
#include "tests/daemon/store/store_fixture.h"
#include "tests/support/folders.h"

#include <inttypes.h>
#include <sqlite3.h>
#include <sys/stat.h>

static const char hash[] = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

static struct store_op token_op(int64_t id)
{
    return (struct store_op){.kind = STORE_SET_TOKEN,
                             .token = {.id = id,
                                       .hash = xstrdup(hash),
                                       .name = xasprintf("name-of-%" PRId64, id),
                                       .owner = xstrdup("ada"),
                                       .owner_uid = 1000,
                                       .scope = xstrdup("submit"),
                                       .created_ms = 1,
                                       .expires_ms = 2,
                                       .used_ms = 3,
                                       .is_once = true}};
}

static struct store_op delete_op(int64_t id)
{
    return (struct store_op){.kind = STORE_DELETE_TOKEN, .token = {.id = id}};
}

// The tokens as text, and the last id.
struct seen {
    char text[512];
    int64_t last_id;
};

static bool on_token(void *user, const struct store_token *token, struct error *error)
{
    struct seen *seen = user;
    size_t length = strlen(seen->text);

    assert_string_equal(token->hash, hash);
    snprintf(seen->text + length, sizeof seen->text - length,
             "%" PRId64 " %s %s %" PRId64 " %s %" PRId64 " %" PRId64 " %" PRId64 " %d\n", token->id, token->name,
             token->owner, token->owner_uid, token->scope, token->created_ms, token->expires_ms, token->used_ms,
             token->is_once);
    return true;
}

static struct seen read_tokens(const struct folder *folder)
{
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    struct error error = {0};
    struct seen seen = {0};

    assert_non_null(reader);
    if (!store_read_tokens(reader, on_token, &seen, &seen.last_id, &error)) fail_msg("%s", error.message);
    store_reader_close(reader);
    return seen;
}

static void change_rows(const struct folder *folder, const char *sql)
{
    sqlite3 *db = NULL;
    char path[128];

    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_true(store_sum_register(db, NULL));
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void tokens_are_kept_whole_until_they_are_deleted(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_op op = token_op(2);

    commit_one(store, token_op(1));
    op.token.used_ms = 9;
    commit_one(store, token_op(2));
    commit_one(store, op);
    store_close(store);
    store = open_store(folder);
    assert_string_equal(read_tokens(folder).text,
                        "1 name-of-1 ada 1000 submit 1 2 3 1\n2 name-of-2 ada 1000 submit 1 2 9 1\n");
    commit_one(store, delete_op(1));
    commit_one(store, delete_op(7));
    assert_string_equal(read_tokens(folder).text, "2 name-of-2 ada 1000 submit 1 2 9 1\n");
    store_close(store);
}

static void ids_of_deleted_tokens_are_known(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);

    assert_int_equal(read_tokens(folder).last_id, 0);
    commit_one(store, token_op(5));
    commit_one(store, delete_op(5));
    store_close(store);
    store_close(open_store(folder));
    assert_int_equal(read_tokens(folder).last_id, 5);
}

// A store of version 9, which had no tokens.
static void write_older(const char *path)
{
    char *sql;
    sqlite3 *db = NULL;

    assert_true(file_read_text(PROJECT_ROOT "/tests/daemon/service/stores/version_9.sql", 1 << 20, &sql, NULL, NULL));
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    free(sql);
}

static void a_store_without_tokens_is_upgraded(void **state)
{
    const struct folder *folder = *state;
    char *queue = xasprintf("%s/queue.db", folder->path);
    struct store *store;

    assert_int_equal(mkdir(folder->path, 0700), 0);
    write_older(queue);
    free(queue);
    store = open_store(folder);
    assert_true(load(store).jobs > 0);
    assert_string_equal(read_tokens(folder).text, "");
    commit_one(store, token_op(1));
    assert_string_equal(read_tokens(folder).text, "1 name-of-1 ada 1000 submit 1 2 3 1\n");
    store_close(store);
}

// What a flipped bit makes of a token is none: neither another's, nor one of another scope.
static void a_damaged_token_is_no_token(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);

    commit_one(store, token_op(1));
    commit_one(store, token_op(2));
    store_close(store);
    change_rows(folder, "UPDATE token SET owner_uid = 0 WHERE id = 1");
    assert_string_equal(read_tokens(folder).text, "2 name-of-2 ada 1000 submit 1 2 3 1\n");
    store_close(open_store(folder)); // drops it
    change_rows(folder, "UPDATE token SET sum = row_sum(" STORE_SCHEMA_TOKEN_COLUMNS ")");
    assert_string_equal(read_tokens(folder).text, "2 name-of-2 ada 1000 submit 1 2 3 1\n");
}

static void make_copy(const struct folder *folder, const char *copy)
{
    struct store *store = open_store(folder);
    struct error error = {0};

    commit_one(store, job_op(1));
    commit_one(store, token_op(1));
    store_close(store);
    if (!store_backup_save(folder->path, copy, &error)) fail_msg("%s", error.message);
}

static void a_restored_copy_has_no_tokens(void **state)
{
    const struct folder *folder = *state;
    char *copy = xasprintf("%s/copy.db", folder->root);
    struct error error = {0};
    struct store *store;

    make_copy(folder, copy);
    if (!store_backup_restore(folder->path, copy, &(bool){0}, &error)) fail_msg("%s", error.message);
    store = open_store(folder);
    assert_int_equal(load(store).jobs, 1);
    assert_string_equal(read_tokens(folder).text, "");
    store_close(store);
    free(copy);
}

static void a_backup_in_place_of_a_lost_store_has_no_tokens(void **state)
{
    const struct folder *folder = *state;
    char *copy = xasprintf("%s/" STORE_BACKUP_NAME, folder->path), *queue = xasprintf("%s/queue.db", folder->path);
    struct store *store;

    make_copy(folder, copy);
    assert_int_equal(truncate(queue, 5000), 0);
    store = open_store(folder);
    assert_int_equal(load(store).jobs, 1);
    assert_string_equal(read_tokens(folder).text, "");
    store_close(store);
    free(copy);
    free(queue);
}

static void a_copy_of_an_older_version_is_restored(void **state)
{
    const struct folder *folder = *state;
    char *copy = xasprintf("%s/copy.db", folder->root);
    struct error error = {0};
    struct store *store;

    write_older(copy);
    store = open_store(folder);
    commit_one(store, token_op(1));
    store_close(store);
    if (!store_backup_restore(folder->path, copy, &(bool){0}, &error)) fail_msg("%s", error.message);
    store = open_store(folder);
    assert_true(load(store).jobs > 0);
    assert_string_equal(read_tokens(folder).text, "");
    store_close(store);
    free(copy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(tokens_are_kept_whole_until_they_are_deleted, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(ids_of_deleted_tokens_are_known, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_store_without_tokens_is_upgraded, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_damaged_token_is_no_token, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_restored_copy_has_no_tokens, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_backup_in_place_of_a_lost_store_has_no_tokens, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_copy_of_an_older_version_is_restored, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
