// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox_landlock.h"

#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

// Landlock's interface up to ABI version 7; the installed headers may be older than the kernel.
struct ruleset_attr {
    uint64_t handled_access_fs, handled_access_net, scoped;
};

enum {
    ABI_FILES = 1,
    ABI_REFER = 2,
    ABI_TRUNCATE = 3,
    ABI_NETWORK = 4,
    ABI_DEVICES = 5,
    ABI_SCOPES = 6,
    RULE_PATH_BENEATH = 1
};

#define FS_EXECUTE UINT64_C(0x0001)
#define FS_WRITE_FILE UINT64_C(0x0002)
#define FS_READ_FILE UINT64_C(0x0004)
#define FS_READ_DIR UINT64_C(0x0008)
#define FS_REMOVE_FILE UINT64_C(0x0020)
#define FS_MAKE_REG UINT64_C(0x0100)
#define FS_ALL_OF_FIRST UINT64_C(0x1fff)
#define FS_REFER UINT64_C(0x2000)
#define FS_TRUNCATE UINT64_C(0x4000)
#define FS_IOCTL_DEV UINT64_C(0x8000)
#define NET_BIND_AND_CONNECT_TCP UINT64_C(3)
#define SCOPE_ABSTRACT_SOCKETS_AND_SIGNALS UINT64_C(3)

// The rights that a rule about a file, not a folder, may have.
static const uint64_t file_rights = FS_EXECUTE | FS_WRITE_FILE | FS_READ_FILE | FS_TRUNCATE | FS_IOCTL_DEV;

// A list of the kernel's security modules, where it is mounted, has landlock even if a filter hides the calls.
static bool is_in_kernel(void)
{
    int fd = open("/sys/kernel/security/lsm", O_RDONLY | O_CLOEXEC);
    char names[512];
    ssize_t length = fd >= 0 ? read(fd, names, sizeof names - 1) : 0;

    if (fd >= 0) close(fd);
    names[length > 0 ? length : 0] = '\0';
    return strstr(names, "landlock") != NULL;
}

static const char *explain_lack(int cause)
{
    if (cause == EOPNOTSUPP) return "landlock is switched off in this kernel";
    return cause == ENOSYS && !is_in_kernel() ? "no landlock in this kernel" : "landlock is forbidden by a filter";
}

bool sandbox_landlock_open(struct sandbox_landlock *landlock, struct error *error)
{
    struct ruleset_attr attr = {.handled_access_fs = FS_ALL_OF_FIRST};
    size_t size = sizeof attr.handled_access_fs;

    *landlock = (struct sandbox_landlock){.ruleset_fd = -1};
    landlock->abi =
        (int)syscall(SYS_landlock_create_ruleset, NULL, (size_t)0, (uint32_t)LANDLOCK_CREATE_RULESET_VERSION);
    if (landlock->abi < ABI_FILES) {
        landlock->lack = explain_lack(errno);
        landlock->abi = 0;
        return true;
    }
    if (landlock->abi >= ABI_REFER) attr.handled_access_fs |= FS_REFER;
    if (landlock->abi >= ABI_TRUNCATE) attr.handled_access_fs |= FS_TRUNCATE;
    if (landlock->abi >= ABI_DEVICES) attr.handled_access_fs |= FS_IOCTL_DEV;
    if (landlock->abi >= ABI_NETWORK) {
        attr.handled_access_net = NET_BIND_AND_CONNECT_TCP;
        size += sizeof attr.handled_access_net;
    }
    if (landlock->abi >= ABI_SCOPES) {
        attr.scoped = SCOPE_ABSTRACT_SOCKETS_AND_SIGNALS;
        size += sizeof attr.scoped;
    }
    landlock->rights = attr.handled_access_fs;
    landlock->ruleset_fd = (int)syscall(SYS_landlock_create_ruleset, &attr, size, 0U);
    if (landlock->ruleset_fd >= 0) return true;
    error_set_errno(error, errno, "landlock");
    return false;
}

void sandbox_landlock_close(struct sandbox_landlock *landlock)
{
    if (landlock->abi && landlock->ruleset_fd >= 0) close(landlock->ruleset_fd);
    landlock->ruleset_fd = -1;
}

static uint64_t kernel_rights(unsigned rights)
{
    uint64_t kernel = 0;

    if (rights & SANDBOX_READ) kernel |= FS_READ_FILE | FS_READ_DIR;
    if (rights & SANDBOX_WRITE) kernel |= FS_WRITE_FILE | FS_TRUNCATE | FS_MAKE_REG | FS_REMOVE_FILE;
    if (rights & SANDBOX_DEVICE) kernel |= FS_READ_FILE | FS_READ_DIR | FS_WRITE_FILE | FS_TRUNCATE | FS_IOCTL_DEV;
    if (rights & SANDBOX_EXECUTE) kernel |= FS_EXECUTE;
    return kernel;
}

bool sandbox_landlock_allow(const struct sandbox_landlock *landlock, int fd, unsigned rights, struct error *error)
{
    struct landlock_path_beneath_attr rule = {.parent_fd = fd,
                                              .allowed_access = kernel_rights(rights) & landlock->rights};
    struct stat status;

    if (!landlock->abi) return true;
    if (fstat(fd, &status) == 0 && !S_ISDIR(status.st_mode)) rule.allowed_access &= file_rights;
    if (syscall(SYS_landlock_add_rule, landlock->ruleset_fd, RULE_PATH_BENEATH, &rule, 0U) == 0) return true;
    error_set_errno(error, errno, "landlock");
    return false;
}

bool sandbox_landlock_allow_path(const struct sandbox_landlock *landlock, const char *path, unsigned rights,
                                 struct error *error)
{
    int fd;
    bool ok;

    if (!landlock->abi) return true;
    fd = open(path, O_PATH | O_CLOEXEC);
    if (fd < 0) return true;
    ok = sandbox_landlock_allow(landlock, fd, rights, error);
    if (!ok) error_prefix(error, "%s", path);
    close(fd);
    return ok;
}

bool sandbox_landlock_enforce(const struct sandbox_landlock *landlock, struct error *error)
{
    if (!landlock->abi || syscall(SYS_landlock_restrict_self, landlock->ruleset_fd, 0U) == 0) return true;
    error_set_errno(error, errno, "landlock");
    return false;
}
