// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/base/version.h"
#include "core/wire/message.h"
#include "worker/host/host.h"
#include "worker/process/encoder.h"
#include "worker/process/library_versions.h"
#include "worker/process/memory_end.h"
#include "worker/process/options.h"
#include "worker/process/orders.h"
#include "worker/process/render_loop.h"
#include "worker/process/report.h"
#include "worker/process/worker.h"
#include "worker/sandbox/fence.h"
#include "worker/sandbox/sandbox.h"

#include <errno.h>
#include <malloc.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <time.h>
#include <unistd.h>

enum {
    BEAT_MS = 1000,
    // Time that an abandoned worker gives a tile or an encoding to end before it leaves it unfinished.
    ABANDON_MS = 2000
};

// Freed voxels and pictures go back to the system with these fixed thresholds. Without them malloc soon raises its own
// and puts such blocks on heaps, where a sequence of scans leaves holes that nothing fits into.
static void keep_memory_whole(void)
{
    mallopt(M_MMAP_THRESHOLD, 4 * 1024 * 1024);
    mallopt(M_TRIM_THRESHOLD, 8 * 1024 * 1024);
}

static int64_t now_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

// A terminal sends SIGINT to the program that started the worker as well, which then sends orders. A file over the size
// limit fails like a full disk instead of ending the worker.
static int open_signals(void)
{
    sigset_t set;

    signal(SIGINT, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    // The mask is set before there are threads, so that they all inherit it.
    pthread_sigmask(SIG_BLOCK, &set, NULL);
    return signalfd(-1, &set, SFD_CLOEXEC);
}

static void take_lines(struct worker *worker)
{
    struct error error = {0};
    const char *line;
    size_t length;

    while ((line = connection_next(&worker->connection, &length, &error)))
        if (!orders_take_line(worker, line, length, &error)) break;
    if (!error.message[0]) return;
    log_error("%s", error.message);
    worker_abandon(worker, 1);
}

struct state {
    bool has_ended, is_abandoned, is_ready;
    struct report_doing doing;
};

static struct state read_state(struct worker *worker)
{
    struct state state;

    pthread_mutex_lock(&worker->lock);
    state = (struct state){worker->running_threads == 0, worker->is_abandoned, worker->is_ready, worker->doing};
    pthread_mutex_unlock(&worker->lock);
    return state;
}

// Waits for at most `timeout_ms`; handles orders, a signal and the end of the connection.
static bool wait_for_orders(struct worker *worker, int signal_fd, bool is_abandoned, int timeout_ms)
{
    struct pollfd ready[] = {{.fd = worker->wake_fd, .events = POLLIN},
                             {.fd = is_abandoned ? -1 : signal_fd, .events = POLLIN},
                             {.fd = is_abandoned ? -1 : worker->connection.fd, .events = POLLIN}};
    struct signalfd_siginfo signal;
    uint64_t count;

    if (poll(ready, 3, timeout_ms) < 0) return errno == EINTR;
    if (ready[0].revents && read(worker->wake_fd, &count, sizeof count) < 0) return false;
    if (ready[1].revents && read(signal_fd, &signal, sizeof signal) > 0) worker_exit(worker, 0);
    if (!ready[2].revents) return true;
    if (connection_receive(&worker->connection))
        take_lines(worker);
    else
        worker_abandon(worker, 0);
    return true;
}

// Reads orders and sends beats until the other threads have ended. False if an abandoned worker's threads do not end.
static bool serve(struct worker *worker, int signal_fd)
{
    int64_t next_beat_ms = now_ms(), deadline_ms = INT64_MAX;

    take_lines(worker); // what came with the fence is here already
    for (struct state state = read_state(worker); !state.has_ended; state = read_state(worker)) {
        int64_t now = now_ms();

        if (state.is_abandoned && deadline_ms == INT64_MAX) deadline_ms = now + ABANDON_MS;
        if (now >= deadline_ms) return false;
        if (now >= next_beat_ms) {
            next_beat_ms = now + BEAT_MS;
            if (state.is_ready && !state.is_abandoned) {
                report_beat(&worker->connection, atomic_load(&worker->progress));
                report_phase(&worker->connection, &state.doing);
            }
        }
        if (!wait_for_orders(worker, signal_fd, state.is_abandoned,
                             (int)((next_beat_ms < deadline_ms ? next_beat_ms : deadline_ms) - now)))
            return false;
    }
    return true;
}

static bool start_threads(struct worker *worker, pthread_t threads[2])
{
    void *(*const runs[])(void *) = {render_loop_run, encoder_run};

    worker->running_threads = 2;
    for (int i = 0; i < 2; i++) {
        int errnum = pthread_create(&threads[i], NULL, runs[i], worker);

        if (!errnum) continue;
        log_error("thread: %s", strerrordesc_np(errnum));
        return false;
    }
    return true;
}

// The first line is the fence: the files that the job may open. No other line is parsed before the fence is in force.
static bool receive_fence(struct connection *connection, struct fence *fence, struct error *error)
{
    struct message message = {0};
    enum message_code code;
    const char *line;
    size_t length;
    bool ok;

    while (!(line = connection_next(connection, &length, error)))
        if (error->message[0] || !connection_receive(connection)) {
            if (!error->message[0]) error_set(error, "expected worker.fence, got the end");
            return false;
        }
    ok = message_decode(&message, line, length, &code, error) && fence_read(fence, &message, error);
    message_finish(&message);
    return ok;
}

static bool fence_in(struct worker *worker)
{
    static const char *const faults[] = {"worker", "job", "output", "root"};
    const struct options *options = worker->options;
    enum sandbox_fault fault = SANDBOX_FAULT_WORKER;
    struct fence fence = {0};
    const struct sandbox_job job = {.fence = &fence, .shader_folder = options->shader_dir};
    struct error error = {0};
    bool ok = receive_fence(&worker->connection, &fence, &error) &&
              (!options->has_sandbox || sandbox_enter_job(&job, worker->sandbox, &fault, &error));

    fence_finish(&fence);
    if (!ok) report_unable(&worker->connection, faults[fault], error.message);
    return ok;
}

// A node and the daemon are of one version and, where they know it, of one commit.
static int run_node(int argc, char *argv[])
{
    char version[64];

    snprintf(version, sizeof version, "%s %s", MARCHD_VERSION, version_commit);
    if (argc == 2) return host_run(version, NULL);
    if (argc == 4 && strcmp(argv[2], "--worker") == 0) return host_run(version, argv[3]);
    log_error("expected march-worker --node [--worker PROGRAM]");
    return 2;
}

int main(int argc, char *argv[])
{
    struct options options;
    struct worker worker;
    struct error error = {0};
    pthread_t threads[2];
    int signal_fd;

    if (argc > 1 && strcmp(argv[1], "--node") == 0) return run_node(argc, argv);
    if (!options_parse(&options, argc, argv, &error)) {
        log_error("%s", error.message);
        return 2;
    }
    if (options.wants_version) {
        version_print(stdout, "march-worker");
        library_versions_print(stdout);
        return 0;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    keep_memory_whole();
    if (options.is_fenced) sandbox_close_files(options.fd);
    sandbox_limit(options.memory_bytes);
    memory_end_watch(options.memory_bytes);
    signal_fd = open_signals();
    if (signal_fd < 0 || !worker_init(&worker, &options)) return 1;
    if (options.is_fenced && !fence_in(&worker)) {
        worker_finish(&worker);
        return 1;
    }
    // Threads that do not end, or were not all started, end with the process.
    if (!start_threads(&worker, threads) || !serve(&worker, signal_fd)) _exit(1);
    for (int i = 0; i < 2; i++)
        pthread_join(threads[i], NULL);
    worker_finish(&worker);
    close(signal_fd);
    return worker.exit_code;
}
