// SPDX-License-Identifier: Apache-2.0
#include "bench/private_farm.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/json/json_read.h"
#include "core/wire/message.h"

#include <errno.h>
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

enum { OPTION_LIMIT = 32 };

void private_farm_give_up(const char *what)
{
    fprintf(stderr, "%s: %s\n", program_invocation_short_name, what);
    exit(1);
}

void private_farm_sleep_ms(long ms)
{
    nanosleep(&(struct timespec){.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000}, NULL);
}

void private_farm_init(struct private_farm *farm)
{
    ssize_t length;

    *farm = (struct private_farm){.scratch = "/tmp/marchd_bench_XXXXXX"};
    length = readlink("/proc/self/exe", farm->programs, sizeof farm->programs - 1);
    if (length <= 0 || !mkdtemp(farm->scratch)) private_farm_give_up("cannot make a scratch folder");
    *strrchr(farm->programs, '/') = '\0';
    snprintf(farm->socket_path, sizeof farm->socket_path, "%s/sock", farm->scratch);
    snprintf(farm->out, sizeof farm->out, "%s/out", farm->scratch);
    snprintf(farm->worker, sizeof farm->worker, "%s/worker", farm->scratch);
    signal(SIGPIPE, SIG_IGN);
}

void private_farm_finish(struct private_farm *farm)
{
    char *remove = xasprintf("rm -rf '%s' '%s'", farm->scratch, farm->out);

    json_writer_finish(&farm->request);
    if (system(remove) != 0) private_farm_give_up("cannot remove the scratch folder");
    free(remove);
}

void private_farm_use_memory(struct private_farm *farm)
{
    snprintf(farm->out, sizeof farm->out, "/dev/shm/marchd_bench_XXXXXX");
    if (!mkdtemp(farm->out)) private_farm_give_up("cannot make a folder in /dev/shm");
}

void private_farm_write_worker(struct private_farm *farm, const char *mode)
{
    char *text = mode ? xasprintf("#!/bin/sh\nexec '%s/stub-worker' --mode %s \"$@\"\n", farm->programs, mode)
                      : xasprintf("#!/bin/sh\nexec '%s/march-worker' \"$@\"\n", farm->programs);

    if (!file_write_atomic(farm->worker, text, strlen(text), NULL) || chmod(farm->worker, 0755) != 0)
        private_farm_give_up("cannot write the worker script");
    free(text);
}

static bool try_connect(struct private_farm *farm)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};

    memcpy(address.sun_path, farm->socket_path, sizeof address.sun_path);
    farm->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (connect(farm->fd, (struct sockaddr *)&address, sizeof address) == 0) return true;
    close(farm->fd);
    return false;
}

void private_farm_start(struct private_farm *farm, const char *const options[])
{
    char *program = xasprintf("%s/marchd", farm->programs);
    char *state = xasprintf("%s/state", farm->scratch);
    const char *arguments[OPTION_LIMIT] = {program,         "--state", state,         "--socket", farm->socket_path,
                                           "--output-root", farm->out, "--log-level", "error"};
    size_t count = 9;
    double start_s = clock_now_s();

    while (*options && count < OPTION_LIMIT - 1)
        arguments[count++] = *options++;
    farm->daemon = fork();
    if (farm->daemon == 0) {
        execv(program, (char *const *)arguments);
        _exit(127);
    }
    while (!try_connect(farm)) {
        if (clock_now_s() - start_s > 60) private_farm_give_up("the daemon does not listen");
        private_farm_sleep_ms(1);
    }
    free(program);
    free(state);
}

void private_farm_stop(struct private_farm *farm)
{
    close(farm->fd);
    message_stream_finish(&farm->stream);
    kill(farm->daemon, SIGTERM);
    waitpid(farm->daemon, NULL, 0);
}

size_t private_farm_ask(struct private_farm *farm, const char *method, const char *params, struct message *answer)
{
    const char *line;
    size_t length, room;
    enum message_code code;
    struct error error = {0};

    message_begin_request(&farm->request, 1, method);
    json_write_raw(&farm->request, params, strlen(params));
    message_end(&farm->request);
    if (!file_write_all(farm->fd, farm->request.text, farm->request.length, &error))
        private_farm_give_up(error.message);
    json_writer_clear(&farm->request);
    while (!(line = message_stream_next(&farm->stream, &length, &error))) {
        char *bytes = message_stream_reserve(&farm->stream, &room);
        ssize_t count = read(farm->fd, bytes, room);

        if (count <= 0) private_farm_give_up("the daemon hung up");
        message_stream_commit(&farm->stream, (size_t)count);
    }
    if (!message_decode(answer, line, length, &code, &error)) private_farm_give_up(error.message);
    if (answer->kind == MESSAGE_ERROR) private_farm_give_up(answer->text);
    return length;
}

static const char params_format[] =
    "{\"document\":{\"version\":1,\"name\":\"bench\",\"frames\":\"%s\",\"fps\":24,\"resolution\":[32,18],"
    "\"camera\":{\"position\":[0,0,-2],\"target\":[0,0,0],\"fov\":53},"
    "\"lights\":[{\"kind\":\"sun\",\"direction\":[0,-1,0],\"intensity\":1}],"
    "\"scene\":{\"media\":[{\"density\":{\"kind\":\"fold_fractal\",\"iterations\":8,\"offset\":0.06,\"radius\":0.15,"
    "\"exponent\":1.3,\"scale\":10},\"sigma_s\":64}]},"
    "\"quality\":{\"method\":\"midpoint\",\"step\":0.01,\"light_step\":0.02},"
    "\"output\":{\"path\":\"bench/%d.####.exr\"}},\"paused\":%s}";

int64_t private_farm_submit(struct private_farm *farm, const char *range, bool paused)
{
    char *params = xasprintf(params_format, range, farm->outputs++, paused ? "true" : "false");
    struct message answer = {0};
    struct json_node id;
    int64_t job = 0;

    private_farm_ask(farm, "job.submit", params, &answer);
    id = json_node_child(&answer.body, "id");
    json_read_integer(&id, 1, INT64_MAX, &job, NULL);
    message_finish(&answer);
    free(params);
    return job;
}

static bool has_succeeded(struct private_farm *farm, int64_t job)
{
    char *params = xasprintf("{\"id\":%lld}", (long long)job);
    struct message answer = {0};
    struct json_node state;
    const char *text = "";
    bool succeeded;

    private_farm_ask(farm, "job.show", params, &answer);
    state = json_node_child(&answer.body, "state");
    json_read_string(&state, &text, NULL);
    succeeded = strcmp(text, "succeeded") == 0;
    message_finish(&answer);
    free(params);
    return succeeded;
}

void private_farm_wait(struct private_farm *farm, int64_t job)
{
    while (!has_succeeded(farm, job))
        private_farm_sleep_ms(5);
}

double private_farm_run_job(struct private_farm *farm, const char *range)
{
    double start_s = clock_now_s();

    private_farm_wait(farm, private_farm_submit(farm, range, false));
    return clock_now_s() - start_s;
}

double private_farm_run_again(struct private_farm *farm, int64_t job)
{
    char *params = xasprintf("{\"id\":%lld,\"state\":\"skipped\"}", (long long)job);
    struct message answer = {0};
    double start_s = clock_now_s();

    private_farm_ask(farm, "job.retry", params, &answer);
    message_finish(&answer);
    private_farm_wait(farm, job);
    free(params);
    return clock_now_s() - start_s;
}

double private_farm_processor_s(pid_t pid)
{
    char *path = xasprintf("/proc/%d/stat", (int)pid);
    FILE *file = fopen(path, "r");
    long user = 0, system = 0;

    if (!file || fscanf(file, "%*d (%*[^)]) %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %ld %ld", &user, &system) != 2)
        private_farm_give_up("cannot read a processor time");
    fclose(file);
    free(path);
    return (double)(user + system) / (double)sysconf(_SC_CLK_TCK);
}

double private_farm_memory_mib(pid_t pid)
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

void private_farm_print_row(const char *what, double value, const char *unit, const char *target)
{
    printf("%-58s %12.4g %-9s %s\n", what, value, unit, target);
    fflush(stdout);
}
