// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_document.h"

#include "cli/job/job_inputs.h"
#include "cli/job/json_set.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/job/job.h"
#include "core/job/job_check.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *job_document_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "standard input" : path;
}

static char *read_standard_input(size_t *length, struct error *error)
{
    size_t capacity = 0, count;
    char *text = NULL;

    *length = 0;
    do {
        text = xgrow(text, &capacity, *length + 4096, 1);
        count = fread(text + *length, 1, capacity - *length - 1, stdin);
        *length += count;
        if (*length > JOB_DOCUMENT_LIMIT) {
            error_set(error, "standard input: over %d bytes, which is the most a job may have", JOB_DOCUMENT_LIMIT);
            free(text);
            return NULL;
        }
    } while (count > 0);
    text[*length] = 0;
    return text;
}

static char *read_document(const char *path, struct error *error)
{
    size_t length = 0;
    char *text = NULL;

    if (strcmp(path, "-") == 0)
        text = read_standard_input(&length, error);
    else if (!file_read_text(path, JOB_DOCUMENT_LIMIT, &text, &length, error))
        error_prefix(error, "%s", path);
    if (text && strlen(text) != length) {
        error_set(error, "%s: expected JSON, got a NUL byte at offset %zu", job_document_name(path), strlen(text));
        free(text);
        return NULL;
    }
    return text;
}

static char *load_compact(const char *path, struct error *error)
{
    char *text = read_document(path, error), *compact = NULL;
    struct cJSON *root = NULL;
    struct json_node node;

    if (!text) return NULL;
    if (json_parse(&root, text, strlen(text), error)) {
        node = json_node_root(root);
        compact = json_node_format(&node);
    } else {
        error_prefix(error, "%s", job_document_name(path));
    }
    json_delete(root);
    free(text);
    return compact;
}

char *job_document_load(const char *path, const char *const sets[], size_t set_count, struct error *error)
{
    char *document = load_compact(path, error);

    for (size_t i = 0; document && i < set_count; i++) {
        struct error local = {0};
        char *edited = json_set(document, sets[i], &local);

        if (!edited) error_set(error, "%s: --set %s", job_document_name(path), local.message);
        free(document);
        document = edited;
    }
    if (document && !job_inputs_resolve(&document, path, error)) {
        error_prefix(error, "%s", job_document_name(path));
        free(document);
        return NULL;
    }
    return document;
}

bool job_document_check(const char *path, const char *document, const char *output_root, struct job *job,
                        struct error *error)
{
    if (job_parse(job, document, strlen(document), output_root, error)) {
        if (job_check_names(job, error) && job_inputs_check(job, error)) return true;
        job_finish(job);
    }
    error_prefix(error, "%s", job_document_name(path));
    return false;
}
