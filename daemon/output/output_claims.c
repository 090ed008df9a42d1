// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/output_claims.h"

#include "daemon/farm/farm.h"

#include <string.h>

void output_claims_add(struct farm *farm, struct output_claim *claim)
{
    claim->next = farm->claims;
    farm->claims = claim;
}

void output_claims_remove(struct farm *farm, const struct output_claim *claim)
{
    struct output_claim **link = &farm->claims;

    while (*link != claim)
        link = &(*link)->next;
    *link = claim->next;
}

static bool share_folder(const struct job_files *a, const struct job_files *b)
{
    return strcmp(a->root, b->root) == 0 && strcmp(a->path->folder, b->path->folder) == 0;
}

bool output_claims_use_folder(const struct farm *farm, const struct job_files *files)
{
    for (const struct output_claim *claim = farm->claims; claim; claim = claim->next)
        if (!claim->removed && share_folder(&claim->files, files)) return true;
    return false;
}

const char *output_claims_find_collision(const struct farm *farm, const struct job_files *files, int32_t *frame)
{
    for (const struct output_claim *claim = farm->claims; claim; claim = claim->next)
        if (!claim->removed && job_files_collide(files, &claim->files, frame)) return claim->name;
    return NULL;
}

const struct job_record *output_claims_find_removal(const struct farm *farm, const struct job_files *files)
{
    for (const struct output_claim *claim = farm->claims; claim; claim = claim->next)
        if (claim->removed && share_folder(&claim->files, files)) return claim->removed;
    return NULL;
}
