"""A cage: whatever runs in it, is mounted in it or lies in its folder is gone when it ends, however it ends.

Processes and mounts go with namespaces of their own. Where there is no right to these, processes go with their parents
(PR_SET_PDEATHSIG). The folder is removed by a process that waits for the end of the first, so that even SIGKILL leaves
nothing. After a failure (exit status 1) the folder is kept.
"""
import ctypes
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

INSIDE = "MARCHD_CAMPAIGN_INSIDE"
LIBC = ctypes.CDLL(None)
PR_SET_PDEATHSIG = 1
FAILED, INTERRUPTED = 1, 130
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def die_with_parent():
    """For preexec_fn."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def find_way():
    """How to begin a program in namespaces of its own; empty where there is no right to any."""
    every = ["--mount", "--pid", "--fork", "--kill-child", "--mount-proc"]
    as_root = ["--user", "--map-root-user"]
    for flags in (every, as_root + every, ["--mount"], as_root + ["--mount"]) if shutil.which("unshare") else ():
        way = ["unshare"] + flags
        probe = ["sh", "-c", "folder=$(mktemp -d) && mount -t tmpfs none $folder && umount $folder; status=$?; "
                 "rmdir $folder; exit $status"]
        if subprocess.run(way + probe, capture_output=True, check=False).returncode == 0:
            return way
    return []


def begin_remover(folder):
    """A process that removes the folder when the pipe that is returned is closed, unless a byte was written to it."""
    reading, writing = os.pipe()
    pid = os.fork()
    if pid:
        os.close(reading)
        return pid, writing
    os.close(writing)
    os.setsid()
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    if not os.read(reading, 1):
        for _ in range(100):  # what is being killed may still write
            shutil.rmtree(folder, ignore_errors=True)
            if not os.path.exists(folder):
                break
            time.sleep(0.1)
    os._exit(0)


def serve_as_first():
    """The first process of a namespace buries the orphans. Returns in its child, which does the work."""
    worker = os.fork()
    if not worker:
        return
    while True:
        pid, status = os.wait()
        if pid == worker:
            os._exit(os.waitstatus_to_exitcode(status) & 255)


def run_caged():
    """Begins this program again inside, and ends with it."""
    folder = tempfile.mkdtemp(prefix="marchd-campaign.")
    os.chmod(folder, 0o755)
    remover, pipe = begin_remover(folder)
    way = find_way()
    reading, writing = os.pipe()
    is_ended = []

    def end(*_):
        is_ended.append(True)
        inside.kill()
    inside = subprocess.Popen(way + [sys.executable] + sys.argv, pass_fds=[reading],
                              env=dict(os.environ, **{INSIDE: f"{'yes' if way else 'no'}:{reading}:{folder}"}))
    os.close(reading)
    for number in SIGNALS:
        signal.signal(number, end)
    status = inside.wait()
    if status and not is_ended:
        os.write(pipe, b"k")
    os.close(writing)
    os.close(pipe)
    os.waitpid(remover, 0)
    sys.exit(INTERRUPTED if is_ended else FAILED if status < 0 else status)


def end_with(pipe):
    """Whoever changes its user loses PR_SET_PDEATHSIG: the end of the first process is the end of a pipe."""
    os.read(pipe, 1)
    os._exit(FAILED)


def enter():
    """The folder, and whether disks can be mounted. Returns inside of the cage alone."""
    if INSIDE not in os.environ:
        run_caged()
    can_mount, pipe, folder = os.environ.pop(INSIDE).split(":", 2)
    if os.getpid() == 1:
        serve_as_first()
    threading.Thread(target=end_with, args=[int(pipe)], daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process outside ends this one
    return folder, can_mount == "yes"
