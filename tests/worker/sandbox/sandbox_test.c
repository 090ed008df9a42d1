// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox.h"

#include "core/base/error.h"
#include "tests/support/fence_places.h"
#include "tests/support/temp_folder.h"
#include "worker/sandbox/sandbox_folders.h"
#include "worker/sandbox/sandbox_landlock.h"
#include "worker/sandbox/sanitizer.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static int use_own_files(void)
{
    if (!fence_places_can_open(fence_places_at("in/ann/a.raw"), O_RDONLY)) return 1;
    if (!fence_places_can_open(fence_places_at("in/ann/b.raw"), O_RDONLY))
        return 2; // beside it: the voxels of a header
    if (!fence_places_can_open(fence_places_at("out/ann/x.part"), O_RDWR | O_CREAT | O_EXCL)) return 3;
    if (!fence_places_can_open(fence_places_at("out/ann/x.part"), O_RDONLY)) return 4;
    if (unlink(fence_places_at("out/ann/x.part")) != 0) return 5;
    if (!fence_places_can_open("/dev/null", O_RDWR)) return 6;
    if (!fence_places_can_open("/proc/self/statm", O_RDONLY)) return 7;
    if (!fence_places_can_open("/etc/ld.so.cache", O_RDONLY)) return 8;
    return 0;
}

static void own_files_are_there(void **state)
{
    fence_places_run(fence_places_job("ann", "a.raw", "ann"), use_own_files);
}

static int reach_for_files(void)
{
    char parent[64];

    snprintf(parent, sizeof parent, "/proc/%d/environ", (int)getppid());
    if (fence_places_can_open(fence_places_at("state/store"), O_RDONLY)) return 1;
    if (fence_places_can_open(fence_places_at("in/bob/b.raw"), O_RDONLY)) return 2;
    if (fence_places_can_open(fence_places_at("in/top.raw"), O_RDONLY)) return 3;
    if (fence_places_can_open(fence_places_at("out/bob/b.exr"), O_RDONLY)) return 4;
    if (fence_places_can_open(fence_places_at("out/bob/b.exr"), O_WRONLY)) return 5;
    if (unlink(fence_places_at("out/bob/b.exr")) == 0) return 6;
    if (fence_places_can_open(fence_places_at("in/ann/a.raw"), O_WRONLY)) return 7;
    if (truncate(fence_places_at("in/ann/a.raw"), 0) == 0) return 8;
    if (unlink(fence_places_at("in/ann/a.raw")) == 0) return 9;
    if (fence_places_can_open(fence_places_at("in/ann/new"), O_WRONLY | O_CREAT)) return 10;
    if (fence_places_can_open(fence_places_at("new"), O_WRONLY | O_CREAT)) return 11;
    if (fence_places_can_open("/tmp", O_RDONLY | O_DIRECTORY)) return 12;
    if (fence_places_can_open("/etc/passwd", O_RDONLY)) return 13;
    if (fence_places_can_open(parent, O_RDONLY)) return 14;
    if (fence_places_can_open("/proc", O_RDONLY | O_DIRECTORY)) return 15;
    if (rename(fence_places_at("in/ann/a.raw"), fence_places_at("out/ann/a.raw")) == 0) return 16;
    if (link(fence_places_at("state/store"), fence_places_at("out/ann/store")) == 0) return 17;
    if (symlink(fence_places_at("state/store"), fence_places_at("out/ann/store")) == 0) return 18;
    if (mkdir(fence_places_at("out/ann/deep"), 0700) == 0) return 19;
    if (mknod(fence_places_at("out/ann/pipe"), S_IFIFO | 0600, 0) == 0) return 20;
    if (rmdir(fence_places_at("out/bob")) == 0) return 21;
    if (fence_places_can_open("/dev/mem", O_RDONLY) || fence_places_can_open("/dev/kmsg", O_WRONLY)) return 22;
    return 0;
}

static void nobody_elses_files_are_there(void **state)
{
    fence_places_skip_without_landlock();
    fence_places_run(fence_places_job("ann", "a.raw", "ann"), reach_for_files);
}

static int use_files_of_two_jobs(void)
{
    if (!fence_places_can_open(fence_places_at("in/ann/a.raw"), O_RDONLY)) return 31;
    if (!fence_places_can_open(fence_places_at("in/two/a.raw"), O_RDONLY)) return 32;
    if (!fence_places_can_open(fence_places_at("out/ann/x.part"), O_RDWR | O_CREAT | O_EXCL)) return 33;
    if (!fence_places_can_open(fence_places_at("out/two/x.part"), O_RDWR | O_CREAT | O_EXCL)) return 34;
    if (unlink(fence_places_at("out/ann/x.part")) != 0 || unlink(fence_places_at("out/two/x.part")) != 0) return 35;
    if (fence_places_can_open(fence_places_at("in/two/a.raw"), O_WRONLY)) return 36;
    if (fence_places_can_open(fence_places_at("out/x.part"), O_RDWR | O_CREAT | O_EXCL)) return 37;
    return reach_for_files();
}

// The fence of several jobs opens what the fence of each opens, and nothing between.
static void files_of_the_owners_other_jobs_are_there(void **state)
{
    struct fence fence = fence_places_job("ann", "a.raw", "ann");

    fence_places_skip_without_landlock();
    assert_int_equal(mkdir(fence_places_at("in/two"), 0700), 0);
    assert_int_equal(mkdir(fence_places_at("out/two"), 0700), 0);
    fence_places_write_file(fence_places_at("in/two/a.raw"));
    fence_places_add_job(&fence, "two", "a.raw", "two");
    fence_places_run(fence, use_files_of_two_jobs);
}

static int use_files_beside_faulty_jobs(void)
{
    if (fence_places_can_open(fence_places_at("out/two/x.part"), O_RDWR | O_CREAT | O_EXCL)) return 31;
    if (fence_places_can_open(fence_places_at("state/x.part"), O_RDWR | O_CREAT | O_EXCL)) return 32;
    if (access(fence_places_at("out/three"), F_OK) == 0) return 33;
    return use_own_files() ? 34 : reach_for_files();
}

// Another job's faults are told by a worker of its own.
static void what_other_jobs_lack_stays_closed(void **state)
{
    struct fence fence = fence_places_job("ann", "a.raw", "ann");

    fence_places_skip_without_landlock();
    assert_int_equal(symlink("../state", fence_places_at("in/away")), 0);
    assert_int_equal(symlink("../state", fence_places_at("out/away")), 0);
    assert_int_equal(mkdir(fence_places_at("out/two"), 0700), 0);
    fence_places_add_job(&fence, "away", "store", "two");
    fence_places_add_job(&fence, "none", "a.raw", "two");
    fence_places_add_job(&fence, "ann", "a.raw", "away");
    fence_places_add_job(&fence, "ann", "a.raw", "three");
    fence_places_run(fence, use_files_beside_faulty_jobs);
}

static int held_folder; // the descriptor of a folder that the fence does not open

static int open_from_a_held_folder(void)
{
    int fd = openat(held_folder, "b.exr", O_RDONLY);

    return fd >= 0 ? 1 : errno == EACCES ? 0 : 2;
}

// Therefore a worker that runs cannot be given further folders.
static void folder_that_was_opened_before_opens_nothing(void **state)
{
    fence_places_skip_without_landlock();
    held_folder = open(fence_places_at("out/bob"), O_RDONLY | O_DIRECTORY);
    assert_true(held_folder >= 0);
    fence_places_run(fence_places_job("ann", "a.raw", "ann"), open_from_a_held_folder);
    close(held_folder);
}

static int read_the_one_file(void)
{
    if (!fence_places_can_open(fence_places_at("in/top.raw"), O_RDONLY)) return 1;
    if (fence_places_can_open(fence_places_at("in/ann/a.raw"), O_RDONLY)) return 2;
    return 0;
}

static void file_in_the_root_itself_opens_no_more_than_itself(void **state)
{
    fence_places_skip_without_landlock();
    fence_places_run(fence_places_job("", "top.raw", "ann"), read_the_one_file);
}

static int read_a_sequence(void)
{
    if (!fence_places_can_open(fence_places_at("in/s.01.raw"), O_RDONLY) ||
        !fence_places_can_open(fence_places_at("in/s.002.raw"), O_RDONLY))
        return 1;
    if (!fence_places_can_open(fence_places_at("in/s.03.raw"), O_RDONLY)) return 2; // a link
    if (fence_places_can_open(fence_places_at("in/s.1.raw"), O_RDONLY) ||
        fence_places_can_open(fence_places_at("in/s.01.raw2"), O_RDONLY))
        return 3;
    if (fence_places_can_open(fence_places_at("in/s.04.raw"), O_RDONLY)) return 4; // a link that leads out
    if (fence_places_can_open(fence_places_at("in/s.05.raw"), O_RDONLY))
        return 5; // a link out of the root, to the store
    return 0;
}

static void sequence_in_the_root_opens_files_of_its_name(void **state)
{
    fence_places_skip_without_landlock();
    fence_places_write_file(fence_places_at("in/s.01.raw"));
    fence_places_write_file(fence_places_at("in/s.002.raw"));
    fence_places_write_file(fence_places_at("in/s.1.raw"));
    fence_places_write_file(fence_places_at("in/s.01.raw2"));
    assert_int_equal(symlink("bob/b.raw", fence_places_at("in/s.03.raw")), 0);
    assert_int_equal(symlink("../state/store", fence_places_at("in/s.04.raw")), 0);
    assert_int_equal(symlink("../out/bob/b.exr", fence_places_at("in/s.05.raw")), 0);
    fence_places_run(fence_places_job("", "s.##.raw", "ann"), read_a_sequence);
}

static int read_beside_the_store(void)
{
    if (!fence_places_can_open(fence_places_at("in/ann/a.raw"), O_RDONLY)) return 1;
    if (fence_places_can_open(fence_places_at("in/ann/b.raw"), O_RDONLY)) return 2;
    if (fence_places_can_open(fence_places_at("in/ann/state/store"), O_RDONLY)) return 3;
    return 0;
}

static void folder_that_holds_the_store_is_not_opened(void **state)
{
    struct fence fence = fence_places_job("ann", "a.raw", "ann");

    fence_places_skip_without_landlock();
    assert_int_equal(mkdir(fence_places_at("in/ann/state"), 0700), 0);
    fence_places_write_file(fence_places_at("in/ann/state/store"));
    path_list_add(&fence.closed, strdup(fence_places_at("in/ann/state")));
    fence_places_run(fence, read_beside_the_store);
}

// Enters the sandbox in another process, which must fail with this reason.
static void assert_refused(struct fence fence, enum sandbox_fault wanted, const char *words)
{
    pid_t child = fork();
    int status;

    if (child == 0) {
        enum sandbox_fault fault;
        struct error error = {0};

        if (fence_places_enter(&fence, &fault, &error)) _exit(1);
        if (!strstr(error.message, words)) fprintf(stderr, "expected \"%s\" in \"%s\"\n", words, error.message);
        _exit(fault != wanted ? 2 : strstr(error.message, words) ? 0 : 3);
    }
    fence_finish(&fence);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static int read_the_store(void)
{
    if (!fence_places_can_open(fence_places_at("in/ann/b.raw"), O_RDONLY)) return 1;
    if (fence_places_can_open(fence_places_at("in/state/store"), O_RDONLY)) return 2;
    if (fence_places_can_open(fence_places_at("in/ann/link"), O_RDONLY)) return 3;
    return 0;
}

static struct fence fence_with_store(const char *folder, const char *name)
{
    struct fence fence = fence_places_job(folder, name, "ann"), other = fence_places_job("ann", "b.raw", "ann");

    // Both files are the job's.
    fence.job.inputs = realloc(fence.job.inputs, 2 * sizeof fence.job.inputs[0]);
    fence.job.inputs[fence.job.input_count++] = other.job.inputs[0];
    other.job.input_count = 0;
    fence_finish(&other);
    path_list_add(&fence.closed, strdup(fence_places_at("in/state")));
    return fence;
}

static void store_is_no_input(void **state)
{
    fence_places_skip_without_landlock();
    assert_int_equal(mkdir(fence_places_at("in/state"), 0700), 0);
    fence_places_write_file(fence_places_at("in/state/store"));
    assert_int_equal(symlink("../state/store", fence_places_at("in/ann/link")), 0);
    fence_places_run(fence_with_store("state", "store"), read_the_store);
    fence_places_run(fence_with_store("ann", "link"), read_the_store);
}

static void what_leads_out_of_a_root_is_refused(void **state)
{
    struct fence holder = fence_places_job("ann", "a.raw", "");

    assert_int_equal(symlink("../state", fence_places_at("in/away")), 0);
    assert_int_equal(symlink("../../state/store", fence_places_at("in/ann/away.raw")), 0);
    assert_int_equal(symlink("../state", fence_places_at("out/away")), 0);
    assert_refused(fence_places_job("away", "store", "ann"), SANDBOX_FAULT_JOB, "leads out of");
    assert_refused(fence_places_job("ann", "away.raw", "ann"), SANDBOX_FAULT_JOB, "leads out of");
    assert_refused(fence_places_job("none", "a.raw", "ann"), SANDBOX_FAULT_JOB, "the file");
    assert_refused(fence_places_job("ann", "a.raw", "away"), SANDBOX_FAULT_OUTPUT, "is a symbolic link");
    path_list_add(&holder.closed, strdup(fence_places_at("out/state")));
    assert_refused(holder, SANDBOX_FAULT_OUTPUT, "which is the daemon's");
}

// Such a job's worker would never be ready in time.
static void more_links_than_can_be_opened_in_time_are_refused(void **state)
{
    assert_int_equal(mkdir(fence_places_at("in/many"), 0700), 0);
    for (int i = 0; i <= SANDBOX_FILE_LIMIT; i++) {
        char name[32];

        snprintf(name, sizeof name, "in/many/%06d.raw", i);
        assert_int_equal(symlink("../ann/a.raw", fence_places_at(name)), 0);
    }
    assert_refused(fence_places_job("many", "######.raw", "ann"), SANDBOX_FAULT_JOB, "at most 32768 files");
}

static void *answer(void *user)
{
    *(int *)user = 42;
    return NULL;
}

#ifdef __x86_64__
// mov $42, %eax; ret
static const unsigned char code[] = {0xb8, 42, 0, 0, 0, 0xc3};
#endif

static int render(void)
{
    pthread_t thread;
    int number = 0;

    if (pthread_create(&thread, NULL, answer, &number) != 0 || pthread_join(thread, NULL) != 0 || number != 42)
        return 1;
#ifdef __x86_64__
    void *page = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    int (*function)(void);

    if (page == MAP_FAILED) return 2;
    memcpy(page, code, sizeof code);
    if (mprotect(page, 4096, PROT_READ | PROT_EXEC) != 0) return 3;
    *(void **)&function = page;
    if (function() != 42) return 4;
#endif
    if (memfd_create("x", MFD_CLOEXEC) < 0) return 5;
    return 0;
}

static void code_made_at_run_time_and_threads_run(void **state)
{
    fence_places_run(fence_places_job("ann", "a.raw", "ann"), render);
}

static int convert(void)
{
    const pid_t parent = getppid();
    pid_t child;
    int status;

    if (!fence_places_can_open(getenv("TMPDIR"), O_RDONLY | O_DIRECTORY)) return 1;
    if (strncmp(getenv("TMPDIR"), fence_places_at("."), strlen(fence_places_at("."))) != 0) return 2;
    child = fork();
    if (child < 0) return 3;
    if (child == 0) {
        execl("/bin/true", "true", NULL);
        _exit(errno == EACCES ? 4 : 5); // not the converter
    }
    if (waitpid(child, &status, 0) != child || !WIFEXITED(status)) return 6;
    if (fence_places_has_landlock() && WEXITSTATUS(status) != 4) return 7;
    if (!fence_places_is_refused(prlimit(parent, RLIMIT_CORE, &(struct rlimit){0, 0}, NULL))) return 8;
    return 0;
}

static int convert_and_kill(void)
{
    int status = convert();

    // Landlock confines signals from its version 6 on.
    return status ? status : fence_places_is_refused(kill(getppid(), 0)) ? 0 : 9;
}

static void converter_is_the_only_program(void **state)
{
    struct fence fence = fence_places_job("ann", "a.raw", "ann");
    struct sandbox_landlock landlock;

    assert_true(sandbox_landlock_open(&landlock, NULL));
    sandbox_landlock_close(&landlock);
    setenv("TMPDIR", fence_places_at("."), 1);
    fence.has_converter = true;
    fence_places_run(fence, landlock.abi >= 6 ? convert_and_kill : convert);
    if (landlock.abi < 6) print_message("this kernel's Landlock does not keep signals in: not tried\n");
    unsetenv("TMPDIR");
}

static int use_limits(void)
{
    struct rlimit limit;
    char text[16] = "";
    int fd = open("/proc/self/oom_score_adj", O_RDONLY);
    void *memory;

    if (getrlimit(RLIMIT_CORE, &limit) != 0 || limit.rlim_max != 0) return 1;
    if (read(fd, text, sizeof text - 1) <= 0 || atoi(text) < 500) return 2;
    memory = mmap(NULL, (size_t)512 << 20, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (!IS_SANITIZED && memory != MAP_FAILED) return 3;
    return 0;
}

static void memory_has_a_limit(void **state)
{
    pid_t child = fork();
    int status;

    if (child == 0) {
        sandbox_limit((int64_t)256 << 20);
        _exit(use_limits());
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

int main(int argc, char *argv[])
{
#define IN_PLACES(test) cmocka_unit_test_setup_teardown(test, fence_places_make, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        IN_PLACES(own_files_are_there),
        IN_PLACES(nobody_elses_files_are_there),
        IN_PLACES(files_of_the_owners_other_jobs_are_there),
        IN_PLACES(what_other_jobs_lack_stays_closed),
        IN_PLACES(folder_that_was_opened_before_opens_nothing),
        IN_PLACES(file_in_the_root_itself_opens_no_more_than_itself),
        IN_PLACES(sequence_in_the_root_opens_files_of_its_name),
        IN_PLACES(folder_that_holds_the_store_is_not_opened),
        IN_PLACES(store_is_no_input),
        IN_PLACES(what_leads_out_of_a_root_is_refused),
        IN_PLACES(more_links_than_can_be_opened_in_time_are_refused),
        IN_PLACES(code_made_at_run_time_and_threads_run),
        IN_PLACES(converter_is_the_only_program),
        cmocka_unit_test(memory_has_a_limit),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
