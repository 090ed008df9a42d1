// The cost of durability: frames per second with the store committing, submit latency, restarts with a million frames.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store.h"
#include "daemon/store/store_backup.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { FRAME_COUNT = 1000 * 1000, SUBMIT_COUNT = 200, BATCH_LIMIT = 4096, MAX_ATTEMPTS = 3 };

static void check(bool ok, const struct error *error)
{
    if (ok) return;
    fprintf(stderr, "store_bench: %s\n", error->message);
    exit(1);
}

static struct store *open_store(const char *folder)
{
    struct error error = {0};
    struct store *store = store_open(folder, NULL, &error);

    check(store != NULL, &error);
    return store;
}

static void submit(struct store *store, int64_t id)
{
    static char document[1280] = "{\"frames\": \"0-999999\", \"text\": \"";
    static char name[] = "bench";
    struct store_op op = {.kind = STORE_ADD_JOB,
                          .job = {.id = id, .document = document, .name = name, .owner = name, .priority = 50}};
    struct error error = {0};
    size_t length = strlen(document);

    // As long as a usual job file.
    if (length < sizeof document - 3) memset(document + length, 'x', sizeof document - 3 - length);
    memcpy(document + sizeof document - 3, "\"}", 3);
    check(store_commit(store, &op, 1, &error), &error);
}

static int compare_doubles(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return (left > right) - (left < right);
}

static void measure_submits(const char *folder)
{
    static double latencies_ms[SUBMIT_COUNT];
    struct store *store = open_store(folder);

    for (int i = 0; i < SUBMIT_COUNT; i++) {
        double start = clock_read_s(CLOCK_MONOTONIC);

        submit(store, i + 1);
        latencies_ms[i] = (clock_read_s(CLOCK_MONOTONIC) - start) * 1e3;
    }
    qsort(latencies_ms, SUBMIT_COUNT, sizeof latencies_ms[0], compare_doubles);
    printf("%-52s %9.2f ms      <= 10 ms\n", "submit, commit of one job, median", latencies_ms[SUBMIT_COUNT / 2]);
    printf("%-52s %9.2f ms\n", "submit, 99th percentile", latencies_ms[SUBMIT_COUNT * 99 / 100]);
    store_close(store);
}

static struct store_op frame_op(int32_t index, enum frame_state state)
{
    return (struct store_op){.kind = STORE_SET_FRAME,
                             .frame = {.job = 1,
                                       .index = index,
                                       .state = (int)state,
                                       .attempts = 1,
                                       .epoch = 1,
                                       .inode = 1000000u + (unsigned)index,
                                       .size_bytes = 8294400,
                                       .hash = "00112233445566778899aabbccddeeff",
                                       .render_s = 0.25,
                                       .encode_s = 0.05}};
}

// One commit holds the results of the batch before and the intents of the next one, as the daemon makes them.
static void measure_frames(const char *folder, int batch)
{
    static struct store_op ops[2 * BATCH_LIMIT];
    struct store *store = open_store(folder);
    struct error error = {0};
    double start, cpu_start, seconds, cpu_seconds;
    char what[80];

    submit(store, 1);
    start = clock_read_s(CLOCK_MONOTONIC);
    cpu_start = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
    for (int32_t done = -batch; done < FRAME_COUNT; done += batch) {
        size_t count = 0;

        for (int32_t i = done < 0 ? 0 : done; i < done + batch && i < FRAME_COUNT; i++)
            ops[count++] = frame_op(i, FRAME_SUCCEEDED);
        for (int32_t i = done + batch; i < done + 2 * batch && i < FRAME_COUNT; i++)
            ops[count++] = frame_op(i, FRAME_RUNNING);
        check(store_commit(store, ops, count, &error), &error);
    }
    seconds = clock_read_s(CLOCK_MONOTONIC) - start;
    cpu_seconds = clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - cpu_start;
    snprintf(what, sizeof what, "intent and result of a frame, %d frames a commit", batch);
    printf("%-52s %9.0f /s      >= 50000/s (%.0f/s of CPU time)\n", what, FRAME_COUNT / seconds,
           FRAME_COUNT / cpu_seconds);
    store_close(store);
}

struct restart {
    struct queue *queue;
    struct queue_job *job;
};

static bool on_job(void *user, const struct store_job *job, struct error *error)
{
    struct restart *restart = user;
    struct frame_range range = {0};

    if (!frame_range_parse(&range, job->id == 1 ? "0-999999" : "0", error)) return false;
    restart->job = queue_add_job(
        restart->queue, &(struct queue_job_params){
                            .id = job->id, .frames = &range, .priority = job->priority, .is_paused = job->is_paused});
    return true;
}

static bool on_frame(void *user, const struct store_frame *frame, struct error *error)
{
    struct restart *restart = user;

    if (restart->job->id != frame->job) restart->job = queue_find_job(restart->queue, frame->job);
    queue_restore_frame(restart->job, frame->index, (enum frame_state)frame->state, frame->attempts);
    return true;
}

static void measure_restart(const char *folder, const char *what)
{
    struct restart restart = {.queue = queue_create(MAX_ATTEMPTS)};
    struct error error = {0};
    double start = clock_read_s(CLOCK_MONOTONIC), cpu_start = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
    struct store *store = open_store(folder);

    check(store_load(store, on_job, on_frame, &restart, &error), &error);
    printf("%-52s %9.3f s       <= 2 s (%.3f s of CPU time)\n", what, clock_read_s(CLOCK_MONOTONIC) - start,
           clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - cpu_start);
    store_close(store);
    queue_destroy(restart.queue);
}

// What the daemon does every ten minutes: the sums of all rows, and a copy.
static void measure_copy(const char *folder)
{
    char *path = xasprintf("%s/backup.db", folder);
    double start = clock_read_s(CLOCK_MONOTONIC), cpu_start = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
    struct error error = {0};
    struct stat status = {0};

    check(store_backup_save(folder, path, &error), &error);
    printf("%-52s %9.3f s       (%.3f s of CPU time)\n", "sums of 1,000,000 finished rows, and a backup",
           clock_read_s(CLOCK_MONOTONIC) - start, clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - cpu_start);
    if (stat(path, &status) == 0)
        printf("%-52s %9.0f bytes\n", "a finished frame in the queue", (double)status.st_size / FRAME_COUNT);
    free(path);
}

static void remove_store(const char *folder)
{
    static const char *const names[] = {"/queue.db", "/queue.db-wal", "/queue.db-shm", "/lock",
                                        "/reserve",  "/counts",       "/backup.db",    ""};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char *path = xasprintf("%s%s", folder, names[i]);

        remove(path);
        free(path);
    }
}

// store_bench [FOLDER]: makes the store in the folder, on the disk to be measured, and removes it.
int main(int argc, char **argv)
{
    char *folder = xasprintf("%s/store_bench_%ld", argc > 1 ? argv[1] : ".", (long)getpid());
    const int batches[] = {256, 1024, BATCH_LIMIT};

    measure_submits(folder);
    measure_restart(folder, "restart with 1,000,000 queued frames");
    for (size_t i = 0; i < sizeof batches / sizeof batches[0]; i++) {
        remove_store(folder);
        measure_frames(folder, batches[i]);
    }
    measure_restart(folder, "restart with 1,000,000 succeeded frames");
    measure_copy(folder);
    remove_store(folder);
    free(folder);
    return 0;
}
