// The real daemon with hundreds of workers that render nothing, here and on nodes.
// SPDX-License-Identifier: Apache-2.0
// Measures, for each of several fleets: frames per second, the processor time, memory and descriptors that they take,
// and what the daemon does while nothing is to be done.
#include "bench/private_farm.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/json/json_read.h"
#include "core/wire/message.h"

#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 200 * 1000, TIMED_FRAMES = 50 * 1000, IDLE_MS = 5000 };

struct fleet {
    const char *name;
    int worker_count, node_count; // no node: workers of this machine
    const char *program;          // that the launcher starts; NULL: march-worker --node with its processes
    int frame_ms;                 // that a frame takes there; 0: its file is there, and it is answered at once
};

static const struct fleet fleets[] = {
    {"200 workers here", 200, 0, NULL, 0},
    {"200 workers on 25 nodes", 200, 25, NULL, 0},
    {"200 simulated workers on 25 nodes", 200, 25, "stub-node", 0},
    {"1,000 simulated workers on 40 nodes", 1000, 40, "stub-node", 0},
    {"1,000 simulated workers on 40 nodes, frames of 200 ms", 1000, 40, "stub-node", 200}};

// Processor seconds of the daemon, of its children, and of theirs.
struct use {
    double daemon_s, children_s, grandchildren_s;
};

static pid_t parent_of(pid_t pid)
{
    char *path = xasprintf("/proc/%d/stat", (int)pid);
    FILE *file = fopen(path, "r");
    int parent = 0;

    if (file && fscanf(file, "%*d (%*[^)]) %*c %d", &parent) != 1) parent = 0;
    if (file) fclose(file);
    free(path);
    return parent;
}

static struct use read_use(const struct private_farm *farm)
{
    struct use use = {.daemon_s = private_farm_processor_s(farm->daemon)};
    DIR *folder = opendir("/proc");
    const struct dirent *entry;

    while (folder && (entry = readdir(folder))) {
        pid_t pid = isdigit((unsigned char)entry->d_name[0]) ? atoi(entry->d_name) : 0;
        pid_t parent = pid ? parent_of(pid) : 0;

        if (parent == farm->daemon)
            use.children_s += private_farm_processor_s(pid);
        else if (parent > 1 && parent_of(parent) == farm->daemon)
            use.grandchildren_s += private_farm_processor_s(pid);
    }
    if (folder) closedir(folder);
    return use;
}

static int count_descriptors(pid_t pid)
{
    char *path = xasprintf("/proc/%d/fd", (int)pid);
    DIR *folder = opendir(path);
    int count = -2; // "." and ".."

    while (folder && readdir(folder))
        count++;
    if (folder) closedir(folder);
    free(path);
    return count;
}

static char *format_pool(const struct private_farm *farm, const struct fleet *fleet)
{
    char *pool =
        fleet->program
            ? xasprintf("far launcher=command command=\"%s/%s %d\" nodes=", farm->programs, fleet->program,
                        fleet->frame_ms)
            : xasprintf("far launcher=command command=\"%s/march-worker --node --worker %s\" nodes=", farm->programs,
                        farm->worker);

    for (int i = 0; i < fleet->node_count; i++) {
        char *longer = xasprintf("%s%sn%d=%d", pool, i ? "," : "", i, fleet->worker_count / fleet->node_count);

        free(pool);
        pool = longer;
    }
    return pool;
}

static void start(struct private_farm *farm, const struct fleet *fleet)
{
    char *count = xasprintf("%d", fleet->worker_count);
    char *pool = format_pool(farm, fleet);

    if (fleet->node_count)
        private_farm_start(farm, (const char *const[]){"--workers", "none", "--pool", pool, NULL});
    else
        private_farm_start(farm, (const char *const[]){"--workers", count, "--worker-program", farm->worker, NULL});
    free(count);
    free(pool);
}

// How many of the workers are idle; `*size` are the bytes of the answer.
static int count_idle(struct private_farm *farm, size_t *size)
{
    struct message answer = {0};
    struct json_node workers, worker = {0};
    int count = 0;

    *size = private_farm_ask(farm, "worker.list", "{}", &answer);
    workers = json_node_child(&answer.body, "workers");
    while (json_node_next(&workers, &worker)) {
        struct json_node state = json_node_child(&worker, "state");
        const char *text = "";

        (void)json_read_string(&state, &text, NULL);
        count += strcmp(text, "idle") == 0;
    }
    message_finish(&answer);
    return count;
}

static double longest_turn_ms(struct private_farm *farm)
{
    struct message answer = {0};
    struct json_node loop, longest;
    double ms = 0;

    private_farm_ask(farm, "daemon.status", "{}", &answer);
    loop = json_node_child(&answer.body, "loop");
    longest = json_node_child(&loop, "longest_ms");
    (void)json_read_number(&longest, 0, 1e9, &ms, NULL);
    message_finish(&answer);
    return ms;
}

// Frames that take their time: whether the daemon keeps all workers at work.
static void measure_timed(struct private_farm *farm, const struct fleet *fleet)
{
    double used_s = private_farm_processor_s(farm->daemon), wall_s = private_farm_run_job(farm, "1-50000");
    double ideal_s = (double)TIMED_FRAMES * fleet->frame_ms / 1000 / fleet->worker_count;

    private_farm_print_row("frames, of 50,000", TIMED_FRAMES / wall_s, "frames/s", "");
    private_farm_print_row("what the farm adds", (wall_s / ideal_s - 1) * 100, "%", "");
    private_farm_print_row("processor time of the daemon for each",
                           (private_farm_processor_s(farm->daemon) - used_s) / TIMED_FRAMES * 1e6, "us", "");
}

static void measure_found(struct private_farm *farm, const struct fleet *fleet)
{
    struct use before, after;
    double wall_s;
    int64_t job;

    job = private_farm_submit(farm, "1-200000", false);
    private_farm_wait(farm, job);
    before = read_use(farm);
    wall_s = private_farm_run_again(farm, job);
    after = read_use(farm);
    private_farm_print_row("frames that are there, looked at, of 200,000", FRAMES / wall_s, "frames/s", ">= 20000");
    private_farm_print_row("processor time of the daemon for each", (after.daemon_s - before.daemon_s) / FRAMES * 1e6,
                           "us", "");
    private_farm_print_row(fleet->node_count ? "of the nodes" : "of the workers",
                           (after.children_s - before.children_s) / FRAMES * 1e6, "us", "");
    if (fleet->node_count && !fleet->program)
        private_farm_print_row("of the workers", (after.grandchildren_s - before.grandchildren_s) / FRAMES * 1e6, "us",
                               "");
}

static void measure(struct private_farm *farm, const struct fleet *fleet)
{
    double start_s = clock_now_s(), idle_s;
    size_t size;

    printf("-- %s\n", fleet->name);
    start(farm, fleet);
    while (count_idle(farm, &size) < fleet->worker_count)
        private_farm_sleep_ms(50);
    private_farm_print_row("until all are idle", clock_now_s() - start_s, "s", "");
    private_farm_print_row("longest turn of the daemon's loop until then", longest_turn_ms(farm), "ms", "<= 50");
    private_farm_print_row("worker.list", (double)size / 1024, "KiB", "");
    private_farm_print_row("memory of the daemon", private_farm_memory_mib(farm->daemon), "MiB", "");
    private_farm_print_row("its descriptors", count_descriptors(farm->daemon), "", "");
    idle_s = private_farm_processor_s(farm->daemon);
    private_farm_sleep_ms(IDLE_MS);
    private_farm_print_row("its processor time while idle",
                           (private_farm_processor_s(farm->daemon) - idle_s) / IDLE_MS * 1e6, "ms/s", "");
    if (fleet->frame_ms)
        measure_timed(farm, fleet);
    else
        measure_found(farm, fleet);
    private_farm_print_row("memory of the daemon then", private_farm_memory_mib(farm->daemon), "MiB", "");
    private_farm_print_row("longest turn of its loop since its start", longest_turn_ms(farm), "ms", "<= 50");
    private_farm_stop(farm);
}

// Without arguments all fleets; with numbers, those.
int main(int argc, char **argv)
{
    struct private_farm farm;

    private_farm_init(&farm);
    private_farm_use_memory(&farm); // a disk's time for new files is no part of it
    private_farm_write_worker(&farm, "skip");
    for (int i = 0; i < (int)(sizeof fleets / sizeof fleets[0]); i++) {
        bool is_asked = argc == 1;

        for (int k = 1; k < argc; k++)
            is_asked = is_asked || atoi(argv[k]) == i + 1;
        if (is_asked) measure(&farm, &fleets[i]);
    }
    private_farm_finish(&farm);
    return 0;
}
