// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics/histogram.h"

enum { LARGEST = 1000000000 };

const struct histogram_scale histogram_work_s = {
    {0.01, 0.03, 0.1, 0.3, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1800, 3600, 7200}, 17};
const struct histogram_scale histogram_latency_s = {
    {0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30}, 15};
const struct histogram_scale histogram_wait_s = {
    {0.1, 0.3, 1, 3, 10, 30, 60, 300, 900, 3600, 3 * 3600, 12 * 3600, 24 * 3600, 3 * 24 * 3600, 7 * 24 * 3600}, 15};
const struct histogram_scale histogram_ratio = {
    {0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.2, 1.5, 2, 5, 10}, 17};

void histogram_add(struct histogram *histogram, const struct histogram_scale *scale, double value)
{
    size_t class = 0;

    if (!(value > 0)) value = 0;
    if (value > LARGEST) value = LARGEST;
    while (class < scale->count && value > scale->ends[class])
        class ++;
    histogram->counts[class]++;
    histogram->sum += value;
}
