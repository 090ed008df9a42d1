// A worker that renders nothing: it speaks the protocol, for the daemon's benchmarks and process tests.
// SPDX-License-Identifier: Apache-2.0
//
// stub-worker --fd N [--names-job] [--mode MODE], other options are ignored. With --names-job, which is not the last
// argument, a file's text names its job, too. MODE is
//   skip         writes each frame's file and answers frame.skipped at once, as if it had found the file (default)
//   claim        answers frame.skipped without a file
//   some:MS      like skip for frames below 100, like write for the others
//   sleep:MS     the same after MS milliseconds
//   write:MS     writes a small file after MS milliseconds, or at once after SIGUSR1, and reports it finished
//   forced       skips frames, and writes like write those that it is told to render in any case
//   audited:MS   the same, and reports its accuracy
//   plan:MS      like write, and reports that it plans first, for 48 frames, and that a quarter is rendered
//   phase:MS     like write, and plans for as long
//   share:MS     like write at once, with a plan that it asks for, and makes in so long where it is told to
//   misplan:MS   the same with a plan that no job may state
//   intrude:MS   like write at once, with a plan that it was not told to make
//   lie:MS       like write, but reports a wrong file, and frames that it was not given as finished
//   gone         like write at once, but removes the file before it reports it
//   short        the same, but cuts the file
//   fail:FAULT   answers frame.failed with that fault
//   crash        dies when it begins a frame
//   loyal        like write at once, for the first job that it serves; dies when it begins a frame of another
//   hang         begins a frame and sends nothing more
//   garbage      begins a frame and sends bytes that are no message
//   nocontext    sends worker.failed and exits 1
#include "bench/stub_job.h"
#include "bench/stub_report.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/hash.h"
#include "core/json/json_write.h"
#include "core/wire/frame_accuracy.h"
#include "core/wire/message.h"
#include "core/wire/message_stream.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { BEAT_MS = 1000 };

static volatile sig_atomic_t is_hurried;

enum stub_plan { PLAN_NONE, PLAN_ASKED, PLAN_MAKES, PLAN_SENT, PLAN_HAS };

struct stub {
    int fd;
    const char *mode;
    bool names_job;
    int64_t frame_ms; // 0: answered at once
    struct message_stream stream;
    struct json_writer out;
    struct stub_frame *frames; // [next, count) are in flight; the one at `next` is begun if `is_begun`
    size_t next, count, capacity;
    bool is_begun, is_exiting;
    int64_t due_ms, beat_ms;
    int64_t first_job;   // that it served; 0: none yet
    enum stub_plan plan; // of the frame that is begun
    double progress;
    struct stub_job *jobs;
    size_t job_count, job_capacity;
};

static int64_t now_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static bool has_mode(const struct stub *stub, const char *mode)
{
    return strncmp(stub->mode, mode, strlen(mode)) == 0;
}

static bool writes_files(const struct stub *stub)
{
    return has_mode(stub, "write") || has_mode(stub, "audited") || has_mode(stub, "plan") || has_mode(stub, "phase") ||
           has_mode(stub, "lie") || has_mode(stub, "loyal") || has_mode(stub, "share") || has_mode(stub, "misplan") ||
           has_mode(stub, "intrude") || has_mode(stub, "forced") || has_mode(stub, "skip") || has_mode(stub, "sleep") ||
           has_mode(stub, "some") || has_mode(stub, "gone") || has_mode(stub, "short");
}

// Whether the frame's file passes for one that was there.
static bool finds_file(const struct stub *stub, const struct stub_frame *frame)
{
    return has_mode(stub, "skip") || has_mode(stub, "sleep") || (has_mode(stub, "some") && frame->frame < 100) ||
           (has_mode(stub, "forced") && !frame->is_forced);
}

static bool shares_plans(const struct stub *stub)
{
    return has_mode(stub, "share") || has_mode(stub, "misplan") || has_mode(stub, "intrude");
}

static void flush(struct stub *stub)
{
    if (stub->out.length > 0 && !file_write_all(stub->fd, stub->out.text, stub->out.length, NULL)) exit(0);
    json_writer_clear(&stub->out);
}

static void say_beat(struct stub *stub)
{
    message_begin_notification(&stub->out, "worker.beat");
    json_write_begin_object(&stub->out);
    json_write_number_member(&stub->out, "progress", stub->progress++);
    stub_report_end(&stub->out);
}

static const struct stub_job *find_job(const struct stub *stub, int64_t id)
{
    for (size_t i = 0; i < stub->job_count; i++) {
        if (stub->jobs[i].id == id) return &stub->jobs[i];
    }
    return NULL;
}

static const struct frame_accuracy audited = {.audit = "reference",
                                              .error = 0.00625,
                                              .error95 = 0.0075,
                                              .audit_rays = 64,
                                              .method = "cached",
                                              .has_cut_share = true,
                                              .cut_share = 0.125,
                                              .traced = 0.0625};

static void say_finished(struct stub *stub, const struct stub_frame *frame, uint64_t inode_number, int64_t size_bytes,
                         const char *hash)
{
    char inode[32];

    snprintf(inode, sizeof inode, "%llu", (unsigned long long)inode_number);
    stub_report_begin(&stub->out, "frame.finished", frame);
    json_write_string_member(&stub->out, "inode", inode);
    json_write_integer_member(&stub->out, "size_bytes", size_bytes);
    json_write_string_member(&stub->out, "hash", hash);
    json_write_number_member(&stub->out, "render_s", (double)stub->frame_ms / 1000);
    json_write_number_member(&stub->out, "encode_s", 0);
    if (has_mode(stub, "audited")) frame_accuracy_write(&audited, &stub->out);
    stub_report_end(&stub->out);
}

// Each would be published if the daemon did not check it.
static void say_lies(struct stub *stub, const struct stub_frame *frame, const struct stat *status, const char *hash)
{
    const struct stub_frame untold[] = {{frame->job + 1, frame->frame, frame->attempt, false},
                                        {frame->job, frame->frame + 1000, frame->attempt, false},
                                        {frame->job, frame->frame, frame->attempt + 1, false}};

    for (size_t i = 0; i < sizeof untold / sizeof untold[0]; i++)
        say_finished(stub, &untold[i], status->st_ino, status->st_size, hash);
    if (frame->attempt % 2)
        say_finished(stub, frame, status->st_ino + 1, status->st_size, hash);
    else
        say_finished(stub, frame, status->st_ino, status->st_size + 1, hash);
    say_finished(stub, frame, status->st_ino, status->st_size, hash);
}

static void write_and_say_finished(struct stub *stub, const struct stub_frame *frame)
{
    const struct stub_job *job = find_job(stub, frame->job);
    struct error error = {0};
    char hash[HASH_TEXT_SIZE];
    const char *fault;
    struct stat status;

    if (!job) {
        stub_report_failed(&stub->out, frame, "frame", "the job was not told");
    } else if (!stub_job_write_file(job, frame, finds_file(stub, frame), &status, hash, &fault, &error)) {
        stub_report_failed(&stub->out, frame, fault, error.message);
    } else if (finds_file(stub, frame)) {
        stub_report_skipped(&stub->out, frame, status.st_size, hash);
    } else if (has_mode(stub, "lie")) {
        say_lies(stub, frame, &status, hash);
    } else {
        if (has_mode(stub, "gone") || has_mode(stub, "short")) stub_job_spoil_file(job, frame, has_mode(stub, "gone"));
        say_finished(stub, frame, status.st_ino, status.st_size, hash);
    }
}

static void send_plan(struct stub *stub, const struct stub_frame *frame)
{
    stub_report_plan_made(&stub->out, frame, has_mode(stub, "misplan"));
    stub->plan = PLAN_SENT;
}

static void ask_for_plan(struct stub *stub, const struct stub_frame *frame)
{
    if (has_mode(stub, "intrude")) {
        send_plan(stub, frame);
        return;
    }
    stub_report_plan_wanted(&stub->out, frame);
    stub->plan = PLAN_ASKED;
}

static void begin_frame(struct stub *stub)
{
    const struct stub_frame *frame = &stub->frames[stub->next];

    stub->is_begun = true;
    stub->due_ms = now_ms() + (has_mode(stub, "some") && finds_file(stub, frame) ? 0 : stub->frame_ms);
    if (has_mode(stub, "skip")) return;
    stub_report_begin(&stub->out, "frame.started", frame);
    stub_report_end(&stub->out);
    if (has_mode(stub, "plan") || has_mode(stub, "phase")) {
        stub_report_begin(&stub->out, "frame.planning", frame);
        stub_report_end(&stub->out);
    }
    if (has_mode(stub, "plan")) {
        stub_report_begin(&stub->out, "frame.planned", frame);
        json_write_integer_member(&stub->out, "frames", 48);
        stub_report_end(&stub->out);
        stub_report_begin(&stub->out, "frame.phase", frame);
        json_write_string_member(&stub->out, "phase", "render");
        json_write_number_member(&stub->out, "progress", 0.25);
        stub_report_end(&stub->out);
    }
    if (shares_plans(stub)) ask_for_plan(stub, frame);
    if (has_mode(stub, "garbage")) json_write_raw(&stub->out, "what?\n", 6);
    if (!stub->first_job) stub->first_job = frame->job;
    if (has_mode(stub, "crash") || (has_mode(stub, "loyal") && frame->job != stub->first_job)) {
        flush(stub);
        fprintf(stderr, "stub: crashing on frame %d\n", frame->frame);
        signal(SIGSEGV, SIG_DFL);
        raise(SIGSEGV);
    }
}

static void end_frame(struct stub *stub)
{
    const struct stub_frame frame = stub->frames[stub->next++];

    stub->is_begun = false;
    stub->plan = PLAN_NONE;
    if (has_mode(stub, "fail:"))
        stub_report_failed(&stub->out, &frame, stub->mode + 5, "the stub was told to fail");
    else if (writes_files(stub))
        write_and_say_finished(stub, &frame);
    else
        stub_report_skipped(&stub->out, &frame, 9, "00000000000000000000000000000000");
}

// Begins and ends the frames that are due. Returns the milliseconds until there is more to do, or -1.
static int work(struct stub *stub)
{
    while (stub->next < stub->count) {
        int64_t left_ms;

        if (!stub->is_begun) begin_frame(stub);
        if (has_mode(stub, "hang") || has_mode(stub, "garbage")) return -1;
        if (stub->plan == PLAN_ASKED || stub->plan == PLAN_SENT) return -1;
        left_ms = stub->plan != PLAN_HAS && stub->frame_ms > 0 && !is_hurried ? stub->due_ms - now_ms() : 0;
        if (left_ms > 0) return (int)left_ms;
        if (stub->plan == PLAN_MAKES) {
            send_plan(stub, &stub->frames[stub->next]);
            return -1;
        }
        end_frame(stub);
    }
    stub->next = stub->count = 0;
    return -1;
}

static int64_t read_integer(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    int64_t integer = 0;

    json_read_integer(&node, 0, INT64_MAX, &integer, NULL);
    return integer;
}

static void note_assignment(struct stub *stub, const struct json_node *params)
{
    struct json_node frames = json_node_child(params, "frames");
    struct json_node pair = {0};

    while (json_node_next(&frames, &pair)) {
        struct json_node frame = json_node_element(&pair, 0), attempt = json_node_element(&pair, 1);
        struct json_node forced = json_node_element(&pair, 2);
        int64_t number = 0, tries = 0;

        json_read_integer(&frame, 0, INT32_MAX, &number, NULL);
        json_read_integer(&attempt, 0, INT32_MAX, &tries, NULL);
        stub->frames = xgrow(stub->frames, &stub->capacity, stub->count + 1, sizeof stub->frames[0]);
        stub->frames[stub->count++] = (struct stub_frame){.job = read_integer(params, "job"),
                                                          .frame = (int32_t)number,
                                                          .attempt = (int32_t)tries,
                                                          .is_forced = !json_node_is_absent(&forced)};
    }
}

static void note_job(struct stub *stub, const struct json_node *params)
{
    struct stub_job job;

    if (!writes_files(stub) || !stub_job_read(&job, params)) return;
    job.names_job = stub->names_job;
    stub->jobs = xgrow(stub->jobs, &stub->job_capacity, stub->job_count + 1, sizeof stub->jobs[0]);
    stub->jobs[stub->job_count++] = job;
}

static void forget_job(struct stub *stub, int64_t id)
{
    for (size_t i = 0; i < stub->job_count; i++) {
        if (stub->jobs[i].id != id) continue;
        stub_job_finish(&stub->jobs[i]);
        stub->jobs[i--] = stub->jobs[--stub->job_count];
    }
}

static void note_plan(struct stub *stub, const struct json_node *params)
{
    static const char *const words[] = {"plan", "make", "wait", "refuse", NULL};
    struct json_node say = json_node_child(params, "say"), reason = json_node_child(params, "error");
    const char *error = "";
    int word;

    if (!json_read_enum(&say, words, &word, NULL) || stub->plan == PLAN_NONE) return;
    if (word == 0) stub->plan = PLAN_HAS;
    if (word == 1) stub->plan = PLAN_MAKES;
    if (word == 1) stub->due_ms = now_ms() + stub->frame_ms;
    if (word != 3) return;
    (void)json_read_string(&reason, &error, NULL);
    stub_report_failed(&stub->out, &stub->frames[stub->next++], "missed", error);
    stub->is_begun = false;
    stub->plan = PLAN_NONE;
}

// Job 0 stands for all jobs.
static void drop_frames(struct stub *stub, int64_t job, bool running)
{
    size_t first = stub->is_begun && !running ? stub->next + 1 : stub->next;
    size_t kept = first;

    for (size_t i = first; i < stub->count; i++) {
        const struct stub_frame frame = stub->frames[i];

        if (job && frame.job != job) {
            stub->frames[kept++] = frame;
            continue;
        }
        if (i == stub->next) stub->is_begun = false;
        stub_report_begin(&stub->out, "frame.dropped", &frame);
        stub_report_end(&stub->out);
    }
    stub->count = kept;
}

static void note_message(struct stub *stub, const struct message *message)
{
    struct json_node running = json_node_child(&message->body, "running");
    int64_t job = read_integer(&message->body, "job");
    bool drops_running = false;

    if (strcmp(message->method, "worker.assign") == 0) note_assignment(stub, &message->body);
    if (strcmp(message->method, "worker.job") == 0) note_job(stub, &message->body);
    if (strcmp(message->method, "worker.plan") == 0) note_plan(stub, &message->body);
    if (strcmp(message->method, "worker.forget") == 0) forget_job(stub, job);
    if (strcmp(message->method, "worker.drop") == 0) {
        json_read_bool(&running, &drops_running, NULL);
        drop_frames(stub, job, drops_running);
    }
    if (strcmp(message->method, "worker.exit") == 0) {
        drop_frames(stub, 0, false);
        stub->is_exiting = true;
    }
}

// Returns false at the end of the stream.
static bool take_messages(struct stub *stub)
{
    size_t room, length;
    char *bytes = message_stream_reserve(&stub->stream, &room);
    ssize_t count = read(stub->fd, bytes, room);
    const char *line;

    if (count <= 0) return count < 0 && errno == EINTR;
    message_stream_commit(&stub->stream, (size_t)count);
    while ((line = message_stream_next(&stub->stream, &length, NULL))) {
        struct message message = {0};
        enum message_code code;

        if (message_decode(&message, line, length, &code, NULL) && message.method) note_message(stub, &message);
        message_finish(&message);
    }
    return true;
}

static void run(struct stub *stub)
{
    struct pollfd poll_fd = {.fd = stub->fd, .events = POLLIN};

    for (;;) {
        int wait_ms = work(stub);

        if (stub->is_exiting && stub->next == stub->count) break;
        if (now_ms() - stub->beat_ms >= BEAT_MS && !has_mode(stub, "hang")) {
            stub->beat_ms = now_ms();
            say_beat(stub);
        }
        flush(stub);
        if (wait_ms < 0 || wait_ms > BEAT_MS) wait_ms = BEAT_MS;
        if (poll(&poll_fd, 1, wait_ms) > 0 && !take_messages(stub)) break;
    }
    flush(stub);
}

static void finish(struct stub *stub)
{
    while (stub->job_count > 0)
        forget_job(stub, stub->jobs[0].id);
    free(stub->jobs);
    free(stub->frames);
    message_stream_finish(&stub->stream);
    json_writer_finish(&stub->out);
}

static void on_hurry(int number)
{
    (void)number;
    is_hurried = 1;
}

int main(int argc, char **argv)
{
    struct stub stub = {.fd = 3, .mode = "skip"};
    const char *colon;

    for (int i = 1; i + 1 < argc; i++) {
        if (strcmp(argv[i], "--fd") == 0) stub.fd = atoi(argv[i + 1]);
        if (strcmp(argv[i], "--mode") == 0) stub.mode = argv[i + 1];
        if (strcmp(argv[i], "--names-job") == 0) stub.names_job = true;
    }
    colon = strchr(stub.mode, ':');
    if (colon) stub.frame_ms = atoi(colon + 1);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGUSR1, on_hurry);
    // Ends with the daemon, as march-worker does: nothing removes what a dead daemon's worker writes.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (has_mode(&stub, "nocontext")) {
        stub_report_unable(&stub.out);
        flush(&stub);
        finish(&stub);
        return 1;
    }
    stub_report_ready(&stub.out);
    run(&stub);
    finish(&stub);
    return 0;
}
