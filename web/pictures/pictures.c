// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/pictures.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/path_list.h"
#include "web/pictures/explanation.h"
#include "web/pictures/picture_faults.h"
#include "web/pictures/picture_maker.h"
#include "web/pictures/picture_place.h"
#include "web/pictures/picture_query.h"
#include "web/pictures/picture_queue.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// What a question goes through: `asked` until the finder took it, then in the queue's hands, then `answered`.
struct picture_ask {
    struct picture_waiter waiter;
    struct picture_query query;
    char *subject, *known; // owned
    struct path_list roots;
    void *user;
    struct picture_place place;
    struct picture_file file;
    enum picture_status status;
    struct error error;
    bool is_looked_up, is_answered, is_dropped;
    struct picture_ask *next; // in `asked` or `answered`
};

struct ask_list {
    struct picture_ask *first, **end;
};

struct pictures {
    void (*on_answers)(void *user);
    void *user;
    char *worker; // owned
    struct picture_cache cache;
    struct picture_maker makers[PICTURE_MAKER_LIMIT];
    char *folders[PICTURE_MAKER_LIMIT]; // owned
    size_t maker_count, started;
    pthread_t finder, threads[PICTURE_MAKER_LIMIT];
    atomic_bool is_stopped;

    pthread_mutex_t lock; // guards what follows
    pthread_cond_t asked_changed, queue_changed;
    struct ask_list asked, answered;
    size_t ask_count; // not answered
    struct picture_queue queue;
    struct picture_faults faults;
};

struct maker_thread {
    struct pictures *pictures;
    const struct picture_maker *maker;
};

static const struct error too_many = {.message = "too many pictures are asked for: ask again in a moment"};

static int64_t now_ms(void)
{
    return (int64_t)(1000.0 * clock_now_s());
}

static void list_init(struct ask_list *list)
{
    list->first = NULL;
    list->end = &list->first;
}

static void list_add(struct ask_list *list, struct picture_ask *ask)
{
    ask->next = NULL;
    *list->end = ask;
    list->end = &ask->next;
}

static struct picture_ask *list_take(struct ask_list *list)
{
    struct picture_ask *ask = list->first;

    if (!ask) return NULL;
    list->first = ask->next;
    if (!list->first) list->end = &list->first;
    return ask;
}

static void list_remove(struct ask_list *list, struct picture_ask *ask)
{
    struct picture_ask **link = &list->first;

    while (*link && *link != ask)
        link = &(*link)->next;
    if (!*link) return;
    *link = ask->next;
    if (!*link) list->end = link;
}

void picture_ask_free(struct picture_ask *ask)
{
    free(ask->subject);
    free(ask->known);
    path_list_finish(&ask->roots);
    picture_place_finish(&ask->place);
    picture_file_close(&ask->file);
    free(ask);
}

static struct picture_ask *ask_of(struct picture_waiter *waiter)
{
    return (struct picture_ask *)((char *)waiter - offsetof(struct picture_ask, waiter));
}

// With the lock. The caller wakes the loop afterwards.
static void give(struct pictures *pictures, struct picture_ask *ask, enum picture_status status,
                 const struct error *error)
{
    pictures->ask_count--;
    ask->status = status;
    ask->is_answered = true;
    if (error) ask->error = *error;
    list_add(&pictures->answered, ask);
}

// Likewise, of a question that may have been dropped meanwhile.
static void answer(struct pictures *pictures, struct picture_ask *ask, enum picture_status status,
                   const struct error *error)
{
    if (!ask->is_dropped) {
        give(pictures, ask, status, error);
        return;
    }
    pictures->ask_count--;
    picture_ask_free(ask);
}

static struct explanation explanation_of(const struct pictures *pictures, const struct picture_ask *ask)
{
    return (struct explanation){.document = ask->subject, .worker = pictures->worker, .roots = &ask->roots};
}

static enum picture_status find_version(const struct pictures *pictures, const struct picture_ask *ask,
                                        struct picture_place *place, char key[static HASH_TEXT_SIZE],
                                        struct error *error)
{
    struct explanation explanation = explanation_of(pictures, ask);
    enum picture_status status;

    if (ask->query.form == PICTURE_FORM_EXPLANATION) return explanation_make_key(&explanation, key, error);
    status = picture_place_find(place, &ask->roots, ask->subject, error);
    if (status == PICTURE_READY) picture_place_make_key(place, &ask->query, key);
    return status;
}

// Finds the file's version, and its picture if there is one. PICTURE_BUSY: it has to be made.
static enum picture_status look_up(struct pictures *pictures, struct picture_ask *ask, struct error *error)
{
    enum picture_status status = find_version(pictures, ask, &ask->place, ask->waiter.key, error);

    if (status != PICTURE_READY) return status;
    if (ask->known && strstr(ask->known, ask->waiter.key)) return PICTURE_KNOWN;
    return picture_cache_find(&pictures->cache, ask->waiter.key, &ask->file) ? PICTURE_READY : PICTURE_BUSY;
}

// With the lock.
static void enqueue(struct pictures *pictures, struct picture_ask *ask)
{
    const struct picture_fault *fault = picture_faults_find(&pictures->faults, ask->waiter.key, now_ms());
    bool is_new;

    if (fault)
        answer(pictures, ask, fault->status, &fault->error);
    else if (ask->is_dropped || !picture_queue_add(&pictures->queue, &ask->waiter, &is_new))
        answer(pictures, ask, PICTURE_BUSY, &too_many);
    else if (is_new)
        pthread_cond_signal(&pictures->queue_changed);
}

static void *run_finder(void *user)
{
    struct pictures *pictures = user;

    pthread_mutex_lock(&pictures->lock);
    while (!atomic_load(&pictures->is_stopped)) {
        struct picture_ask *ask = list_take(&pictures->asked);
        struct error error = {0};
        enum picture_status status;

        if (!ask) {
            pthread_cond_wait(&pictures->asked_changed, &pictures->lock);
            continue;
        }
        ask->is_looked_up = true;
        pthread_mutex_unlock(&pictures->lock);
        status = look_up(pictures, ask, &error);
        pthread_mutex_lock(&pictures->lock);
        if (status == PICTURE_BUSY)
            enqueue(pictures, ask);
        else
            answer(pictures, ask, status, &error);
        pictures->on_answers(pictures->user);
    }
    pthread_mutex_unlock(&pictures->lock);
    return NULL;
}

// A file that was replaced meanwhile may have given a picture of either version.
static bool is_same_version(const struct pictures *pictures, const struct picture_ask *ask, struct error *error)
{
    char key[HASH_TEXT_SIZE] = "";
    struct picture_place place = {0};

    find_version(pictures, ask, &place, key, error);
    picture_place_finish(&place);
    if (!strcmp(key, ask->waiter.key)) return true;
    error_set(error, "a file was replaced meanwhile: ask again");
    return false;
}

static enum picture_status make(struct pictures *pictures, const struct picture_maker *maker,
                                const struct picture_ask *model, struct picture_file *file, struct error *error)
{
    struct explanation explanation = explanation_of(pictures, model);
    char facts[PICTURE_MADE_FACTS + 1] = "{}";
    enum picture_status status;

    if (model->query.form == PICTURE_FORM_EXPLANATION)
        status = picture_maker_explain(maker, &explanation, error);
    else
        status = picture_maker_run(maker, &model->place, &model->query, facts, error);
    if (status != PICTURE_READY) return status;
    if (!is_same_version(pictures, model, error)) return PICTURE_BUSY;
    if (picture_cache_take(&pictures->cache, model->waiter.key, facts, maker->folder_fd, picture_maker_file, file,
                           error))
        return PICTURE_READY;
    return PICTURE_NO_ROOM;
}

// With the lock. Each gets a descriptor of its own.
static void answer_all(struct pictures *pictures, struct picture_waiter *waiters, enum picture_status status,
                       struct picture_file *file, const struct error *error)
{
    while (waiters) {
        struct picture_ask *ask = ask_of(waiters);

        waiters = waiters->next;
        if (status == PICTURE_READY) {
            ask->file = *file;
            ask->file.fd = fcntl(file->fd, F_DUPFD_CLOEXEC, 0);
        }
        answer(pictures, ask, status == PICTURE_READY && ask->file.fd < 0 ? PICTURE_FAULT : status, error);
    }
    picture_file_close(file);
}

// What a task's first waiter asked for, as others may give up while it is made.
static struct picture_ask *copy_model(const struct picture_task *task)
{
    const struct picture_ask *ask = ask_of(task->waiters);
    struct picture_ask *model = xcalloc(1, sizeof *model);

    *model = (struct picture_ask){.waiter.user = ask->waiter.user,
                                  .query = ask->query,
                                  .subject = xstrdup(ask->subject),
                                  .place = ask->place,
                                  .file.fd = -1};
    memcpy(model->waiter.key, ask->waiter.key, sizeof model->waiter.key);
    if (ask->place.folder) model->place.folder = xstrdup(ask->place.folder);
    if (ask->place.name) model->place.name = xstrdup(ask->place.name);
    for (size_t i = 0; i < ask->roots.count; i++)
        path_list_add(&model->roots, xstrdup(ask->roots.paths[i]));
    return model;
}

static void *run_maker(void *user)
{
    struct maker_thread own = *(struct maker_thread *)user;
    struct pictures *pictures = own.pictures;

    free(user);
    pthread_mutex_lock(&pictures->lock);
    while (!atomic_load(&pictures->is_stopped)) {
        struct picture_task *task = picture_queue_take(&pictures->queue);
        struct picture_file file = {.fd = -1};
        struct error error = {0};
        struct picture_ask *model;
        enum picture_status status;

        if (!task) {
            pthread_cond_wait(&pictures->queue_changed, &pictures->lock);
            continue;
        }
        model = copy_model(task);
        pthread_mutex_unlock(&pictures->lock);
        status = make(pictures, own.maker, model, &file, &error);
        pthread_mutex_lock(&pictures->lock);
        if (status != PICTURE_READY)
            picture_faults_note(&pictures->faults, model->waiter.key, status, &error, now_ms());
        answer_all(pictures, picture_queue_end(&pictures->queue, task), status, &file, &error);
        picture_ask_free(model);
        pictures->on_answers(pictures->user);
    }
    pthread_mutex_unlock(&pictures->lock);
    return NULL;
}

static bool start_thread(pthread_t *thread, void *(*run)(void *), void *user, struct error *error)
{
    int cause = pthread_create(thread, NULL, run, user);

    if (cause) error_set_errno(error, cause, "no thread for pictures");
    return cause == 0;
}

// Signals are the loop's matter.
static bool start_threads(struct pictures *pictures, struct error *error)
{
    sigset_t all, before;
    bool ok;

    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    ok = start_thread(&pictures->finder, run_finder, pictures, error);
    while (ok && pictures->started < pictures->maker_count) {
        struct maker_thread *own = xcalloc(1, sizeof *own);

        *own = (struct maker_thread){pictures, &pictures->makers[pictures->started]};
        ok = start_thread(&pictures->threads[pictures->started], run_maker, own, error);
        if (ok)
            pictures->started++;
        else
            free(own);
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return ok;
}

static bool open_makers(struct pictures *pictures, const struct pictures_params *params, struct error *error)
{
    for (int i = 0; i < params->maker_count && i < PICTURE_MAKER_LIMIT; i++) {
        struct picture_maker *maker = &pictures->makers[i];

        pictures->folders[i] = xasprintf("%s/work-%d", params->cache_folder, i);
        *maker = (struct picture_maker){.program = pictures->worker,
                                        .folder = pictures->folders[i],
                                        .is_stopped = &pictures->is_stopped,
                                        .memory_bytes = params->worker_bytes,
                                        .limit_ms = params->limit_ms};
        if (!picture_maker_open(maker, error)) return false;
        pictures->maker_count++;
    }
    return true;
}

struct pictures *pictures_create(const struct pictures_params *params, struct error *error)
{
    struct pictures *pictures = xcalloc(1, sizeof *pictures);

    if (!picture_cache_open(&pictures->cache, params->cache_folder, params->cache_bytes, error)) {
        free(pictures);
        return NULL;
    }
    pictures->on_answers = params->on_answers;
    pictures->user = params->user;
    pictures->worker = xstrdup(params->worker);
    pthread_mutex_init(&pictures->lock, NULL);
    pthread_cond_init(&pictures->asked_changed, NULL);
    pthread_cond_init(&pictures->queue_changed, NULL);
    list_init(&pictures->asked);
    list_init(&pictures->answered);
    if (open_makers(pictures, params, error) && start_threads(pictures, error)) return pictures;
    pictures_destroy(pictures);
    return NULL;
}

static void stop_threads(struct pictures *pictures)
{
    pthread_mutex_lock(&pictures->lock);
    atomic_store(&pictures->is_stopped, true);
    pthread_cond_broadcast(&pictures->asked_changed);
    pthread_cond_broadcast(&pictures->queue_changed);
    pthread_mutex_unlock(&pictures->lock);
    if (pictures->finder) pthread_join(pictures->finder, NULL);
    for (size_t i = 0; i < pictures->started; i++)
        pthread_join(pictures->threads[i], NULL);
}

static void free_waiting(struct pictures *pictures)
{
    struct picture_task *task;
    struct picture_ask *ask;

    while ((task = picture_queue_take(&pictures->queue))) {
        struct picture_waiter *waiter = picture_queue_end(&pictures->queue, task);

        while (waiter) {
            struct picture_waiter *next = waiter->next;

            picture_ask_free(ask_of(waiter));
            waiter = next;
        }
    }
    while ((ask = list_take(&pictures->asked)))
        picture_ask_free(ask);
    while ((ask = list_take(&pictures->answered)))
        picture_ask_free(ask);
}

void pictures_destroy(struct pictures *pictures)
{
    stop_threads(pictures);
    free_waiting(pictures);
    for (size_t i = 0; i < pictures->maker_count; i++)
        picture_maker_close(&pictures->makers[i]);
    for (size_t i = 0; i < PICTURE_MAKER_LIMIT; i++)
        free(pictures->folders[i]);
    picture_cache_close(&pictures->cache);
    pthread_cond_destroy(&pictures->queue_changed);
    pthread_cond_destroy(&pictures->asked_changed);
    pthread_mutex_destroy(&pictures->lock);
    free(pictures->worker);
    free(pictures);
}

struct picture_ask *pictures_ask(struct pictures *pictures, const struct picture_question *question, void *user)
{
    struct picture_ask *ask = xcalloc(1, sizeof *ask);

    *ask = (struct picture_ask){.waiter.user = question->user, .query = *question->query, .user = user, .file.fd = -1};
    ask->subject = xstrdup(question->subject);
    ask->known = question->known ? xstrdup(question->known) : NULL;
    for (size_t i = 0; i < question->roots->count; i++)
        path_list_add(&ask->roots, xstrdup(question->roots->paths[i]));
    pthread_mutex_lock(&pictures->lock);
    pictures->ask_count++;
    if (pictures->ask_count > 2 * PICTURE_WAIT_LIMIT) {
        give(pictures, ask, PICTURE_BUSY, &too_many);
        pictures->on_answers(pictures->user);
    } else {
        list_add(&pictures->asked, ask);
        pthread_cond_signal(&pictures->asked_changed);
    }
    pthread_mutex_unlock(&pictures->lock);
    return ask;
}

void pictures_drop(struct pictures *pictures, struct picture_ask *ask)
{
    bool is_free = true;

    pthread_mutex_lock(&pictures->lock);
    if (ask->is_answered) {
        list_remove(&pictures->answered, ask);
    } else if (!ask->is_looked_up) {
        list_remove(&pictures->asked, ask);
        pictures->ask_count--;
    } else if (ask->waiter.task) {
        picture_queue_drop(&pictures->queue, &ask->waiter);
        pictures->ask_count--;
    } else {
        ask->is_dropped = true; // the finder has it, and frees it
        is_free = false;
    }
    pthread_mutex_unlock(&pictures->lock);
    if (is_free) picture_ask_free(ask);
}

struct picture_ask *pictures_take_answer(struct pictures *pictures)
{
    struct picture_ask *ask;

    pthread_mutex_lock(&pictures->lock);
    ask = list_take(&pictures->answered);
    pthread_mutex_unlock(&pictures->lock);
    return ask;
}

struct picture_answer picture_ask_answer(struct picture_ask *ask)
{
    struct picture_answer answer = {.status = ask->status, .file = &ask->file};

    memcpy(answer.key, ask->waiter.key, sizeof answer.key);
    if (ask->status != PICTURE_READY && ask->status != PICTURE_KNOWN) answer.reason = ask->error.message;
    return answer;
}

void *picture_ask_user(const struct picture_ask *ask)
{
    return ask->user;
}
