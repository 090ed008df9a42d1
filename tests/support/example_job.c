#include "tests/support/example_job.h"

#include "core/error.h"
#include "core/file.h"
#include "core/job_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

void example_job_load(struct job *job, const char *name)
{
    char path[512];

    snprintf(path, sizeof path, "%s/jobs/%s.json", PROJECT_ROOT, name);
    example_job_load_file(job, path);
}

void example_job_load_file(struct job *job, const char *path)
{
    struct error error = {{0}};
    char *text = NULL;
    size_t length = 0;
    bool ok;

    ok = file_read_text(path, JOB_DOCUMENT_LIMIT, &text, &length, &error) && job_parse(job, text, length, NULL, &error);
    free(text);
    if (!ok) fail_msg("%s: %s", path, error.message);
}

void example_job_shrink(struct job *job, int width_px, int height_px, double time)
{
    job->width_px = width_px;
    job->height_px = height_px;
    job->time_offset = time;
}
