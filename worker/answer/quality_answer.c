// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/quality_answer.h"

#include "core/job/job.h"
#include "core/json/json_write.h"

static void write_number(struct json_writer *writer, const char *key, double number)
{
    if (number > 0.0) json_write_number_member(writer, key, number);
}

static void write_count(struct json_writer *writer, const char *key, int count)
{
    if (count > 0) json_write_integer_member(writer, key, count);
}

void quality_answer_write(struct json_writer *writer, const struct job *job, const struct job_quality *quality)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "method", job_method_name(quality->method));
    write_number(writer, "step", quality->step);
    write_number(writer, "step_voxels", quality->step_voxels);
    write_number(writer, "light_step", quality->light_step);
    write_number(writer, "light_step_voxels", quality->light_step_voxels);
    write_number(writer, "depth_step", quality->depth_step);
    write_count(writer, "order", quality->order);
    write_count(writer, "points", quality->points);
    write_count(writer, "light_grid", quality->light_grid);
    write_count(writer, "density_grid", quality->density_grid);
    write_number(writer, "min_transmittance", quality->min_transmittance);
    json_write_integer_member(writer, "samples", quality->samples);
    if (job->scene.object_count > 0) {
        json_write_integer_member(writer, "max_depth", quality->max_depth);
        json_write_number_member(writer, "min_throughput", quality->min_throughput);
    }
    json_write_end_object(writer);
}
