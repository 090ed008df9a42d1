// SPDX-License-Identifier: Apache-2.0
#include "tests/support/test_program.h"

#include <stdio.h>
#include <string.h>

int main(int argc, char *argv[])
{
    const char *slash = strrchr(argv[0], '/'), *name = slash ? slash + 1 : argv[0];

    for (size_t i = 0; i < test_program_count; i++) {
        const struct test_program *program = &test_programs[i];

        if (strcmp(program->name, name) != 0) continue;
        return program->run ? program->run() : program->run_with(argc, argv);
    }
    fprintf(stderr, "%s: the link by which this is called names a test: there is none of this name\n", name);
    return 2;
}
