// SPDX-License-Identifier: Apache-2.0
#include "worker/process/worker.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "worker/answer/request.h"
#include "worker/process/options.h"
#include "worker/process/report.h"

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

void picture_destroy(struct picture *picture)
{
    if (!picture) return;
    image_finish(&picture->image);
    if (picture->folder_fd >= 0) close(picture->folder_fd);
    free(picture);
}

struct picture *worker_make_picture(struct worker *worker, struct assignment_frame *frame, struct error *error)
{
    const struct job *job = &frame->job->job;
    bool has_depth = job->output.has_depth, has_transmittance = job->output.has_transmittance;
    struct picture *picture = xcalloc(1, sizeof *picture);

    picture->frame = frame;
    picture->folder_fd = -1;
    pthread_mutex_lock(&worker->lock);
    picture->image = worker->spare;
    worker->spare = (struct image){0};
    pthread_mutex_unlock(&worker->lock);
    if (image_fits(&picture->image, job->width_px, job->height_px, has_depth, has_transmittance)) return picture;
    image_finish(&picture->image);
    if (image_init(&picture->image, job->width_px, job->height_px, has_depth, has_transmittance, error)) return picture;
    picture_destroy(picture);
    return NULL;
}

void worker_return_picture(struct worker *worker, struct picture *picture)
{
    struct image kept = picture->image;

    pthread_mutex_lock(&worker->lock);
    if (worker->assignment.frames) {
        picture->image = worker->spare;
        worker->spare = kept;
    }
    pthread_mutex_unlock(&worker->lock);
    picture_destroy(picture);
}

bool worker_init(struct worker *worker, const struct options *options)
{
    *worker = (struct worker){.options = options, .sandbox = "none"};
    worker->wake_fd = eventfd(0, EFD_CLOEXEC);
    if (worker->wake_fd < 0) {
        log_error("eventfd: %s", strerrordesc_np(errno));
        return false;
    }
    if (gethostname(worker->host, sizeof worker->host - 1) != 0) worker->host[0] = '\0';
    connection_init(&worker->connection, options->fd);
    pthread_mutex_init(&worker->lock, NULL);
    pthread_cond_init(&worker->changed, NULL);
    return true;
}

void worker_finish(struct worker *worker)
{
    picture_destroy(worker->rendered);
    image_finish(&worker->spare);
    request_destroy_all(worker->requests);
    assignment_finish(&worker->assignment);
    pthread_cond_destroy(&worker->changed);
    pthread_mutex_destroy(&worker->lock);
    connection_finish(&worker->connection);
    close(worker->wake_fd);
}

void worker_advance(struct worker *worker)
{
    atomic_fetch_add_explicit(&worker->progress, 1, memory_order_relaxed);
}

void worker_set_doing(struct worker *worker, const struct report_doing *doing)
{
    pthread_mutex_lock(&worker->lock);
    worker->doing = *doing;
    pthread_mutex_unlock(&worker->lock);
}

void worker_set_ready(struct worker *worker)
{
    pthread_mutex_lock(&worker->lock);
    worker->is_ready = true;
    pthread_mutex_unlock(&worker->lock);
}

void worker_exit(struct worker *worker, int exit_code)
{
    struct assignment_dropped dropped;

    pthread_mutex_lock(&worker->lock);
    worker->is_exiting = true;
    if (exit_code) worker->exit_code = exit_code;
    while (assignment_drop_waiting(&worker->assignment, ASSIGNMENT_ANY_JOB, &dropped))
        report_dropped(&worker->connection, &dropped);
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
}

void worker_abandon(struct worker *worker, int exit_code)
{
    pthread_mutex_lock(&worker->lock);
    worker->is_abandoned = true;
    if (exit_code) worker->exit_code = exit_code;
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
}

bool worker_is_unwanted(struct worker *worker, const struct assignment_frame *frame)
{
    bool is_unwanted;

    pthread_mutex_lock(&worker->lock);
    is_unwanted = worker->is_abandoned || frame->is_unwanted;
    pthread_mutex_unlock(&worker->lock);
    return is_unwanted;
}

void worker_end_frame(struct worker *worker, struct assignment_frame *frame)
{
    struct image unwanted = {0};

    pthread_mutex_lock(&worker->lock);
    assignment_end_frame(&worker->assignment, frame);
    if (!worker->assignment.frames) {
        unwanted = worker->spare;
        worker->spare = (struct image){0};
    }
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
    image_finish(&unwanted);
    worker_advance(worker);
}

void worker_drop_frame(struct worker *worker, struct assignment_frame *frame)
{
    struct assignment_dropped dropped = {frame->job->id, frame->frame, frame->attempt};

    report_dropped(&worker->connection, &dropped);
    worker_end_frame(worker, frame);
}

void worker_end_thread(struct worker *worker)
{
    uint64_t one = 1;

    pthread_mutex_lock(&worker->lock);
    worker->running_threads--;
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
    if (write(worker->wake_fd, &one, sizeof one) < 0) log_error("eventfd: %s", strerrordesc_np(errno));
}
