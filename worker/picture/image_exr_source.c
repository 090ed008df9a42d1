// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr_source.h"

#include "core/base/error.h"
#include "worker/picture/image.h"

#include <errno.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

static int64_t on_read(exr_const_context_t context, void *user, void *bytes, uint64_t size, uint64_t offset,
                       exr_stream_error_func_ptr_t report)
{
    struct image_exr_source *source = user;
    uint64_t done = 0;

    while (done < size) {
        ssize_t count = pread(source->fd, (char *)bytes + done, size - done, (off_t)(offset + done));

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return -1;
        if (count == 0) break;
        done += (uint64_t)count;
    }
    return (int64_t)done;
}

static int64_t on_query_size(exr_const_context_t context, void *user)
{
    const struct image_exr_source *source = user;
    struct stat status;

    return fstat(source->fd, &status) < 0 ? -1 : (int64_t)status.st_size;
}

// The first message names the cause; later ones only repeat that a call failed.
static void on_library_error(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *user = NULL;
    struct image_exr_source *source;

    if (!context || exr_get_user_data(context, &user) || !user) return;
    source = user;
    pthread_mutex_lock(&source->lock);
    if (!source->message[0]) snprintf(source->message, sizeof source->message, "%s", message);
    pthread_mutex_unlock(&source->lock);
}

bool image_exr_source_fail(struct image_exr_source *source, exr_result_t result, struct error *error)
{
    pthread_mutex_lock(&source->lock);
    error_set(error, "%s", source->message[0] ? source->message : exr_get_default_error_message(result));
    pthread_mutex_unlock(&source->lock);
    return false;
}

bool image_exr_source_open(struct image_exr_source *source, int fd, struct error *error)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_result_t result;

    *source = (struct image_exr_source){.fd = fd};
    pthread_mutex_init(&source->lock, NULL);
    initializer.error_handler_fn = on_library_error;
    initializer.user_data = source;
    initializer.read_fn = on_read;
    initializer.size_fn = on_query_size;
    initializer.max_image_width = IMAGE_SIDE_LIMIT;
    initializer.max_image_height = IMAGE_SIDE_LIMIT;
    initializer.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    result = exr_start_read(&source->context, "file", &initializer);
    return result ? image_exr_source_fail(source, result, error) : true;
}

void image_exr_source_close(struct image_exr_source *source)
{
    exr_finish(&source->context);
    pthread_mutex_destroy(&source->lock);
}
