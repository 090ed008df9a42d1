// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notifier.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "web/notify/notify_command.h"
#include "web/notify/notify_daemon.h"
#include "web/notify/notify_post.h"
#include "web/notify/notify_queue.h"
#include "web/notify/notify_target.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

enum { ASK_MS = 1000, AWAY_MS = 2000, FD_LIMIT = 1 + NOTIFY_COMMAND_FDS * NOTIFY_TARGET_LIMIT };

struct notifier {
    struct notifier_params params;
    int stop_fd;
    pthread_t thread;
    // Of the thread.
    struct notify_daemon *daemon;                         // owned
    struct notify_queue queue;                            // owned
    struct notify_posts *posts;                           // owned
    struct notify_command *commands[NOTIFY_TARGET_LIMIT]; // owned; by target; NULL: none runs
    int64_t ask_ms;                                       // when to ask next
    bool is_away;                                         // the log has been told that the daemon is
};

static void *on_thread(void *user);
static void on_end(void *user, struct notify_line *line, enum notify_outcome outcome, const char *why);

static int64_t clock_ms(clockid_t clock)
{
    struct timespec now;

    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static bool load_secret(const struct notify_target *target, char **secret, size_t *size_bytes, struct error *error)
{
    *secret = NULL;
    *size_bytes = 0;
    return !target->secret_file || notify_secret_load(target->secret_file, secret, size_bytes, error);
}

bool notifier_check(const struct notify_targets *targets, struct error *error)
{
    for (size_t i = 0; i < targets->count; i++) {
        const struct notify_target *target = &targets->targets[i];
        char *secret;
        size_t size_bytes;
        bool ok = load_secret(target, &secret, &size_bytes, error);

        if (ok && target->arguments[0] && access(target->arguments[0], X_OK) != 0) {
            error_set_errno(error, errno, "command %s", target->arguments[0]);
            ok = false;
        }
        free(secret);
        if (ok) continue;
        error_prefix(error, "--notify-target: %s", target->name);
        return false;
    }
    return true;
}

// The thread gets no signals: they are the loop's.
struct notifier *notifier_start(const struct notifier_params *params, struct error *error)
{
    struct notifier *notifier = xcalloc(1, sizeof *notifier);
    sigset_t all, before;
    int failure;

    notifier->params = *params;
    notifier->queue.keep_ms = params->keep_ms;
    notifier->stop_fd = eventfd(0, EFD_CLOEXEC);
    notify_posts_prepare();
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    failure = notifier->stop_fd < 0 ? errno : pthread_create(&notifier->thread, NULL, on_thread, notifier);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (!failure) return notifier;
    error_set_errno(error, failure, "cannot start the thread that delivers notices");
    if (notifier->stop_fd >= 0) close(notifier->stop_fd);
    free(notifier);
    return NULL;
}

void notifier_stop(struct notifier *notifier)
{
    if (!notifier) return;
    eventfd_write(notifier->stop_fd, 1);
    pthread_join(notifier->thread, NULL);
    close(notifier->stop_fd);
    free(notifier);
}

// An address may hold a secret, so the log has only its host.
static void log_end(const struct notify_line *line, const char *what, const char *why)
{
    const char *host = line->is_webhook ? strstr(line->target, "://") + 3 : line->target;
    char *text = why ? xstrdup(why) : NULL;

    if (text) log_disarm(text);
    if (text)
        log_warn("notice %lld for %.*s: %s: %s", (long long)line->items[0].id, (int)strcspn(host, "/?#"), host, what,
                 text);
    else
        log_info("notice %lld for %.*s: %s", (long long)line->items[0].id, (int)strcspn(host, "/?#"), host, what);
    free(text);
}

static void give_up(struct notify_line *line, const char *why)
{
    notify_queue_give_up(line, why);
    log_end(line, "given up", why);
}

static void on_end(void *user, struct notify_line *line, enum notify_outcome outcome, const char *why)
{
    struct notifier *notifier = user;

    if (outcome == NOTIFY_DELIVERED) {
        notify_queue_succeed(line);
        log_end(line, "delivered", NULL);
        return;
    }
    if (outcome == NOTIFY_HOPELESS) {
        give_up(line, why);
        return;
    }
    notify_queue_fail(&notifier->queue, line, clock_ms(CLOCK_MONOTONIC), clock_ms(CLOCK_REALTIME), why);
    log_end(line, line->state == NOTIFY_IS_OVER ? "given up" : "failed, and is tried again", why);
}

static void post(struct notifier *notifier, struct notify_line *line, const struct notify_target *target)
{
    struct notify_post_params params = {.url = target ? target->url : line->target,
                                        .may_be_private = target && target->may_be_private,
                                        .timeout_ms = notifier->params.timeout_ms,
                                        .line = line};
    struct error error = {0};
    char *secret = NULL;

    notify_queue_begin(line);
    if (target && !load_secret(target, &secret, &params.secret_size, &error)) {
        on_end(notifier, line, NOTIFY_FAILED, error.message);
        return;
    }
    params.secret = secret;
    notify_posts_begin(notifier->posts, &params);
    if (secret) explicit_bzero(secret, params.secret_size);
    free(secret);
}

static void run(struct notifier *notifier, struct notify_line *line, const struct notify_target *target)
{
    size_t index = (size_t)(target - notifier->params.targets->targets);
    int64_t deadline_ms = clock_ms(CLOCK_MONOTONIC) + notifier->params.timeout_ms;
    struct error error = {0};

    notify_queue_begin(line);
    notifier->commands[index] = notify_command_start(target->arguments, line->items[0].body, deadline_ms, line, &error);
    if (!notifier->commands[index]) on_end(notifier, line, NOTIFY_FAILED, error.message);
}

static void deliver(struct notifier *notifier, struct notify_line *line)
{
    const struct notify_target *target =
        line->is_webhook ? NULL : notify_targets_find(notifier->params.targets, line->target);

    if (line->is_webhook && !notifier->params.allows_webhooks)
        give_up(line, "jobs may not name addresses");
    else if (!line->is_webhook && !target)
        give_up(line, "there is no such target");
    else if (target && target->arguments[0])
        run(notifier, line, target);
    else
        post(notifier, line, target);
}

static void note_daemon(struct notifier *notifier, bool is_there, const struct error *error)
{
    if (!is_there && !notifier->is_away) log_warn("notices: %s", error->message);
    if (is_there && notifier->is_away) log_info("notices: the daemon answers");
    notifier->is_away = !is_there;
    if (!is_there) notifier->ask_ms = clock_ms(CLOCK_MONOTONIC) + AWAY_MS;
}

// What is over leaves the queue only when the daemon has stored that: otherwise its target would get more than one
// notice again, if march-web ended now.
static void talk(struct notifier *notifier)
{
    struct notify_line *line;
    struct error error = {0};
    bool ok = true, is_all = false;

    if (notifier->is_away && clock_ms(CLOCK_MONOTONIC) < notifier->ask_ms) return;
    while (ok && (line = notify_queue_find_over(&notifier->queue))) {
        ok = notify_daemon_tell(notifier->daemon, line->items[0].id, line->why, &error);
        if (ok) notify_queue_leave(&notifier->queue, line);
    }
    if (ok && clock_ms(CLOCK_MONOTONIC) < notifier->ask_ms) return;
    while (ok && !is_all)
        ok = notify_daemon_ask(notifier->daemon, notifier->params.targets, notifier->params.allows_webhooks,
                               &notifier->queue, &is_all, &error);
    notifier->ask_ms = clock_ms(CLOCK_MONOTONIC) + ASK_MS;
    note_daemon(notifier, ok, &error);
}

static void check_commands(struct notifier *notifier)
{
    int64_t now_ms = clock_ms(CLOCK_MONOTONIC);

    for (int i = 0; i < NOTIFY_TARGET_LIMIT; i++)
        if (notifier->commands[i] && notify_command_check(notifier->commands[i], now_ms, on_end, notifier))
            notifier->commands[i] = NULL;
}

static int find_timeout_ms(const struct notifier *notifier)
{
    int64_t now_ms = clock_ms(CLOCK_MONOTONIC), next_ms = notifier->ask_ms;
    int64_t due_ms = notify_queue_due_ms(&notifier->queue);

    if (due_ms >= 0 && due_ms < next_ms) next_ms = due_ms;
    for (int i = 0; i < NOTIFY_TARGET_LIMIT; i++)
        if (notifier->commands[i] && notify_command_deadline_ms(notifier->commands[i]) < next_ms)
            next_ms = notify_command_deadline_ms(notifier->commands[i]);
    if (notify_queue_find_over(&notifier->queue) && !notifier->is_away) return 0;
    return next_ms <= now_ms ? 1 : next_ms - now_ms > ASK_MS ? ASK_MS : (int)(next_ms - now_ms);
}

static void wait_for_more(struct notifier *notifier)
{
    int fds[FD_LIMIT];
    size_t count = 0;

    fds[count++] = notifier->stop_fd;
    for (int i = 0; i < NOTIFY_TARGET_LIMIT; i++) {
        if (!notifier->commands[i]) continue;
        notify_command_list_fds(notifier->commands[i], fds + count);
        count += NOTIFY_COMMAND_FDS;
    }
    notify_posts_wait(notifier->posts, fds, count, find_timeout_ms(notifier));
    check_commands(notifier);
}

static bool is_stopped(const struct notifier *notifier)
{
    struct pollfd polled = {.fd = notifier->stop_fd, .events = POLLIN};

    return poll(&polled, 1, 0) > 0;
}

static void *on_thread(void *user)
{
    struct notifier *notifier = user;
    struct notify_line *line;

    notifier->daemon = notify_daemon_create(notifier->params.socket_path, notifier->stop_fd);
    notifier->posts = notify_posts_create(on_end, notifier);
    while (!is_stopped(notifier)) {
        talk(notifier);
        while ((line = notify_queue_next(&notifier->queue, clock_ms(CLOCK_MONOTONIC))))
            deliver(notifier, line);
        wait_for_more(notifier);
    }
    for (int i = 0; i < NOTIFY_TARGET_LIMIT; i++)
        if (notifier->commands[i]) notify_command_kill(notifier->commands[i]);
    notify_posts_destroy(notifier->posts);
    notify_daemon_destroy(notifier->daemon);
    notify_queue_finish(&notifier->queue);
    return NULL;
}
