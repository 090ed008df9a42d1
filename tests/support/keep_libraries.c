// SPDX-License-Identifier: Apache-2.0
#include "tests/support/keep_libraries.h"

#include <dlfcn.h>
#include <link.h>
#include <stddef.h>

static int keep(struct dl_phdr_info *library, size_t size, void *user)
{
    if (library->dlpi_name[0] != '\0') dlopen(library->dlpi_name, RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
    return 0;
}

void keep_libraries(void)
{
    dl_iterate_phdr(keep, NULL);
}
