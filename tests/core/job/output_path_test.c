// SPDX-License-Identifier: Apache-2.0
#include "core/job/output_path.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <sys/stat.h>

#include <cmocka.h>

static struct output_path parse(const char *pattern)
{
    struct output_path path;
    struct error error = {0};

    if (!output_path_parse(&path, pattern, &error)) fail_msg("%s: %s", pattern, error.message);
    return path;
}

static void assert_refused(const char *pattern, const char *expected)
{
    struct output_path path;
    struct error error = {0};

    if (output_path_parse(&path, pattern, &error)) fail_msg("accepted: %s", pattern);
    assert_string_equal(error.message, expected);
    assert_null(path.folder);
    assert_null(path.prefix);
    output_path_finish(&path);
}

static void assert_name(const char *pattern, int32_t frame, const char *expected)
{
    struct output_path path = parse(pattern);
    char name[OUTPUT_NAME_SIZE];

    output_path_format_name(&path, frame, name);
    assert_string_equal(name, expected);
    assert_int_equal(output_path_frame_of(&path, name), frame);
    output_path_finish(&path);
}

static void pattern_is_folder_prefix_number_and_suffix(void **state)
{
    struct output_path path = parse("a/b c/cloud.####.exr");

    assert_string_equal(path.folder, "a/b c");
    assert_string_equal(path.prefix, "cloud.");
    assert_string_equal(path.suffix, ".exr");
    assert_int_equal(path.pad, 4);
    output_path_finish(&path);
    path = parse("%04d.exr");
    assert_string_equal(path.folder, "");
    assert_string_equal(path.prefix, "");
    assert_int_equal(path.pad, 4);
    output_path_finish(&path);
}

static void number_is_padded_but_never_cut(void **state)
{
    assert_name("x.####.exr", 7, "x.0007.exr");
    assert_name("x.%04d.exr", 7, "x.0007.exr");
    assert_name("x.####.exr", 12345, "x.12345.exr");
    assert_name("x.#.exr", 0, "x.0.exr");
    assert_name("x#########.exr", 9999999, "x009999999.exr");
    assert_name("shot1_###_v2.exr", 42, "shot1_042_v2.exr");
    assert_name("##0.exr", 5, "050.exr");
    assert_name("100%_%02d.exr", 5, "100%_05.exr");
}

static void other_names_are_no_frame(void **state)
{
    static const char *const names[] = {"x.7.exr",
                                        "x.00007.exr",
                                        "x..exr",
                                        "x.007a.exr",
                                        "y.0007.exr",
                                        "x.0007.ex",
                                        "x.0007.exr.1",
                                        "x.-007.exr",
                                        "x.0007",
                                        "",
                                        "x.99999999999999999999.exr",
                                        "x.4294967303.exr",
                                        "x.0007.exr.1.2.3.part"};
    struct output_path path = parse("x.####.exr");

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        assert_int_equal(output_path_frame_of(&path, names[i]), -1);
    output_path_finish(&path);
}

static void part_name_names_farm_job_epoch_and_attempt(void **state)
{
    struct output_path path = parse("a/x.####.exr");
    struct output_part part = {.frame = 7, .job = 12, .epoch = 3, .attempt = 2};
    char name[OUTPUT_NAME_SIZE];

    output_path_format_part(&path, &part, name);
    assert_string_equal(name, "x.0007.exr.12.3.2.part");
    part.farm = "0123456789abcdef0123456789abcdef";
    output_path_format_part(&path, &part, name);
    assert_string_equal(name, "x.0007.exr.01234567.12.3.2.part");
    assert_int_equal(output_path_frame_of(&path, name), -1);
    output_path_finish(&path);
}

static void longest_name_leaves_room_for_its_part_name(void **state)
{
    char pattern[OUTPUT_NAME_SIZE + 8], part[OUTPUT_NAME_SIZE];
    struct output_path path;
    size_t length = OUTPUT_NAME_SIZE - 1;

    do {
        length--;
        memset(pattern, 'n', length);
        strcpy(pattern + length, "#.exr");
    } while (!output_path_parse(&path, pattern, NULL));
    assert_true(length > 180);
    output_path_format_part(
        &path,
        &(struct output_part){
            .farm = "0123456789abcdef", .job = INT64_MAX, .epoch = 9999999999, .frame = 9999999, .attempt = INT32_MAX},
        part);
    assert_string_equal(part + strlen(part) - 5, ".part");
    output_path_finish(&path);
}

static void paths_that_leave_the_root_are_refused(void **state)
{
    assert_refused("../x.#.exr", "\"..\" is not allowed in a path");
    assert_refused("a/../../x.#.exr", "\"..\" is not allowed in a path");
    assert_refused("a/./x.#.exr", "\".\" is not allowed in a path");
    assert_refused("a//x.#.exr", "expected a name between slashes, got nothing");
    assert_refused("a/x.#.exr/", "a frame number belongs into the file name, not into folder \"x.#.exr\"");
    assert_refused("a/b/", "expected a name between slashes, got nothing");
    assert_refused("/tmp/x.#.exr", "expected a relative path, got \"/tmp/x.#.exr\"");
    assert_refused("", "expected a path of 1 to 1024 bytes, got 0");
    assert_refused("a\n/x.#.exr", "byte 0x0a at offset 1 is not allowed in a path");
    assert_refused("..", "\"..\" is not allowed in a path");
}

static void folders_with_dots_in_their_names_are_fine(void **state)
{
    struct output_path path = parse("...a/..b/.c/x.#.exr");

    assert_string_equal(path.folder, "...a/..b/.c");
    output_path_finish(&path);
}

static void name_has_one_frame_number(void **state)
{
    assert_refused("x.exr", "expected #### or %04d in the file name, got \"x.exr\"");
    assert_refused("x.%d.exr", "expected #### or %04d in the file name, got \"x.%d.exr\"");
    assert_refused("x.%4d.exr", "expected #### or %04d in the file name, got \"x.%4d.exr\"");
    assert_refused("x.#.#.exr", "expected one frame number in the file name, got \"x.#.#.exr\"");
    assert_refused("x.%04d.##.exr", "expected one frame number in the file name, got \"x.%04d.##.exr\"");
    assert_refused("x.##########.exr", "expected a frame number of 1 to 9 digits, got \"##########\"");
    assert_refused("x.%00d.exr", "expected a frame number of 1 to 9 digits, got \"%00d\"");
    assert_refused("##/x.#.exr", "a frame number belongs into the file name, not into folder \"##\"");
    assert_refused("a/b%02d/x.#.exr", "a frame number belongs into the file name, not into folder \"b%02d\"");
}

static void name_ends_in_exr(void **state)
{
    assert_refused("x.####.png", "expected a file name that ends in \".exr\", got \"x.####.png\"");
    assert_refused("x.exr.####", "expected a file name that ends in \".exr\", got \"x.exr.####\"");
    assert_refused("####exr", "expected a file name that ends in \".exr\", got \"####exr\"");
}

static void long_names_are_refused(void **state)
{
    char pattern[2048];
    struct output_path path;
    struct error error = {0};

    memset(pattern, 'n', 256);
    strcpy(pattern + 256, "/x.#.exr");
    assert_false(output_path_parse(&path, pattern, &error));
    assert_non_null(strstr(error.message, "expected names of at most 255 bytes"));
    memset(pattern, 'n', 240);
    strcpy(pattern + 240, "#.exr");
    assert_false(output_path_parse(&path, pattern, &error));
    assert_string_equal(error.message, "expected a file name of at most 199 bytes, got 251");
    memset(pattern, 'n', 1100);
    strcpy(pattern + 1100, "#.exr");
    assert_false(output_path_parse(&path, pattern, &error));
    assert_string_equal(error.message, "expected a path of 1 to 1024 bytes, got 1105");
}

static void absolute_path_below_the_root_becomes_relative(void **state)
{
    struct error error = {0};

    assert_string_equal(output_path_below("/srv/out/a/b.#.exr", "/srv/out", NULL), "a/b.#.exr");
    assert_string_equal(output_path_below("/srv/out/b.#.exr", "/srv/out/", NULL), "b.#.exr");
    assert_string_equal(output_path_below("/b.#.exr", "/", NULL), "b.#.exr");
    assert_string_equal(output_path_below("a/b.#.exr", "/srv/out", NULL), "a/b.#.exr");
    assert_string_equal(output_path_below("a/b.#.exr", NULL, NULL), "a/b.#.exr");
    assert_null(output_path_below("/srv/outer/b.#.exr", "/srv/out", &error));
    assert_string_equal(error.message, "expected a path below \"/srv/out\", got \"/srv/outer/b.#.exr\"");
    assert_null(output_path_below("/srv", "/srv/out", NULL));
    assert_null(output_path_below("/srv/out/b.#.exr", NULL, &error));
    assert_string_equal(error.message, "expected a relative path, got \"/srv/out/b.#.exr\"");
    // ".." stays in the result, for output_path_parse to refuse.
    assert_string_equal(output_path_below("/srv/out/../b.#.exr", "/srv/out", NULL), "../b.#.exr");
}

static void assert_collision(const char *one, const char *other, bool expected)
{
    struct output_path a = parse(one), b = parse(other);

    if (output_path_may_collide(&a, &b) != expected || output_path_may_collide(&b, &a) != expected)
        fail_msg("%s and %s", one, other);
    output_path_finish(&a);
    output_path_finish(&b);
}

static void patterns_that_can_share_a_name_may_collide(void **state)
{
    assert_collision("a/x.####.exr", "a/x.####.exr", true);
    assert_collision("a/x.####.exr", "a/x.##.exr", true);
    assert_collision("a/x.####.exr", "a/x.%04d.exr", true);
    assert_collision("x####.exr", "x1####.exr", true);          // x10001.exr
    assert_collision("x_####.exr", "x_###0.exr", true);         // x_0010.exr
    assert_collision("x####_0001.exr", "x0005_####.exr", true); // x0005_0001.exr
}

static void patterns_that_cannot_share_a_name_do_not_collide(void **state)
{
    assert_collision("a/x.####.exr", "b/x.####.exr", false);
    assert_collision("x.####.exr", "a/x.####.exr", false);
    assert_collision("x.####.exr", "y.####.exr", false);
    assert_collision("x.####.exr", "x.####.v2.exr", false);
    assert_collision("x.####.exr", "x.v####.exr", false);
}

static void folder_is_made_below_the_root(void **state)
{
    struct output_path path = parse("a/b/x.#.exr");
    struct stat made, opened;
    struct error error = {0};
    int fd = output_path_open_folder(&path, *state, false, &error);

    assert_int_equal(fd, -1);
    assert_non_null(strstr(error.message, "cannot open folder \"a\" below"));
    assert_non_null(strstr(error.message, "No such file or directory"));
    for (int i = 0; i < 2; i++) {
        fd = output_path_open_folder(&path, *state, true, &error);
        assert_true(fd >= 0);
        assert_int_equal(fstat(fd, &opened), 0);
        assert_int_equal(stat(temp_folder_path(state, "a/b"), &made), 0);
        assert_int_equal(opened.st_ino, made.st_ino);
        assert_int_equal(fsync(fd), 0);
        close(fd);
    }
    output_path_finish(&path);
}

static void pattern_without_a_folder_opens_the_root(void **state)
{
    struct output_path path = parse("x.#.exr");
    struct stat root, opened;
    int fd = output_path_open_folder(&path, *state, true, NULL);

    assert_true(fd >= 0);
    assert_int_equal(fstat(fd, &opened), 0);
    assert_int_equal(stat(*state, &root), 0);
    assert_int_equal(opened.st_ino, root.st_ino);
    close(fd);
    output_path_finish(&path);
}

static void link_on_the_way_is_refused_by_name(void **state)
{
    struct output_path path = parse("a/link/b/x.#.exr");
    struct error error = {0};

    assert_int_equal(mkdir(temp_folder_path(state, "a"), 0700), 0);
    assert_int_equal(mkdir(temp_folder_path(state, "a/real"), 0700), 0);
    assert_int_equal(symlink("real", temp_folder_path(state, "a/link")), 0);
    assert_int_equal(output_path_open_folder(&path, *state, true, &error), -1);
    assert_non_null(strstr(error.message, "\"a/link\" below"));
    assert_non_null(strstr(error.message, "is a symbolic link"));
    assert_int_equal(access(temp_folder_path(state, "a/real/b"), F_OK), -1);
    output_path_finish(&path);
}

static void dangling_link_is_not_made_real(void **state)
{
    struct output_path path = parse("link/x.#.exr");
    struct error error = {0};

    assert_int_equal(symlink("elsewhere", temp_folder_path(state, "link")), 0);
    assert_int_equal(output_path_open_folder(&path, *state, true, &error), -1);
    assert_non_null(strstr(error.message, "is a symbolic link"));
    assert_int_equal(access(temp_folder_path(state, "elsewhere"), F_OK), -1);
    output_path_finish(&path);
}

static void file_on_the_way_is_refused_by_name(void **state)
{
    struct output_path path = parse("a/b/x.#.exr");
    struct error error = {0};
    FILE *file = fopen(temp_folder_path(state, "a"), "w");

    assert_non_null(file);
    fclose(file);
    assert_int_equal(output_path_open_folder(&path, *state, true, &error), -1);
    assert_non_null(strstr(error.message, "\"a\" below"));
    assert_non_null(strstr(error.message, "is not a folder"));
    output_path_finish(&path);
}

static void root_may_be_reached_through_a_link(void **state)
{
    struct output_path path = parse("a/x.#.exr");
    int fd;

    assert_int_equal(mkdir(temp_folder_path(state, "real"), 0700), 0);
    assert_int_equal(symlink("real", temp_folder_path(state, "root")), 0);
    fd = output_path_open_folder(&path, temp_folder_path(state, "root"), true, NULL);
    assert_true(fd >= 0);
    assert_int_equal(access(temp_folder_path(state, "real/a"), F_OK), 0);
    close(fd);
    output_path_finish(&path);
}

// As in a sandbox: the upper folders may be passed but not read.
static void folders_on_the_way_need_not_be_readable(void **state)
{
    struct output_path path = parse("a/b/x.#.exr");
    bool is_root = geteuid() == 0;
    int fd;

    assert_int_equal(mkdir(temp_folder_path(state, "a"), 0700), 0);
    assert_int_equal(mkdir(temp_folder_path(state, "a/b"), 0777), 0);
    assert_int_equal(chmod(temp_folder_path(state, "a/b"), 0777), 0);
    assert_int_equal(chmod(temp_folder_path(state, "a"), 0711), 0);
    assert_int_equal(chmod(*state, 0711), 0);
    if (is_root) {
        assert_int_equal(seteuid(65534), 0);
    } else {
        assert_int_equal(chmod(temp_folder_path(state, "a"), 0111), 0);
        assert_int_equal(chmod(*state, 0111), 0);
    }
    fd = output_path_open_folder(&path, *state, true, NULL);
    if (is_root) assert_int_equal(seteuid(0), 0);
    assert_int_equal(chmod(*state, 0700), 0);
    assert_int_equal(chmod(temp_folder_path(state, "a"), 0700), 0);
    assert_true(fd >= 0);
    assert_int_equal(fsync(fd), 0);
    close(fd);
    output_path_finish(&path);
}

static void missing_root_is_an_error(void **state)
{
    struct output_path path = parse("x.#.exr");
    struct error error = {0};

    assert_int_equal(output_path_open_folder(&path, temp_folder_path(state, "none"), true, &error), -1);
    assert_non_null(strstr(error.message, "cannot open output root"));
    output_path_finish(&path);
}

int main(void)
{
#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pattern_is_folder_prefix_number_and_suffix),
        cmocka_unit_test(number_is_padded_but_never_cut),
        cmocka_unit_test(other_names_are_no_frame),
        cmocka_unit_test(part_name_names_farm_job_epoch_and_attempt),
        cmocka_unit_test(longest_name_leaves_room_for_its_part_name),
        cmocka_unit_test(paths_that_leave_the_root_are_refused),
        cmocka_unit_test(folders_with_dots_in_their_names_are_fine),
        cmocka_unit_test(name_has_one_frame_number),
        cmocka_unit_test(name_ends_in_exr),
        cmocka_unit_test(long_names_are_refused),
        cmocka_unit_test(absolute_path_below_the_root_becomes_relative),
        cmocka_unit_test(patterns_that_can_share_a_name_may_collide),
        cmocka_unit_test(patterns_that_cannot_share_a_name_do_not_collide),
        WITH_FOLDER(folder_is_made_below_the_root),
        WITH_FOLDER(pattern_without_a_folder_opens_the_root),
        WITH_FOLDER(link_on_the_way_is_refused_by_name),
        WITH_FOLDER(dangling_link_is_not_made_real),
        WITH_FOLDER(file_on_the_way_is_refused_by_name),
        WITH_FOLDER(root_may_be_reached_through_a_link),
        WITH_FOLDER(folders_on_the_way_need_not_be_readable),
        WITH_FOLDER(missing_root_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
