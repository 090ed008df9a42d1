"""The machine below the farm: two small disks that can be taken away, filled, slowed and torn, and a clock that jumps.

Without the right to mount, the disks are ordinary folders: nothing is unmounted or filled, and the table says so.
"""
import ctypes
import mmap
import os
import struct

LIBC = ctypes.CDLL(None, use_errno=True)
MS_BIND, MNT_DETACH = 4096, 2
DISK_BYTES = 24 << 20
DISK_FIELDS = ("device", "delay_us", "one_write_in", "one_sync_in", "one_rename_in", "late_us", "one_lost_rename_in",
               "one_tear_in")
STATE, OUTPUT = 0, 1


def mount(source, target, kind, flags, options):
    if LIBC.mount(source.encode(), target.encode(), kind.encode(), flags, options.encode()):
        raise OSError(ctypes.get_errno(), f"mount {target}: {os.strerror(ctypes.get_errno())}")


class Disk:
    """`path` is where the farm sees it. A tmpfs lies below `real`, and is bound to `path`."""

    def __init__(self, folder, name, can_mount):
        self.path, self.real, self.can_mount = f"{folder}/{name}", f"{folder}/{name}.disk", can_mount
        self.place = self.real if can_mount else self.path  # which is always there
        self.ballast = f"{self.real}/ballast"
        os.mkdir(self.path)
        if can_mount:
            os.mkdir(self.real)
            mount("campaign", self.real, "tmpfs", 0, f"size={DISK_BYTES},mode=755")
            self.is_there = False
            self.bring_back()
        self.is_there = True

    def take_away(self):
        if LIBC.umount2(self.path.encode(), MNT_DETACH):
            raise OSError(ctypes.get_errno(), f"umount {self.path}")
        self.is_there = False

    def bring_back(self):
        if not self.is_there:
            mount(self.real, self.path, "", MS_BIND, "")
            self.is_there = True

    def fill(self):
        with open(self.ballast, "ab", buffering=0) as file:
            for size in (1 << 20, 4096):
                try:
                    while file.write(bytes(size)) == size:
                        pass
                except OSError:
                    pass

    def empty(self):
        if os.path.exists(self.ballast):
            os.remove(self.ballast)


class Machine:
    def __init__(self, folder, programs, can_mount):
        self.can_mount = can_mount
        self.disks = [Disk(folder, "state", can_mount), Disk(folder, "out", can_mount)]
        self.folder, self.names = folder, f"{folder}/names"
        control = f"{folder}/machine"
        with open(control, "wb") as file:
            file.write(bytes(8 * (1 + 2 * len(DISK_FIELDS))))
        with open(control, "r+b") as file:
            self.control = mmap.mmap(file.fileno(), 0)
        self.fields, self.seen = [{}, {}], [set(), set()]
        self.network = {}  # how the output's disk answers as one of a network, which is no fault
        self.mend()
        self.environment = {"LD_PRELOAD": f"{programs}/libmachine_shim.so", "LD_MACHINE_SHIM": control,
                            "LD_MACHINE_NAMES": self.names}

    def _put(self, index, value):
        struct.pack_into("q", self.control, 8 * index, value)

    def set_clock(self, ahead_ms):
        self._put(0, ahead_ms)

    def note_start(self):
        """A daemon begins now: it sees what is wrong from here on."""
        self.seen = [set(fields) for fields in self.fields]

    def may_have_torn(self):
        """Whether the present daemon may have been killed in the middle of a write."""
        return any("one_tear_in" in seen for seen in self.seen)

    def has_failed(self, disk):
        """Whether the present daemon may have seen the disk fail."""
        return bool(self.seen[disk])

    def is_state_hurt(self):
        """Whether the store may be unable to commit, which an ending daemon says by its status."""
        return bool(self.fields[STATE]) or os.path.exists(self.disks[STATE].ballast)

    def set_disk(self, disk, **fields):
        self.fields[disk] = fields
        self.seen[disk] |= set(fields)
        for index, name in enumerate(DISK_FIELDS):
            value = os.stat(self.disks[disk].place).st_dev if name == "device" else (
                fields.get(name) or (self.network.get(name, 0) if disk == OUTPUT else 0))
            self._put(1 + disk * len(DISK_FIELDS) + index, value)

    def set_network(self, is_far):
        """Whether what workers write is seen late, and answers to renames are lost."""
        self.network = {"late_us": 50000, "one_lost_rename_in": 7} if is_far else {}
        self.set_disk(OUTPUT, **self.fields[OUTPUT])

    def mend(self):
        """All is well again. The clock stays where it is, as clocks do."""
        for number, disk in enumerate(self.disks):
            self.set_disk(number)
            if self.can_mount:
                disk.bring_back()
                disk.empty()

    def names_given(self):
        """Pairs of inode and path, for each time that the daemon gave a file its final name."""
        if not os.path.exists(self.names):
            return []
        with open(self.names, encoding="utf-8") as file:
            names = [line.rstrip("\n").split(" ", 1) for line in file if line.endswith("\n")]
        # In a root that is taken away meanwhile a path begins at the root.
        return [(inode, path if path.startswith(self.folder) else self.disks[OUTPUT].path + path) for inode, path in names]
