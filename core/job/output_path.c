// SPDX-License-Identifier: Apache-2.0
#include "core/job/output_path.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <linux/openat2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum {
    PATTERN_LIMIT = 1024,
    COMPONENT_LIMIT = 255,
    PAD_LIMIT = 9,
    NUMBER_WIDTH = 7, // of the largest frame number
    // ".<farm>.<job>.<epoch>.<attempt>.part" with the longest numbers
    PART_SUFFIX_LIMIT = 1 + OUTPUT_FARM_DIGITS + 1 + 19 + 1 + 10 + 1 + 10 + 5,
    FOLDER_FLAGS = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC,
    // The folders above the last one are only passed: that needs no permission to list them, from modes or from a
    // sandbox.
    PASSED_FLAGS = O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC
};

static const char name_ending[] = ".exr";

// A frame number's position in a name.
struct number_field {
    const char *start;
    size_t length;
    int pad;
};

// Finds the first frame number in [text, end), a run of number signs or "%04d". False when there is none.
static bool find_number(const char *text, const char *end, struct number_field *field)
{
    for (const char *c = text; c < end; c++) {
        if (*c == '#') {
            size_t length = 1;

            while (c + length < end && c[length] == '#')
                length++;
            *field = (struct number_field){c, length, length > PAD_LIMIT ? 0 : (int)length};
            return true;
        }
        if (end - c >= 4 && c[0] == '%' && c[1] == '0' && isdigit((unsigned char)c[2]) && c[3] == 'd') {
            *field = (struct number_field){c, 4, c[2] - '0'};
            return true;
        }
    }
    return false;
}

static bool check_component(const char *start, size_t length, struct error *error)
{
    if (length == 0) {
        error_set(error, "expected a name between slashes, got nothing");
        return false;
    }
    if (length > COMPONENT_LIMIT) {
        error_set(error, "expected names of at most %d bytes, got \"%.40s...\"", COMPONENT_LIMIT, start);
        return false;
    }
    if (strncmp(start, "..", length) == 0 && length <= 2) {
        error_set(error, "\"%.*s\" is not allowed in a path", (int)length, start);
        return false;
    }
    return true;
}

static bool check_folder(const char *folder, size_t length, struct error *error)
{
    const char *end = folder + length;

    for (const char *start = folder; start <= end;) {
        const char *slash = memchr(start, '/', (size_t)(end - start));
        size_t size = (size_t)((slash ? slash : end) - start);
        struct number_field field;

        if (!check_component(start, size, error)) return false;
        if (find_number(start, start + size, &field)) {
            error_set(error, "a frame number belongs into the file name, not into folder \"%.*s\"", (int)size, start);
            return false;
        }
        start += size + 1;
    }
    return true;
}

static bool check_pattern(const char *pattern, struct error *error)
{
    size_t length = strlen(pattern);

    if (length == 0 || length > PATTERN_LIMIT) {
        error_set(error, "expected a path of 1 to %d bytes, got %zu", PATTERN_LIMIT, length);
        return false;
    }
    for (size_t i = 0; i < length; i++) {
        unsigned char byte = (unsigned char)pattern[i];

        if (byte < 0x20 || byte == 0x7f) {
            error_set(error, "byte 0x%02x at offset %zu is not allowed in a path", byte, i);
            return false;
        }
    }
    if (pattern[0] == '/') {
        error_set(error, "expected a relative path, got \"%.200s\"", pattern);
        return false;
    }
    return true;
}

static bool split_name(struct output_path *path, const char *name, struct error *error)
{
    struct number_field field, second;
    const char *end = name + strlen(name);

    if (!check_component(name, (size_t)(end - name), error)) return false;
    if (!find_number(name, end, &field)) {
        error_set(error, "expected #### or %%04d in the file name, got \"%s\"", name);
        return false;
    }
    if (field.pad < 1) {
        error_set(error, "expected a frame number of 1 to %d digits, got \"%.*s\"", PAD_LIMIT, (int)field.length,
                  field.start);
        return false;
    }
    if (find_number(field.start + field.length, end, &second)) {
        error_set(error, "expected one frame number in the file name, got \"%s\"", name);
        return false;
    }
    path->pad = field.pad;
    path->prefix = xstrndup(name, (size_t)(field.start - name));
    path->suffix = xstrdup(field.start + field.length);
    return true;
}

static bool check_suffix(const struct output_path *path, const char *name, struct error *error)
{
    size_t prefix = strlen(path->prefix), suffix = strlen(path->suffix), ending = strlen(name_ending);
    size_t longest = prefix + suffix + (path->pad > NUMBER_WIDTH ? (size_t)path->pad : NUMBER_WIDTH);

    if (suffix < ending || strcmp(path->suffix + suffix - ending, name_ending) != 0) {
        error_set(error, "expected a file name that ends in \"%s\", got \"%s\"", name_ending, name);
        return false;
    }
    if (longest + PART_SUFFIX_LIMIT >= OUTPUT_NAME_SIZE) {
        error_set(error, "expected a file name of at most %d bytes, got %zu", OUTPUT_NAME_SIZE - 1 - PART_SUFFIX_LIMIT,
                  longest);
        return false;
    }
    return true;
}

bool output_path_parse(struct output_path *path, const char *pattern, struct error *error)
{
    bool ok = false;
    const char *slash = strrchr(pattern, '/');
    const char *name = slash ? slash + 1 : pattern;
    size_t folder_length = slash ? (size_t)(slash - pattern) : 0;

    *path = (struct output_path){0};
    if (!check_pattern(pattern, error)) goto out;
    if (slash && !check_folder(pattern, folder_length, error)) goto out;
    if (!split_name(path, name, error)) goto out;
    if (!check_suffix(path, name, error)) goto out;
    path->folder = xstrndup(pattern, folder_length);
    ok = true;
out:
    if (!ok) output_path_finish(path);
    return ok;
}

void output_path_finish(struct output_path *path)
{
    free(path->folder);
    free(path->prefix);
    free(path->suffix);
    *path = (struct output_path){0};
}

const char *output_path_below(const char *pattern, const char *root, struct error *error)
{
    size_t length = root ? strlen(root) : 0;

    if (pattern[0] != '/') return pattern;
    if (!root) {
        error_set(error, "expected a relative path, got \"%.200s\"", pattern);
        return NULL;
    }
    while (length > 0 && root[length - 1] == '/')
        length--;
    if (strncmp(pattern, root, length) != 0 || pattern[length] != '/') {
        error_set(error, "expected a path below \"%.200s\", got \"%.200s\"", root, pattern);
        return NULL;
    }
    return pattern + length + 1;
}

void output_path_format_name(const struct output_path *path, int32_t frame, char name[static OUTPUT_NAME_SIZE])
{
    snprintf(name, OUTPUT_NAME_SIZE, "%s%0*" PRId32 "%s", path->prefix, path->pad, frame, path->suffix);
}

void output_path_format_part(const struct output_path *path, const struct output_part *part,
                             char name[static OUTPUT_NAME_SIZE])
{
    const char *farm = part->farm ? part->farm : "";

    snprintf(name, OUTPUT_NAME_SIZE, "%s%0*" PRId32 "%s%s%.*s.%" PRId64 ".%" PRId64 ".%d.part", path->prefix, path->pad,
             part->frame, path->suffix, *farm ? "." : "", OUTPUT_FARM_DIGITS, farm, part->job, part->epoch,
             part->attempt);
}

int32_t output_path_frame_of(const struct output_path *path, const char *name)
{
    char formatted[OUTPUT_NAME_SIZE];
    size_t prefix = strlen(path->prefix);
    int64_t number = 0;

    if (strncmp(name, path->prefix, prefix) != 0) return -1;
    for (const char *c = name + prefix; isdigit((unsigned char)*c) && number <= INT32_MAX; c++) {
        // A suffix may begin with digits: try every end of the number.
        number = number * 10 + (*c - '0');
        if (number > INT32_MAX || strcmp(c + 1, path->suffix) != 0) continue;
        output_path_format_name(path, (int32_t)number, formatted);
        return strcmp(formatted, name) == 0 ? (int32_t)number : -1;
    }
    return -1;
}

// Cuts ".<digits>" off the end of `name` and returns the number; -1: `name` ends otherwise.
static int64_t cut_number(char *name)
{
    char *dot = strrchr(name, '.');
    char *end = NULL;
    long long number;

    if (!dot || dot[1] < '0' || dot[1] > '9') return -1;
    number = strtoll(dot + 1, &end, 10);
    if (*end) return -1;
    *dot = '\0';
    return number;
}

// Cuts ".<farm>" off the end of `name`, if it ends so.
static bool cut_farm(char *name, const char *farm)
{
    char *dot = strrchr(name, '.');

    if (!dot || strlen(dot + 1) != OUTPUT_FARM_DIGITS || strncmp(dot + 1, farm, OUTPUT_FARM_DIGITS) != 0) return false;
    *dot = '\0';
    return true;
}

bool output_path_read_part(const struct output_path *path, const char *farm, const char *name, struct output_part *part)
{
    char cut[OUTPUT_NAME_SIZE];
    size_t length = strlen(name);
    int64_t attempt;

    if (length >= sizeof cut || length < 5 || strcmp(name + length - 5, ".part") != 0) return false;
    memcpy(cut, name, length - 5);
    cut[length - 5] = '\0';
    *part = (struct output_part){0};
    attempt = cut_number(cut);
    part->epoch = cut_number(cut);
    part->job = cut_number(cut);
    if (attempt < 0 || attempt > INT32_MAX || part->epoch < 0 || part->job < 0) return false;
    part->attempt = (int)attempt;
    part->frame = output_path_frame_of(path, cut);
    if (part->frame >= 0) return true;
    if (!farm || !cut_farm(cut, farm)) return false;
    part->farm = farm;
    part->frame = output_path_frame_of(path, cut);
    return part->frame >= 0;
}

static bool is_all_digits(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if (!isdigit((unsigned char)text[i])) return false;
    return true;
}

bool output_path_may_collide(const struct output_path *a, const struct output_path *b)
{
    size_t a_prefix = strlen(a->prefix), b_prefix = strlen(b->prefix);
    size_t a_suffix = strlen(a->suffix), b_suffix = strlen(b->suffix);
    size_t extra;

    // Swapped if needed, so that the number of `a` begins first.
    if (a_prefix > b_prefix || (a_prefix == b_prefix && a_suffix > b_suffix)) return output_path_may_collide(b, a);
    if (strcmp(a->folder, b->folder) != 0 || strncmp(a->prefix, b->prefix, a_prefix) != 0) return false;
    if (a_suffix <= b_suffix) {
        // The number of `a` also ends last, so it covers the characters around the number of `b`.
        extra = b_suffix - a_suffix;
        return strcmp(a->suffix, b->suffix + extra) == 0 && is_all_digits(b->suffix, extra) &&
               is_all_digits(b->prefix + a_prefix, b_prefix - a_prefix);
    }
    // The numbers overlap or follow one another: only the outermost characters between them must be digits.
    extra = a_suffix - b_suffix;
    return strcmp(a->suffix + extra, b->suffix) == 0 && isdigit((unsigned char)b->prefix[a_prefix]) &&
           isdigit((unsigned char)a->suffix[extra - 1]);
}

// Opens one component, so that without openat2 O_NOFOLLOW refuses every link.
static int open_component(int parent_fd, const char *name, int flags)
{
    struct open_how how = {.flags = (uint64_t)flags,
                           .resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_MAGICLINKS};
    int fd = (int)syscall(SYS_openat2, parent_fd, name, &how, sizeof how);

    // A sandbox that does not know the call may answer EPERM.
    if (fd < 0 && (errno == ENOSYS || errno == EPERM)) fd = openat(parent_fd, name, flags);
    return fd;
}

// Says why the component `name`, reached as `reached`, cannot be opened.
static void set_reason(struct error *error, int errnum, int parent_fd, const char *name, const char *reached,
                       const char *root)
{
    struct stat status;

    if (fstatat(parent_fd, name, &status, AT_SYMLINK_NOFOLLOW) == 0 && !S_ISDIR(status.st_mode))
        error_set(error, "\"%s\" below \"%s\" is %s", reached, root,
                  S_ISLNK(status.st_mode) ? "a symbolic link" : "not a folder");
    else
        error_set_errno(error, errnum, "cannot open folder \"%s\" below \"%s\"", reached, root);
    errno = errnum;
}

// A file synced into a new folder is lost in a crash unless the folder's own entry is on disk too.
static bool sync_folder(int passed_fd)
{
    int fd = openat(passed_fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool ok = fd >= 0 && fsync(fd) == 0;
    int errnum = errno;

    if (fd >= 0) close(fd);
    errno = errnum;
    return ok;
}

static int enter_component(int parent_fd, const char *name, int flags, const char *reached, const char *root,
                           bool create, struct error *error)
{
    int fd = open_component(parent_fd, name, flags);

    if (fd < 0 && errno == ENOENT && create) {
        if (mkdirat(parent_fd, name, 0777) < 0 && errno != EEXIST) {
            error_set_errno(error, errno, "cannot make folder \"%s\" below \"%s\"", reached, root);
            return -1;
        }
        if (!sync_folder(parent_fd)) {
            error_set_errno(error, errno, "cannot sync the folder of \"%s\" below \"%s\"", reached, root);
            return -1;
        }
        fd = open_component(parent_fd, name, flags);
    }
    if (fd < 0) {
        int errnum = errno;

        set_reason(error, errnum, parent_fd, name, reached, root);
        errno = errnum;
    }
    return fd;
}

static void close_quietly(int fd)
{
    int errnum = errno;

    close(fd);
    errno = errnum;
}

int output_path_open_below(const struct output_path *path, int root_fd, const char *root, bool create,
                           struct error *error)
{
    size_t length = strlen(path->folder);
    int fd = openat(root_fd, ".", (length > 0 ? O_PATH : O_RDONLY) | O_DIRECTORY | O_CLOEXEC);
    char reached[sizeof error->message];

    if (fd < 0) error_set_errno(error, errno, "cannot open output root \"%s\"", root);
    for (size_t start = 0, end; fd >= 0 && start < length; start = end + 1) {
        char name[OUTPUT_NAME_SIZE];
        int parent_fd = fd;

        end = start + strcspn(path->folder + start, "/");
        snprintf(name, sizeof name, "%.*s", (int)(end - start), path->folder + start);
        snprintf(reached, sizeof reached, "%.*s", (int)end, path->folder);
        fd = enter_component(parent_fd, name, end < length ? PASSED_FLAGS : FOLDER_FLAGS, reached, root, create, error);
        close_quietly(parent_fd);
    }
    return fd;
}

int output_path_open_folder(const struct output_path *path, const char *root, bool create, struct error *error)
{
    int root_fd = open(root, O_PATH | O_DIRECTORY | O_CLOEXEC), fd;

    if (root_fd < 0) {
        error_set_errno(error, errno, "cannot open output root \"%s\"", root);
        return -1;
    }
    fd = output_path_open_below(path, root_fd, root, create, error);
    close(root_fd);
    return fd;
}
