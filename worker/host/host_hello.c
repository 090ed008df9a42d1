// SPDX-License-Identifier: Apache-2.0
#include "worker/host/host_hello.h"

#include "core/base/error.h"
#include "core/json/json_write.h"
#include "node/memory_share.h"
#include "node/node_line.h"
#include "worker/sandbox/sandbox_landlock.h"

#include <limits.h>
#include <unistd.h>

#include <uv.h>

static void write_landlock(struct json_writer *writer)
{
    struct sandbox_landlock landlock;
    struct error error = {0};

    if (!sandbox_landlock_open(&landlock, &error)) {
        landlock.abi = 0;
        landlock.lack = error.message;
    }
    json_write_integer_member(writer, "landlock", landlock.abi);
    json_write_string_member(writer, "lack", landlock.abi ? NULL : landlock.lack);
    sandbox_landlock_close(&landlock);
}

void host_hello_write(const char *version, struct json_writer *writer)
{
    char name[HOST_NAME_MAX + 1] = "";

    (void)gethostname(name, sizeof name - 1);
    json_write_begin_object(writer);
    json_write_integer_member(writer, "protocol", NODE_PROTOCOL);
    json_write_string_member(writer, "version", version);
    json_write_string_member(writer, "host", name);
    json_write_integer_member(writer, "pid", getpid());
    json_write_integer_member(writer, "uid", (int64_t)geteuid());
    json_write_integer_member(writer, "cores", uv_available_parallelism());
    json_write_integer_member(writer, "memory_bytes", memory_share_find_all());
    write_landlock(writer);
    json_write_end_object(writer);
}
