#!/usr/bin/env python3
"""hung_disk.py FOLDER PIDFILE PROGRAM [ARGUMENT...]: runs the program where the folder is a disk that answers nothing.

It is so for this program alone, in a mount namespace of its own, until the process in PIDFILE gets a SIGTERM: then the
folder is what it was. Status 77: nothing can be mounted here.
"""
import ctypes
import os
import signal
import sys

CLONE_NEWNS, CLONE_NEWUSER = 0x00020000, 0x10000000
MS_NOSUID, MS_NODEV, MS_REC, MS_PRIVATE, MNT_DETACH = 2, 4, 0x4000, 1 << 18, 2
PR_SET_PDEATHSIG = 1
libc = ctypes.CDLL(None, use_errno=True)


def check(result):
    if result != 0:
        print(f"skip: no file system can be mounted here: {os.strerror(ctypes.get_errno())}", file=sys.stderr)
        sys.exit(77)


def enter_namespace():
    uid, gid = os.getuid(), os.getgid()
    check(libc.unshare(CLONE_NEWNS if uid == 0 else CLONE_NEWNS | CLONE_NEWUSER))
    if uid != 0:
        for name, text in ("setgroups", "deny"), ("uid_map", f"{uid} {uid} 1"), ("gid_map", f"{gid} {gid} 1"):
            with open(f"/proc/self/{name}", "w", encoding="ascii") as file:
                file.write(text)
    check(libc.mount(b"none", b"/", None, MS_REC | MS_PRIVATE, None))


def mount_hung(folder):
    """A FUSE whose server reads no request. Returns its descriptor."""
    try:
        fd = os.open("/dev/fuse", os.O_RDWR)
    except OSError as error:
        print(f"skip: no file system can be mounted here: {error}", file=sys.stderr)
        sys.exit(77)
    options = f"fd={fd},rootmode=40000,user_id={os.getuid()},group_id={os.getgid()}"
    if os.getuid() == 0:
        options += ",allow_other"
    check(libc.mount(b"hung", folder.encode(), b"fuse", MS_NOSUID | MS_NODEV, options.encode()))
    return fd


def hold(folder, fd, parent):
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})
    libc.prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() == parent:
        signal.sigwait({signal.SIGTERM})
    libc.umount2(folder.encode(), MNT_DETACH)
    os.close(fd)
    os._exit(0)


def main():
    folder, pid_file = sys.argv[1:3]
    enter_namespace()
    fd = mount_hung(folder)
    parent = os.getpid()
    pid = os.fork()
    if pid == 0:
        hold(folder, fd, parent)
    os.close(fd)
    with open(pid_file, "w", encoding="ascii") as file:
        file.write(str(pid))
    os.execv(sys.argv[3], sys.argv[3:])


main()
