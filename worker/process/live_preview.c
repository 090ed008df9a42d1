// SPDX-License-Identifier: Apache-2.0
#include "worker/process/live_preview.h"

#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/picture/image.h"
#include "worker/picture/picture_level.h"
#include "worker/sheet/level_png.h"

#include <stddef.h>

static const double PAUSE = 20.0; // after a level, times what showing it took

static void show(struct live_preview *preview, const char *path, const struct picture_level *level)
{
    struct error error = {0};
    bool ok = level_png_write(path, level, &error);

    if (!ok && !preview->has_failed) log_warn("preview: %s: %s", path, error.message);
    preview->has_failed = !ok;
}

void live_preview_show_level(struct live_preview *preview, const char *path, const struct picture_level *level)
{
    double start_s = clock_now_s(), end_s;

    if (!path || atomic_load(&preview->is_final_due) || start_s < preview->next_s) return;
    show(preview, path, level);
    end_s = clock_now_s();
    preview->next_s = end_s + PAUSE * (end_s - start_s);
}

void live_preview_expect_final(struct live_preview *preview, const char *path)
{
    if (path) atomic_store(&preview->is_final_due, true);
}

void live_preview_show_final(struct live_preview *preview, const char *path, const struct image *image)
{
    if (!path) return;
    show(preview, path,
         &(struct picture_level){.rgba = image->rgba,
                                 .stride = 1,
                                 .columns = image->width_px,
                                 .rows = image->height_px,
                                 .width_px = image->width_px,
                                 .height_px = image->height_px});
}

void live_preview_end_final(struct live_preview *preview)
{
    atomic_store(&preview->is_final_due, false);
}
