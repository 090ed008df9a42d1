// SPDX-License-Identifier: Apache-2.0
#include "bench/job_file.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/job/job.h"
#include "core/job/job_json.h"

#include <stdlib.h>

enum { JOB_BYTES = 1 << 20 };

bool job_file_load(struct job *job, const char *path, struct error *error)
{
    size_t length;
    char *text = NULL;
    bool ok = file_read_text(path, JOB_BYTES, &text, &length, error) && job_parse(job, text, length, NULL, error);

    free(text);
    return ok;
}
