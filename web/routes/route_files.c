// SPDX-License-Identifier: Apache-2.0
#include "web/routes/route_files.h"

#include "core/base/alloc.h"
#include "core/base/hash.h"
#include "core/base/log.h"
#include "web/http/http_request.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIZE_LIMIT = 4 * 1024 * 1024 };

static const char *type_of(const char *name)
{
    static const char *const types[][2] = {{".html", "text/html; charset=utf-8"},
                                           {".js", "text/javascript; charset=utf-8"},
                                           {".css", "text/css; charset=utf-8"},
                                           {".json", "application/json"},
                                           {".svg", "image/svg+xml"},
                                           {".png", "image/png"}};
    const char *suffix = strrchr(name, '.');

    for (size_t i = 0; suffix && i < sizeof types / sizeof types[0]; i++)
        if (strcmp(types[i][0], suffix) == 0) return types[i][1];
    return NULL;
}

// One file's name: no folder, nothing hidden.
static bool is_plain_name(const char *name)
{
    if (!isalnum((unsigned char)name[0])) return false;
    for (; *name; name++)
        if (!isalnum((unsigned char)*name) && !strchr("-_.", *name)) return false;
    return true;
}

// False: it is no file of a size that can be meant.
static bool hash_plain(int fd, char etag[static HASH_TEXT_SIZE], uint64_t *size_bytes)
{
    struct stat status;

    if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size > SIZE_LIMIT) return false;
    return hash_file(fd, etag, size_bytes, NULL);
}

static void answer_file(struct http_request *request, const char *path, const char *type)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    char etag[HASH_TEXT_SIZE];
    uint64_t size_bytes;

    if (fd < 0 && errno != ENOENT) log_warn("%s: %s", path, strerror(errno));
    if (fd < 0 || !hash_plain(fd, etag, &size_bytes)) {
        if (fd >= 0) close(fd);
        http_request_fail(request, 404, "there is no such file");
        return;
    }
    http_request_answer(request, &(struct http_answer){.type = type,
                                                       .has_file = true,
                                                       .file_fd = fd,
                                                       .size_bytes = (size_t)size_bytes,
                                                       .etag = etag,
                                                       .cache = "no-cache"});
}

static void answer_name(struct http_request *request, const char *folder, const char *name)
{
    const char *type = is_plain_name(name) ? type_of(name) : NULL;
    char *path;

    if (!type) {
        http_request_fail(request, 404, "there is no such file");
        return;
    }
    path = xasprintf("%s/%s", folder, name);
    answer_file(request, path, type);
    free(path);
}

void route_files_front(struct http_request *request, void *user)
{
    answer_name(request, ((const struct route_files *)user)->page_folder, "index.html");
}

void route_files_page(struct http_request *request, void *user)
{
    answer_name(request, ((const struct route_files *)user)->page_folder,
                http_request_path(request) + strlen("/page/"));
}

void route_files_chart(struct http_request *request, void *user)
{
    answer_file(request, ((const struct route_files *)user)->chart_file, type_of(".js"));
}

void route_files_document(struct http_request *request, void *user)
{
    answer_name(request, ((const struct route_files *)user)->document_folder, http_request_path(request) + 1);
}
