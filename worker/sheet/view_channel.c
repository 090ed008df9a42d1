// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/view_channel.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/picture/image_exr.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN_NAMES_BYTES = 256 };

static bool has_all(const struct image_exr_names *names, char *const wanted[], int count)
{
    for (int i = 0; i < count; i++)
        if (!image_exr_names_have(names, wanted[i])) return false;
    return true;
}

static void refuse(const struct image_exr_names *names, const char *name, struct error *error)
{
    char known[SHOWN_NAMES_BYTES] = "color";
    size_t length = strlen(known);

    for (size_t i = 0; i < names->count && length < sizeof known; i++)
        length += (size_t)snprintf(known + length, sizeof known - length, ", %s", names->names[i]);
    error_set(error, "channel: expected one of %s%s, got \"%.64s\"", known, length < sizeof known ? "" : "...", name);
}

bool view_channel_find(struct view_channel *channel, int fd, const char *name, struct error *error)
{
    static const char *const ends[] = {".R", ".G", ".B"}, *const colour[] = {"R", "G", "B"};
    bool is_colour = !name || !strcmp(name, "color");
    struct image_exr_names names;
    bool ok;

    *channel = (struct view_channel){0};
    if (!image_exr_names_read(fd, &names, error)) return false;
    if (!is_colour && image_exr_names_have(&names, name)) {
        channel->names[0] = xstrdup(name);
        channel->kind = strcmp(name, "Z") == 0 ? VIEW_DEPTH : VIEW_GREY;
        channel->is_light = strcmp(name, "A") != 0 && strcmp(name, "Z") != 0;
        image_exr_names_finish(&names);
        return true;
    }
    for (int i = 0; i < 3; i++)
        channel->names[i] = is_colour ? xstrdup(colour[i]) : xasprintf("%s%s", name, ends[i]);
    channel->is_light = is_colour || strcmp(name, "transmittance") != 0;
    ok = has_all(&names, channel->names, 3);
    if (!ok) refuse(&names, name, error);
    image_exr_names_finish(&names);
    return ok;
}

void view_channel_finish(struct view_channel *channel)
{
    for (int i = 0; i < 3; i++)
        free(channel->names[i]);
    *channel = (struct view_channel){0};
}
