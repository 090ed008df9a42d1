// The real daemon with workers that render nothing.
// SPDX-License-Identifier: Apache-2.0
// Measures frames per second, the time until a submitted job is durable, the memory of a million queued frames, the
// farm's overhead beside rendering, and, also with the real worker, short jobs per second.
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "core/wire/message_stream.h"

#include <inttypes.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum {
    SUBMITS = 100,
    JOBS = 100,
    MANY_JOBS = 1000,
    SLEEP_MS = 100,
    SLEEP_FRAMES = 240,
    WORKERS = 2,
    SKIPPED = 200 * 1000
};

struct bench {
    char programs[PATH_MAX]; // folder of marchd and stub-worker
    char scratch[64];
    char socket_path[108];
    char worker[128]; // script that starts the stub in one of its modes
    pid_t daemon;
    int fd;
    struct message_stream stream;
    struct json_writer request;
    int outputs; // counted, so that no two jobs write the same files
};

static void give_up(const char *what)
{
    fprintf(stderr, "farm_bench: %s\n", what);
    exit(1);
}

static void sleep_ms(long ms)
{
    nanosleep(&(struct timespec){.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000}, NULL);
}

// `mode` NULL: the real worker.
static void write_worker(struct bench *bench, const char *mode)
{
    char *text = mode ? xasprintf("#!/bin/sh\nexec '%s/stub-worker' --mode %s \"$@\"\n", bench->programs, mode)
                      : xasprintf("#!/bin/sh\nexec '%s/march-worker' \"$@\"\n", bench->programs);

    snprintf(bench->worker, sizeof bench->worker, "%s/worker", bench->scratch);
    if (!file_write_atomic(bench->worker, text, strlen(text), NULL) || chmod(bench->worker, 0755) != 0)
        give_up("cannot write the worker script");
    free(text);
}

static bool try_connect(struct bench *bench)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};

    memcpy(address.sun_path, bench->socket_path, sizeof address.sun_path);
    bench->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (connect(bench->fd, (struct sockaddr *)&address, sizeof address) == 0) return true;
    close(bench->fd);
    return false;
}

static void start_daemon(struct bench *bench)
{
    char *program = xasprintf("%s/marchd", bench->programs);
    char *state = xasprintf("%s/state", bench->scratch);
    char *out = xasprintf("%s/out", bench->scratch);
    double start_s = clock_now_s();

    bench->daemon = fork();
    if (bench->daemon == 0) {
        execl(program, program, "--state", state, "--socket", bench->socket_path, "--output-root", out, "--workers",
              "2", "--worker-program", bench->worker, "--log-level", "error", (char *)NULL);
        _exit(127);
    }
    while (!try_connect(bench)) {
        if (clock_now_s() - start_s > 60) give_up("the daemon does not listen");
        sleep_ms(1);
    }
    free(program);
    free(state);
    free(out);
}

static void stop_daemon(struct bench *bench)
{
    close(bench->fd);
    message_stream_finish(&bench->stream);
    kill(bench->daemon, SIGTERM);
    waitpid(bench->daemon, NULL, 0);
}

// Sends `bench->request` and reads the answer.
static void call(struct bench *bench, struct message *answer)
{
    const char *line;
    size_t length, room;
    enum message_code code;
    struct error error = {0};

    if (!file_write_all(bench->fd, bench->request.text, bench->request.length, &error)) give_up(error.message);
    json_writer_clear(&bench->request);
    while (!(line = message_stream_next(&bench->stream, &length, &error))) {
        char *bytes = message_stream_reserve(&bench->stream, &room);
        ssize_t count = read(bench->fd, bytes, room);

        if (count <= 0) give_up("the daemon hung up");
        message_stream_commit(&bench->stream, (size_t)count);
    }
    if (!message_decode(answer, line, length, &code, &error)) give_up(error.message);
    if (answer->kind == MESSAGE_ERROR) give_up(answer->text);
}

static const char document_format[] =
    "{\"version\":1,\"name\":\"bench\",\"frames\":\"%s\",\"fps\":24,\"resolution\":[32,18],"
    "\"camera\":{\"position\":[0,0,-2],\"target\":[0,0,0],\"fov\":53},"
    "\"lights\":[{\"kind\":\"sun\",\"direction\":[0,-1,0],\"intensity\":1}],"
    "\"scene\":{\"media\":[{\"density\":{\"kind\":\"fold_fractal\",\"iterations\":8,\"offset\":0.06,\"radius\":0.15,"
    "\"exponent\":1.3,\"scale\":10},\"sigma_s\":64}]},"
    "\"quality\":{\"method\":\"midpoint\",\"step\":0.01,\"light_step\":0.02},"
    "\"output\":{\"path\":\"bench/%d.####.exr\"}}";

static int64_t submit(struct bench *bench, const char *range, bool paused)
{
    char *document = xasprintf(document_format, range, bench->outputs++);
    struct message answer = {0};
    struct json_node id;
    int64_t job = 0;

    message_begin_request(&bench->request, 1, "job.submit");
    json_write_begin_object(&bench->request);
    json_write_key(&bench->request, "document");
    json_write_raw(&bench->request, document, strlen(document));
    json_write_bool_member(&bench->request, "paused", paused);
    json_write_end_object(&bench->request);
    message_end(&bench->request);
    call(bench, &answer);
    id = json_node_child(&answer.body, "id");
    json_read_integer(&id, 1, INT64_MAX, &job, NULL);
    message_finish(&answer);
    free(document);
    return job;
}

static bool has_succeeded(struct bench *bench, int64_t job)
{
    struct message answer = {0};
    struct json_node state;
    const char *text = "";
    bool succeeded;

    message_begin_request(&bench->request, 1, "job.show");
    json_write_begin_object(&bench->request);
    json_write_integer_member(&bench->request, "id", job);
    json_write_end_object(&bench->request);
    message_end(&bench->request);
    call(bench, &answer);
    state = json_node_child(&answer.body, "state");
    json_read_string(&state, &text, NULL);
    succeeded = strcmp(text, "succeeded") == 0;
    message_finish(&answer);
    return succeeded;
}

static void wait_for(struct bench *bench, int64_t job)
{
    while (!has_succeeded(bench, job))
        sleep_ms(5);
}

static double run_job(struct bench *bench, const char *range)
{
    double start_s = clock_now_s();

    wait_for(bench, submit(bench, range, false));
    return clock_now_s() - start_s;
}

// Has all frames of the job looked for again, which are there.
static double run_again(struct bench *bench, int64_t job)
{
    struct message answer = {0};
    double start_s = clock_now_s();

    message_begin_request(&bench->request, 1, "job.retry");
    json_write_begin_object(&bench->request);
    json_write_integer_member(&bench->request, "id", job);
    json_write_string_member(&bench->request, "state", "skipped");
    json_write_end_object(&bench->request);
    message_end(&bench->request);
    call(bench, &answer);
    message_finish(&answer);
    wait_for(bench, job);
    return clock_now_s() - start_s;
}

// Of all threads, s.
static double processor_s(pid_t pid)
{
    char *path = xasprintf("/proc/%d/stat", (int)pid);
    FILE *file = fopen(path, "r");
    long user = 0, system = 0;

    if (!file || fscanf(file, "%*d (%*[^)]) %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %ld %ld", &user, &system) != 2)
        give_up("cannot read the daemon's processor time");
    fclose(file);
    free(path);
    return (double)(user + system) / (double)sysconf(_SC_CLK_TCK);
}

static double memory_mib(pid_t pid)
{
    char *path = xasprintf("/proc/%d/status", (int)pid);
    FILE *file = fopen(path, "r");
    char line[256];
    double kib = 0;

    while (file && fgets(line, sizeof line, file)) {
        if (strncmp(line, "VmRSS:", 6) == 0) kib = strtod(line + 6, NULL);
    }
    if (file) fclose(file);
    free(path);
    return kib / 1024;
}

static int compare_numbers(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return (left > right) - (left < right);
}

static void print_row(const char *what, double value, const char *unit, const char *target)
{
    printf("%-58s %12.4g %-9s %s\n", what, value, unit, target);
    fflush(stdout);
}

// Each frame is a file: the stub writes and syncs it; the daemon does intent, rename, folder sync and result.
static void measure_publishing(struct bench *bench)
{
    stop_daemon(bench);
    write_worker(bench, "write");
    start_daemon(bench);
    run_job(bench, "1-100"); // both workers are ready
    print_row("frames written, synced and published, of 5,000", 5000 / run_job(bench, "1-5000"), "frames/s", "");
}

static void measure_skips(struct bench *bench)
{
    int64_t job = submit(bench, "1-200000", false);
    double used_s, wall_s;

    wait_for(bench, job);
    used_s = processor_s(bench->daemon);
    wall_s = run_again(bench, job);
    print_row("frames that are there, looked at, of 200,000", SKIPPED / wall_s, "frames/s", ">= 20000");
    print_row("processor time of the daemon for each", (processor_s(bench->daemon) - used_s) / SKIPPED * 1e6, "us", "");
}

static void measure_submits(struct bench *bench)
{
    double seconds[SUBMITS];

    for (int i = 0; i < SUBMITS; i++) {
        double start_s = clock_now_s();

        submit(bench, "1-100", true);
        seconds[i] = clock_now_s() - start_s;
    }
    qsort(seconds, SUBMITS, sizeof seconds[0], compare_numbers);
    print_row("submit to acknowledged, median of 100", seconds[SUBMITS / 2] * 1e3, "ms", "<= 10");
    print_row("submit to acknowledged, 95th of 100", seconds[95] * 1e3, "ms", "");
}

static void measure_restart(struct bench *bench, const char *what)
{
    struct message answer = {0};
    double start_s;
    char *name = xasprintf("restart with %s", what);

    stop_daemon(bench);
    start_s = clock_now_s();
    start_daemon(bench);
    message_begin_request(&bench->request, 1, "daemon.status");
    json_write_begin_object(&bench->request);
    json_write_end_object(&bench->request);
    message_end(&bench->request);
    call(bench, &answer);
    message_finish(&answer);
    print_row(name, clock_now_s() - start_s, "s", "<= 2");
    free(name);
    name = xasprintf("memory after it, %s", what);
    print_row(name, memory_mib(bench->daemon), "MiB", "<= 200");
    free(name);
}

static void measure_million(struct bench *bench)
{
    submit(bench, "0-999999", true);
    print_row("memory with 1,000,000 queued frames in one job", memory_mib(bench->daemon), "MiB", "<= 200");
    measure_restart(bench, "1,000,000 queued frames in one job");
    for (int i = 0; i < MANY_JOBS; i++)
        submit(bench, "0-999", true);
    print_row("memory with 1,000,000 more in 1,000 jobs", memory_mib(bench->daemon), "MiB", "");
    measure_restart(bench, "2,000,000 in 1,001 jobs");
}

static void measure_overhead(struct bench *bench)
{
    double ideal_s = (double)SLEEP_FRAMES * SLEEP_MS / 1000 / WORKERS;
    double wall_s;

    stop_daemon(bench);
    write_worker(bench, "sleep:100");
    start_daemon(bench);
    run_job(bench, "1-2"); // both workers are ready
    wall_s = run_job(bench, "1-240");
    print_row("240 frames of 100 ms on 2 workers", wall_s, "s", "");
    print_row("what the farm adds", (wall_s / ideal_s - 1) * 100, "%", "<= 1");
}

// Jobs of one user that are all in the queue, each with frames of that range.
static double run_jobs(struct bench *bench, int count, const char *range)
{
    int64_t *ids = xcalloc((size_t)count, sizeof ids[0]);
    double start_s = clock_now_s();

    for (int i = 0; i < count; i++)
        ids[i] = submit(bench, range, false);
    for (int i = 0; i < count; i++)
        while (!has_succeeded(bench, ids[i]))
            sleep_ms(1);
    free(ids);
    return clock_now_s() - start_s;
}

static void measure_jobs(struct bench *bench)
{
    stop_daemon(bench);
    write_worker(bench, "skip");
    start_daemon(bench);
    run_jobs(bench, 2, "1-100"); // both workers are ready
    print_row("jobs of 100 frames, of 100, fenced stubs", JOBS / run_jobs(bench, JOBS, "1-100"), "jobs/s", ">= 100");
    stop_daemon(bench);
    write_worker(bench, NULL);
    start_daemon(bench);
    print_row("jobs of a frame rendered, of 100, fenced, cold", JOBS / run_jobs(bench, JOBS, "1"), "jobs/s", ">= 60");
    print_row("jobs of a frame rendered, of 100, fenced", JOBS / run_jobs(bench, JOBS, "1"), "jobs/s", ">= 60");
}

int main(void)
{
    struct bench bench = {.scratch = "/tmp/marchd_bench_XXXXXX"};
    ssize_t length = readlink("/proc/self/exe", bench.programs, sizeof bench.programs - 1);
    char *remove;

    if (length <= 0 || !mkdtemp(bench.scratch)) give_up("cannot make a scratch folder");
    *strrchr(bench.programs, '/') = '\0';
    snprintf(bench.socket_path, sizeof bench.socket_path, "%s/sock", bench.scratch);
    signal(SIGPIPE, SIG_IGN);
    write_worker(&bench, "skip");
    start_daemon(&bench);
    run_job(&bench, "1-1000");
    measure_skips(&bench);
    measure_submits(&bench);
    measure_million(&bench);
    measure_overhead(&bench);
    measure_publishing(&bench);
    measure_jobs(&bench);
    stop_daemon(&bench);
    json_writer_finish(&bench.request);
    remove = xasprintf("rm -rf '%s'", bench.scratch);
    if (system(remove) != 0) give_up("cannot remove the scratch folder");
    free(remove);
    return 0;
}
