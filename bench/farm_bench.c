// The real daemon with workers that render nothing.
// SPDX-License-Identifier: Apache-2.0
// Measures frames per second, the time until a submitted job is durable, the memory of a million queued frames, the
// farm's overhead beside rendering, and, also with the real worker, short jobs per second.
#include "bench/private_farm.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/wire/message.h"

#include <stdlib.h>

enum {
    SUBMITS = 100,
    JOBS = 100,
    MANY_JOBS = 1000,
    SLEEP_MS = 100,
    SLEEP_FRAMES = 240,
    WORKERS = 2,
    SKIPPED = 200 * 1000
};

static int compare_numbers(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return (left > right) - (left < right);
}

static void start_daemon(struct private_farm *farm)
{
    private_farm_start(farm, (const char *const[]){"--workers", "2", "--worker-program", farm->worker, NULL});
}

// Each frame is a file: the stub writes and syncs it; the daemon does intent, rename, folder sync and result.
static void measure_publishing(struct private_farm *farm)
{
    private_farm_stop(farm);
    private_farm_write_worker(farm, "write");
    start_daemon(farm);
    private_farm_run_job(farm, "1-100"); // both workers are ready
    private_farm_print_row("frames written, synced and published, of 5,000",
                           5000 / private_farm_run_job(farm, "1-5000"), "frames/s", "");
}

static void measure_skips(struct private_farm *farm)
{
    int64_t job = private_farm_submit(farm, "1-200000", false);
    double used_s, wall_s;

    private_farm_wait(farm, job);
    used_s = private_farm_processor_s(farm->daemon);
    wall_s = private_farm_run_again(farm, job);
    private_farm_print_row("frames that are there, looked at, of 200,000", SKIPPED / wall_s, "frames/s", ">= 20000");
    private_farm_print_row("processor time of the daemon for each",
                           (private_farm_processor_s(farm->daemon) - used_s) / SKIPPED * 1e6, "us", "");
}

static void measure_submits(struct private_farm *farm)
{
    double seconds[SUBMITS];

    for (int i = 0; i < SUBMITS; i++) {
        double start_s = clock_now_s();

        private_farm_submit(farm, "1-100", true);
        seconds[i] = clock_now_s() - start_s;
    }
    qsort(seconds, SUBMITS, sizeof seconds[0], compare_numbers);
    private_farm_print_row("submit to acknowledged, median of 100", seconds[SUBMITS / 2] * 1e3, "ms", "<= 10");
    private_farm_print_row("submit to acknowledged, 95th of 100", seconds[95] * 1e3, "ms", "");
}

static void measure_restart(struct private_farm *farm, const char *what)
{
    struct message answer = {0};
    double start_s;
    char *name = xasprintf("restart with %s", what);

    private_farm_stop(farm);
    start_s = clock_now_s();
    start_daemon(farm);
    private_farm_ask(farm, "daemon.status", "{}", &answer);
    message_finish(&answer);
    private_farm_print_row(name, clock_now_s() - start_s, "s", "<= 2");
    free(name);
    name = xasprintf("memory after it, %s", what);
    private_farm_print_row(name, private_farm_memory_mib(farm->daemon), "MiB", "<= 200");
    free(name);
}

static void measure_million(struct private_farm *farm)
{
    private_farm_submit(farm, "0-999999", true);
    private_farm_print_row("memory with 1,000,000 queued frames in one job", private_farm_memory_mib(farm->daemon),
                           "MiB", "<= 200");
    measure_restart(farm, "1,000,000 queued frames in one job");
    for (int i = 0; i < MANY_JOBS; i++)
        private_farm_submit(farm, "0-999", true);
    private_farm_print_row("memory with 1,000,000 more in 1,000 jobs", private_farm_memory_mib(farm->daemon), "MiB",
                           "");
    measure_restart(farm, "2,000,000 in 1,001 jobs");
}

static void measure_overhead(struct private_farm *farm)
{
    double ideal_s = (double)SLEEP_FRAMES * SLEEP_MS / 1000 / WORKERS;
    double wall_s;

    private_farm_stop(farm);
    private_farm_write_worker(farm, "sleep:100");
    start_daemon(farm);
    private_farm_run_job(farm, "1-2"); // both workers are ready
    wall_s = private_farm_run_job(farm, "1-240");
    private_farm_print_row("240 frames of 100 ms on 2 workers", wall_s, "s", "");
    private_farm_print_row("what the farm adds", (wall_s / ideal_s - 1) * 100, "%", "<= 1");
}

// Jobs of one user that are all in the queue, each with frames of that range.
static double run_jobs(struct private_farm *farm, int count, const char *range)
{
    int64_t *ids = xcalloc((size_t)count, sizeof ids[0]);
    double start_s = clock_now_s();

    for (int i = 0; i < count; i++)
        ids[i] = private_farm_submit(farm, range, false);
    for (int i = 0; i < count; i++)
        private_farm_wait(farm, ids[i]);
    free(ids);
    return clock_now_s() - start_s;
}

static void measure_jobs(struct private_farm *farm)
{
    private_farm_stop(farm);
    private_farm_write_worker(farm, "skip");
    // Files that were just deleted make ext4 search long for each new one: it leaves their inodes alone for a while.
    private_farm_use_memory(farm);
    start_daemon(farm);
    run_jobs(farm, 2, "1-100"); // both workers are ready
    private_farm_print_row("jobs of 100 frames, of 100, fenced stubs, files in memory",
                           JOBS / run_jobs(farm, JOBS, "1-100"), "jobs/s", ">= 100");
    private_farm_stop(farm);
    private_farm_write_worker(farm, NULL);
    start_daemon(farm);
    private_farm_print_row("jobs of a frame rendered, of 100, fenced, cold", JOBS / run_jobs(farm, JOBS, "1"), "jobs/s",
                           ">= 60");
    private_farm_print_row("jobs of a frame rendered, of 100, fenced", JOBS / run_jobs(farm, JOBS, "1"), "jobs/s",
                           ">= 60");
}

int main(void)
{
    struct private_farm farm;

    private_farm_init(&farm);
    private_farm_write_worker(&farm, "skip");
    start_daemon(&farm);
    private_farm_run_job(&farm, "1-1000");
    measure_skips(&farm);
    measure_submits(&farm);
    measure_million(&farm);
    measure_overhead(&farm);
    measure_publishing(&farm);
    measure_jobs(&farm);
    private_farm_stop(&farm);
    private_farm_finish(&farm);
    return 0;
}
