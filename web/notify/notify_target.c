// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_target.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_notify.h"
#include "core/settings/option_words.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void finish_target(struct notify_target *target)
{
    free(target->name);
    free(target->url);
    free(target->secret_file);
    for (size_t i = 0; target->arguments[i]; i++)
        free(target->arguments[i]);
}

void notify_targets_finish(struct notify_targets *targets)
{
    for (size_t i = 0; i < targets->count; i++)
        finish_target(&targets->targets[i]);
    free(targets->targets);
    *targets = (struct notify_targets){0};
}

const struct notify_target *notify_targets_find(const struct notify_targets *targets, const char *name)
{
    for (size_t i = 0; i < targets->count; i++)
        if (strcmp(targets->targets[i].name, name) == 0) return &targets->targets[i];
    return NULL;
}

static const char *value_of(const char *word, const char *key)
{
    size_t length = strlen(key);

    return strncmp(word, key, length) == 0 && word[length] == '=' ? word + length + 1 : NULL;
}

static bool read_url_word(struct notify_target *target, const char *word, struct error *error)
{
    const char *secret = value_of(word, "secret"), *private = value_of(word, "private");

    if (secret && *secret == '/' && !target->secret_file) {
        target->secret_file = xstrdup(secret);
        return true;
    }
    target->may_be_private = private && strcmp(private, "yes") == 0;
    if (target->may_be_private || (private && strcmp(private, "no") == 0)) return true;
    error_set(error, "expected secret=/FILE or private=yes after the url, got \"%.100s\"", word);
    return false;
}

static bool read_url(struct notify_target *target, const char *url, char **words, size_t count, struct error *error)
{
    if (!job_notify_is_webhook(url)) {
        error_set(error, "url: expected an address like https://HOST/PATH, got \"%.100s\"", url);
        return false;
    }
    target->url = xstrdup(url);
    for (size_t i = 0; i < count; i++)
        if (!read_url_word(target, words[i], error)) return false;
    return true;
}

static bool read_command(struct notify_target *target, const char *program, char **words, size_t count,
                         struct error *error)
{
    if (*program != '/') {
        error_set(error, "command: expected an absolute path, got \"%.100s\"", program);
        return false;
    }
    if (count + 1 > NOTIFY_ARGUMENT_LIMIT) {
        error_set(error, "command: expected at most %d words", NOTIFY_ARGUMENT_LIMIT);
        return false;
    }
    target->arguments[0] = xstrdup(program);
    for (size_t i = 0; i < count; i++)
        target->arguments[i + 1] = xstrdup(words[i]);
    return true;
}

static bool read_target(struct notify_target *target, char **words, size_t count, struct error *error)
{
    const char *url = count > 1 ? value_of(words[1], "url") : NULL;
    const char *program = count > 1 ? value_of(words[1], "command") : NULL;

    if (count == 0 || !job_notify_is_name(words[0])) {
        error_set(error, "expected a name of letters, digits and -._ first");
        return false;
    }
    target->name = xstrdup(words[0]);
    if (url) return read_url(target, url, words + 2, count - 2, error);
    if (program) return read_command(target, program, words + 2, count - 2, error);
    error_set(error, "%s: expected url=URL or command=PROGRAM after the name", words[0]);
    return false;
}

static bool check_place(const struct notify_targets *targets, const struct notify_target *target, struct error *error)
{
    if (notify_targets_find(targets, target->name)) {
        error_set(error, "%s: the name is there twice", target->name);
        return false;
    }
    if (targets->count < NOTIFY_TARGET_LIMIT) return true;
    error_set(error, "expected at most %d targets", NOTIFY_TARGET_LIMIT);
    return false;
}

bool notify_targets_add(struct notify_targets *targets, const char *text, struct error *error)
{
    struct option_words words = {0};
    struct notify_target target = {0};
    bool ok = option_words_split(&words, text, error) && read_target(&target, words.words, words.count, error) &&
              check_place(targets, &target, error);

    option_words_free(words.words);
    if (!ok) {
        finish_target(&target);
        error_prefix(error, "--notify-target");
        return false;
    }
    targets->targets = xgrow(targets->targets, &targets->capacity, targets->count + 1, sizeof target);
    targets->targets[targets->count++] = target;
    return true;
}

static bool check_secret(int fd, size_t *size_bytes, struct error *error)
{
    struct stat status;

    if (fstat(fd, &status) != 0) {
        error_set_errno(error, errno, "cannot look at it");
    } else if (!S_ISREG(status.st_mode)) {
        error_set(error, "expected a plain file");
    } else if (status.st_mode & (S_IWGRP | S_IRWXO)) {
        error_set(error, "mode %04o: expected one that lets only its owner write it, and no stranger read it, as 0640",
                  (unsigned)(status.st_mode & 07777));
    } else if (status.st_size < 1 || status.st_size > NOTIFY_SECRET_LIMIT) {
        error_set(error, "expected 1 to %d bytes, got %lld", NOTIFY_SECRET_LIMIT, (long long)status.st_size);
    } else {
        *size_bytes = (size_t)status.st_size;
        return true;
    }
    return false;
}

bool notify_secret_load(const char *path, char **secret, size_t *size_bytes, struct error *error)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    char *text = NULL;
    bool ok = false;

    if (fd < 0) {
        error_set_errno(error, errno, "cannot open it");
        goto out;
    }
    if (!check_secret(fd, size_bytes, error)) goto out;
    text = xcalloc(*size_bytes + 1, 1);
    ok = read(fd, text, *size_bytes) == (ssize_t)*size_bytes;
    if (!ok) error_set(error, "cannot read all of it");
    if (ok && text[*size_bytes - 1] == '\n') text[--*size_bytes] = '\0';
    if (ok && *size_bytes == 0) {
        error_set(error, "expected more than a line feed");
        ok = false;
    }
out:
    if (fd >= 0) close(fd);
    if (!ok) {
        free(text);
        error_prefix(error, "secret %s", path);
        return false;
    }
    *secret = text;
    return true;
}
