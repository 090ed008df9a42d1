// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_maker.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "web/pictures/explanation.h"
#include "web/pictures/picture_cache.h"
#include "web/pictures/picture_child.h"
#include "web/pictures/picture_place.h"
#include "web/pictures/picture_query.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

const char picture_maker_file[] = "made";

bool picture_maker_open(struct picture_maker *maker, struct error *error)
{
    maker->folder_fd = -1;
    if (mkdir(maker->folder, 0700) == 0 || errno == EEXIST)
        maker->folder_fd = open(maker->folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (maker->folder_fd >= 0) {
        picture_maker_sweep(maker);
        return true;
    }
    error_set_errno(error, errno, "%s", maker->folder);
    return false;
}

void picture_maker_close(struct picture_maker *maker)
{
    if (maker->folder_fd < 0) return;
    picture_maker_sweep(maker);
    close(maker->folder_fd);
    maker->folder_fd = -1;
}

// A worker makes no folders: its fence has no right for that.
void picture_maker_sweep(const struct picture_maker *maker)
{
    int fd = openat(maker->folder_fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *entries = fd >= 0 ? fdopendir(fd) : NULL;
    struct dirent *entry;

    while (entries && (entry = readdir(entries)))
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            (void)unlinkat(maker->folder_fd, entry->d_name, 0);
    if (entries)
        closedir(entries);
    else if (fd >= 0)
        close(fd);
}

static void write_path(struct json_writer *writer, const char *key, const char *folder, const char *name)
{
    char path[2 * 4096];

    snprintf(path, sizeof path, "%s%s%s", folder, strcmp(folder, "/") ? "/" : "", name);
    json_write_string_member(writer, key, path);
}

// Of a folder that is itself an input's root, a fence opens only the files that have the input's name.
static void write_fence(struct json_writer *writer, const struct picture_maker *maker,
                        const struct picture_place *place)
{
    message_begin_notification(writer, "worker.fence");
    json_write_begin_object(writer);
    json_write_key(writer, "inputs");
    json_write_begin_array(writer);
    json_write_begin_object(writer);
    json_write_string_member(writer, "place", "the frame");
    json_write_string_member(writer, "root", place->folder);
    json_write_string_member(writer, "folder", "");
    write_path(writer, "path", place->folder, place->name);
    json_write_end_object(writer);
    json_write_end_array(writer);
    json_write_key(writer, "output");
    json_write_begin_object(writer);
    json_write_string_member(writer, "root", maker->folder);
    json_write_string_member(writer, "folder", "");
    json_write_end_object(writer);
    json_write_key(writer, "closed");
    json_write_begin_array(writer);
    json_write_end_array(writer);
    json_write_bool_member(writer, "converter", false);
    json_write_end_object(writer);
    message_end(writer);
}

static void write_request(struct json_writer *writer, const struct picture_maker *maker,
                          const struct picture_place *place, const struct picture_query *query)
{
    bool is_header = query->form == PICTURE_FORM_HEADER;

    message_begin_request(writer, 1, is_header ? "worker.header" : "worker.picture");
    json_write_begin_object(writer);
    write_path(writer, "file", place->folder, place->name);
    if (!is_header) {
        write_path(writer, "out", maker->folder, picture_maker_file);
        picture_query_write(query, writer);
    }
    json_write_end_object(writer);
    message_end(writer);
}

// What the worker says is a stranger's word: numbers are taken from it, one by one.
static void format_facts(const struct message *message, char facts[static PICTURE_MADE_FACTS + 1])
{
    static const char *const keys[] = {"width_px", "height_px", "file_width_px", "file_height_px", "exposure",
                                       "near",     "far"};
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        struct json_node node = json_node_child(&message->body, keys[i]);
        double number;

        if (!json_node_is_absent(&node) && json_read_number(&node, -1e9, 1e9, &number, NULL))
            json_write_number_member(&writer, keys[i], number);
    }
    json_write_end_object(&writer);
    snprintf(facts, PICTURE_MADE_FACTS + 1, "%s", writer.length <= PICTURE_MADE_FACTS ? writer.text : "{}");
    json_writer_finish(&writer);
}

static enum picture_status keep_object(const struct picture_maker *maker, const struct message *message,
                                       struct error *error)
{
    int fd = openat(maker->folder_fd, picture_maker_file, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    char *text;
    bool ok;

    if (fd < 0) {
        error_set_errno(error, errno, "the cache");
        return PICTURE_NO_ROOM;
    }
    text = json_node_format(&message->body);
    ok = file_write_all(fd, text, strlen(text), error);
    free(text);
    close(fd);
    return ok ? PICTURE_READY : PICTURE_NO_ROOM;
}

// True for a PNG; nothing else is said to be one.
static bool is_png(const struct picture_maker *maker)
{
    static const char signature[] = {'\x89', 'P', 'N', 'G', '\r', '\n', '\x1a', '\n'};
    int fd = openat(maker->folder_fd, picture_maker_file, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    char start[sizeof signature];
    bool ok =
        fd >= 0 && read(fd, start, sizeof start) == (ssize_t)sizeof start && !memcmp(start, signature, sizeof start);

    if (fd >= 0) close(fd);
    return ok;
}

static enum picture_status explain(const struct message *message, struct error *error)
{
    struct json_node reason = json_node_child(&message->body, "error"); // of worker.failed: it cannot begin
    const char *text = message->text ? message->text : "the worker gave no answer";

    if (message->kind == MESSAGE_NOTIFICATION) (void)json_read_string(&reason, &text, NULL);
    error_set(error, "%s", text);
    if (message->kind != MESSAGE_ERROR) return PICTURE_FAULT;
    switch (message->code) {
    case MESSAGE_CODE_PARAMS:
        return PICTURE_WRONG;
    case MESSAGE_CODE_STORE:
        return PICTURE_NO_ROOM;
    default:
        return PICTURE_UNREADABLE;
    }
}

static enum picture_status take_answer(const struct picture_maker *maker, const struct picture_query *query,
                                       const char *line, size_t length, char facts[static PICTURE_MADE_FACTS + 1],
                                       struct error *error)
{
    enum picture_status status = PICTURE_FAULT;
    enum message_code code;
    struct message message;

    if (!message_decode(&message, line, length, &code, error)) return status;
    if (message.kind != MESSAGE_RESULT || json_node_type(&message.body) != JSON_OBJECT) {
        status = explain(&message, error);
    } else if (query->form == PICTURE_FORM_HEADER) {
        snprintf(facts, PICTURE_MADE_FACTS + 1, "{}");
        status = keep_object(maker, &message, error);
    } else if (is_png(maker)) {
        format_facts(&message, facts);
        status = PICTURE_READY;
    } else {
        error_set(error, "the worker made no picture");
    }
    message_finish(&message);
    return status;
}

static enum picture_status take_explanation(const struct picture_maker *maker, const char *line, size_t length,
                                            struct error *error)
{
    enum picture_status status = PICTURE_FAULT;
    enum message_code code;
    struct message message;

    if (!message_decode(&message, line, length, &code, error)) return status;
    if (message.kind == MESSAGE_RESULT && json_node_type(&message.body) == JSON_OBJECT)
        status = keep_object(maker, &message, error);
    else
        status = explain(&message, error);
    message_finish(&message);
    return status == PICTURE_WRONG ? PICTURE_UNREADABLE : status; // the job is, and not what was asked
}

// A place among those that have not ended; NULL: there are too many.
static pid_t *find_place(struct picture_maker *maker)
{
    pid_t *place = NULL;

    for (size_t i = 0; i < PICTURE_LEFT_LIMIT; i++) {
        if (maker->left[i] && waitpid(maker->left[i], NULL, WNOHANG) != 0) maker->left[i] = 0;
        if (!maker->left[i]) place = &maker->left[i];
    }
    return place;
}

static enum picture_status ask_child(struct picture_maker *maker, struct picture_child *child,
                                     const struct json_writer *words, struct error *error)
{
    const struct picture_child_params params = {.program = maker->program,
                                                .memory_bytes = maker->memory_bytes,
                                                .file_bytes = PICTURE_BODY_LIMIT,
                                                .limit_ms = maker->limit_ms,
                                                .is_stopped = maker->is_stopped};

    pid_t *left = find_place(maker);
    enum picture_status status;

    if (!left) {
        error_set(error, "a disk holds workers that were killed: ask again later");
        return PICTURE_BUSY;
    }
    status = picture_child_ask(child, &params, words->text, words->length, error);
    *left = child->left;
    return status;
}

enum picture_status picture_maker_run(struct picture_maker *maker, const struct picture_place *place,
                                      const struct picture_query *query, char facts[static PICTURE_MADE_FACTS + 1],
                                      struct error *error)
{
    struct picture_child child = {0};
    struct json_writer words = {0};
    enum picture_status status;
    const char *line;
    size_t length;

    picture_maker_sweep(maker);
    write_fence(&words, maker, place);
    write_request(&words, maker, place, query);
    status = ask_child(maker, &child, &words, error);
    json_writer_finish(&words);
    // The worker has ended: nobody changes what it made any more.
    line = picture_child_answer(&child, &length);
    if (status == PICTURE_READY) status = take_answer(maker, query, line, length, facts, error);
    picture_child_finish(&child);
    return status;
}

enum picture_status picture_maker_explain(struct picture_maker *maker, const struct explanation *explanation,
                                          struct error *error)
{
    enum picture_status status = PICTURE_UNREADABLE;
    struct picture_child child = {0};
    struct json_writer words = {0};

    picture_maker_sweep(maker);
    if (explanation_write(explanation, maker->folder, &words, error)) {
        status = ask_child(maker, &child, &words, error);
        if (status == PICTURE_READY) {
            size_t length;
            const char *line = picture_child_answer(&child, &length);

            status = take_explanation(maker, line, length, error);
        }
        picture_child_finish(&child);
    }
    json_writer_finish(&words);
    return status;
}
