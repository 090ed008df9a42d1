// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/copies.h"

#include "core/base/error.h"
#include "daemon/service/folders.h"
#include "daemon/settings/options.h"
#include "daemon/store/store_backup.h"

#include <stdio.h>
#include <stdlib.h>

static int end_copy(bool ok, const struct error *error, bool is_backup, const char *folder, const char *file)
{
    if (ok)
        printf("%s the queue in %s %s %s\n", is_backup ? "copied" : "restored", folder, is_backup ? "to" : "from",
               file);
    else
        fprintf(stderr, "marchd: %s\n", error->message);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}

int copies_back_up(const struct options *options)
{
    struct error error = {0};
    bool ok = store_backup_save(options->state_folder, options->backup_file, &error);

    return end_copy(ok, &error, true, options->state_folder, options->backup_file);
}

int copies_restore(const struct options *options)
{
    struct error error = {0};
    bool has_counts = true,
         ok = folders_make(options->state_folder, 0700, &error) &&
              store_backup_restore(options->state_folder, options->restore_file, &has_counts, &error);

    if (!has_counts) printf("the last id that was given is not known here: the next ones begin 1000 higher\n");
    return end_copy(ok, &error, false, options->state_folder, options->restore_file);
}
