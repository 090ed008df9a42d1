// A node whose workers are no processes: it speaks the lines of many, for benchmarks of the daemon.
// SPDX-License-Identifier: Apache-2.0
//
// stub-node [MS]: on its standard streams, as march-worker --node. Each of its workers writes and answers its frames
// like stub-worker in the mode skip, or sleep:MS, and beats every second.
#include "bench/stub_job.h"
#include "bench/stub_report.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/version.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "core/wire/message_stream.h"
#include "node/node_line.h"
#include "node/node_probe.h"

#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { WORKER_LIMIT = 1024 + 1, BEAT_MS = 1000, LOOK_MS = 10000, WORK_MS = 5 };

struct stub_node_worker {
    bool is_there;
    struct stub_frame *frames; // owned; [next, count) are in hand, the one at `next` is begun
    size_t next, count, capacity;
    int64_t due_ms; // of the frame that is begun
};

struct stub_node {
    struct message_stream in;
    struct json_writer message; // of one worker
    int64_t frame_ms;           // that a frame takes; 0: it is answered at once
    struct stub_node_worker workers[WORKER_LIMIT];
    int64_t beats, beat_ms;
    struct stub_job *jobs; // owned; that any worker was told of
    size_t job_count, job_capacity;
};

static int64_t now_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static void say(enum node_word word, int worker, const char *rest, size_t length)
{
    char head[NODE_LINE_HEAD_SIZE];

    fwrite(head, 1, node_line_write_head(head, word, worker), stdout);
    fwrite(rest, 1, length, stdout);
    putchar('\n');
}

// The message was written for stub-worker: with its newline.
static void say_message(struct stub_node *node, int worker)
{
    say(NODE_FROM, worker, node->message.text, node->message.length - 1);
    json_writer_clear(&node->message);
}

static int64_t read_integer(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    int64_t integer = 0;

    json_read_integer(&node, 0, INT64_MAX, &integer, NULL);
    return integer;
}

static const struct stub_job *find_job(const struct stub_node *node, int64_t id)
{
    for (size_t i = node->job_count; i-- > 0;)
        if (node->jobs[i].id == id) return &node->jobs[i];
    return NULL;
}

static void note_job(struct stub_node *node, const struct json_node *params)
{
    struct stub_job job;

    if (find_job(node, read_integer(params, "job")) || !stub_job_read(&job, params)) return;
    node->jobs = xgrow(node->jobs, &node->job_capacity, node->job_count + 1, sizeof node->jobs[0]);
    node->jobs[node->job_count++] = job;
}

static void answer_frame(struct stub_node *node, int worker, const struct stub_frame *frame)
{
    const struct stub_job *job = find_job(node, frame->job);
    char hash[HASH_TEXT_SIZE];
    const char *fault = "frame";
    struct error error = {.message = "the job was not told"};
    struct stat status;

    if (job && stub_job_write_file(job, frame, true, &status, hash, &fault, &error))
        stub_report_skipped(&node->message, frame, status.st_size, hash);
    else
        stub_report_failed(&node->message, frame, fault, error.message);
    say_message(node, worker);
}

static void begin_frame(struct stub_node *node, int worker)
{
    struct stub_node_worker *hand = &node->workers[worker];

    hand->due_ms = now_ms() + node->frame_ms;
    stub_report_begin(&node->message, "frame.started", &hand->frames[hand->next]);
    stub_report_end(&node->message);
    say_message(node, worker);
}

static void note_assignment(struct stub_node *node, int worker, const struct json_node *params)
{
    struct json_node frames = json_node_child(params, "frames");
    struct stub_frame frame = {.job = read_integer(params, "job")};
    struct stub_node_worker *hand = &node->workers[worker];
    struct json_node pair = {0};

    while (json_node_next(&frames, &pair)) {
        struct json_node number = json_node_element(&pair, 0), attempt = json_node_element(&pair, 1);
        int64_t integer = 0;

        json_read_integer(&number, 0, INT32_MAX, &integer, NULL);
        frame.frame = (int32_t)integer;
        json_read_integer(&attempt, 0, INT32_MAX, &integer, NULL);
        frame.attempt = (int32_t)integer;
        if (node->frame_ms == 0) {
            answer_frame(node, worker, &frame);
            continue;
        }
        hand->frames = xgrow(hand->frames, &hand->capacity, hand->count + 1, sizeof hand->frames[0]);
        hand->frames[hand->count++] = frame;
        if (hand->count - hand->next == 1) begin_frame(node, worker);
    }
}

// Answers the frames whose time is over.
static void work(struct stub_node *node)
{
    for (int i = 0; i < WORKER_LIMIT; i++) {
        struct stub_node_worker *worker = &node->workers[i];

        if (worker->next == worker->count || now_ms() < worker->due_ms) continue;
        answer_frame(node, i, &worker->frames[worker->next++]);
        if (worker->next < worker->count)
            begin_frame(node, i);
        else
            worker->next = worker->count = 0;
    }
}

static void end_worker(struct stub_node *node, int worker, const char *how)
{
    node->workers[worker].is_there = false;
    node->workers[worker].next = node->workers[worker].count = 0;
    say(NODE_ENDED, worker, how, strlen(how));
}

static void take_message(struct stub_node *node, const struct node_line *line)
{
    struct message message = {0};
    enum message_code code;

    if (message_decode(&message, line->rest, line->length, &code, NULL) && message.method) {
        if (strcmp(message.method, "worker.assign") == 0) note_assignment(node, line->worker, &message.body);
        if (strcmp(message.method, "worker.job") == 0) note_job(node, &message.body);
        if (strcmp(message.method, "worker.exit") == 0) end_worker(node, line->worker, "0 0");
    }
    message_finish(&message);
}

static void start_worker(struct stub_node *node, int worker)
{
    char pid[16];

    snprintf(pid, sizeof pid, "%d", (int)getpid());
    node->workers[worker].is_there = true;
    say(NODE_STARTED, worker, pid, strlen(pid));
    stub_report_ready(&node->message);
    say_message(node, worker);
}

static void answer_probe(const struct node_line *line)
{
    struct node_probe probe = {0};
    struct json_writer writer = {0};
    struct json_node object;
    struct cJSON *root;

    if (!json_parse(&root, line->rest, line->length, NULL)) exit(1);
    object = json_node_root(root);
    if (!node_probe_read_json(&probe, &object, NULL) || !node_probe_look(&probe, NODE_PROBE_DAEMON, LOOK_MS, NULL) ||
        !node_probe_write(&probe, NODE_PROBE_NODE, NULL))
        exit(1);
    node_probe_write_json(&probe, NULL, &writer);
    say(NODE_PROBED, NODE_NO_WORKER, writer.text, writer.length);
    json_writer_finish(&writer);
    node_probe_finish(&probe);
    json_delete(root);
}

static void take_line(struct stub_node *node, const char *bytes, size_t length)
{
    struct node_line line;

    if (!node_line_read(&line, bytes, length, NULL) || line.worker >= WORKER_LIMIT) exit(1);
    if (line.word == NODE_PROBE) answer_probe(&line);
    if (line.word == NODE_START) start_worker(node, line.worker);
    if (line.word == NODE_TO && node->workers[line.worker].is_there) take_message(node, &line);
    if (line.word == NODE_KILL && node->workers[line.worker].is_there) end_worker(node, line.worker, "0 9");
}

static void beat(struct stub_node *node)
{
    node->beat_ms = now_ms();
    node->beats++;
    say(NODE_BEAT, NODE_NO_WORKER, "", 0);
    for (int i = 0; i < WORKER_LIMIT; i++) {
        if (!node->workers[i].is_there) continue;
        message_begin_notification(&node->message, "worker.beat");
        json_write_begin_object(&node->message);
        json_write_integer_member(&node->message, "progress", node->beats);
        stub_report_end(&node->message);
        say_message(node, i);
    }
}

// False at the end of the stream.
static bool take_lines(struct stub_node *node)
{
    size_t room, length;
    char *bytes = message_stream_reserve(&node->in, &room);
    ssize_t count = read(STDIN_FILENO, bytes, room);
    const char *line;

    if (count <= 0) return false;
    message_stream_commit(&node->in, (size_t)count);
    while ((line = message_stream_next(&node->in, &length, NULL)))
        take_line(node, line, length);
    return true;
}

int main(int argc, char **argv)
{
    static struct stub_node node;
    static char buffer[256 * 1024];
    struct pollfd poll_fd = {.fd = STDIN_FILENO, .events = POLLIN};

    setvbuf(stdout, buffer, _IOFBF, sizeof buffer);
    printf("marchd-node {\"protocol\":%d,\"version\":\"%s %s\",\"host\":\"stub\",\"landlock\":1,\"lack\":null}\n",
           NODE_PROTOCOL, MARCHD_VERSION, version_commit);
    node.beat_ms = now_ms();
    if (argc > 1) node.frame_ms = atoi(argv[1]);
    for (;;) {
        int64_t wait_ms = node.frame_ms ? WORK_MS : node.beat_ms + BEAT_MS - now_ms();

        if (fflush(stdout) != 0) break;
        if (poll(&poll_fd, 1, wait_ms > 0 ? (int)wait_ms : 0) > 0 && !take_lines(&node)) break;
        if (now_ms() - node.beat_ms >= BEAT_MS) beat(&node);
        if (node.frame_ms) work(&node);
    }
    for (int i = 0; i < WORKER_LIMIT; i++)
        free(node.workers[i].frames);
    while (node.job_count > 0)
        stub_job_finish(&node.jobs[--node.job_count]);
    free(node.jobs);
    message_stream_finish(&node.in);
    json_writer_finish(&node.message);
    return 0;
}
