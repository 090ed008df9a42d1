"""What must hold, looked at from outside: files, and the rows of the store, which is read while no daemon runs."""
import json
import os
import re
import sqlite3
import struct
import zlib

# As the store writes the states of frames; 1 is a publishing that was not finished.
SUCCEEDED, FAILED, SKIPPED = 2, 3, 5
STORED = {"succeeded": SUCCEEDED, "failed": FAILED, "skipped": SKIPPED}
CHANNEL_BYTES = (4, 2, 4)  # of the EXR types uint, half and float
NO_COMPRESSION, ZIPS, ZIP = 0, 2, 3


def exr_attributes(content):
    """The header of a whole scan-line EXR file; ValueError where it is not whole."""
    if content[:4] != b"v/1\x01":
        raise ValueError("no EXR file")
    place, found = 8, {}
    while content[place]:
        ends = content.index(b"\0", place)
        name, place = content[place:ends].decode(), ends + 1
        ends = content.index(b"\0", place)
        kind, place = content[place:ends].decode(), ends + 1
        size = struct.unpack_from("<i", content, place)[0]
        value, place = content[place + 4:place + 4 + size], place + 4 + size
        found[name] = struct.unpack("<i", value)[0] if kind == "int" else value
    check_chunks(content, place + 1, found)
    return found


def pixel_bytes(channels):
    """Of one pixel with all channels."""
    place, count = 0, 0
    while channels[place]:
        place = channels.index(b"\0", place) + 1
        count += CHANNEL_BYTES[struct.unpack_from("<i", channels, place)[0]]
        place += 16
    return count


def check_chunks(content, place, header):
    """Each chunk is there, has its line's number, and unpacks to its size."""
    left, top, right, bottom = struct.unpack_from("<4i", header["dataWindow"])
    packing = header["compression"][0]
    lines = {NO_COMPRESSION: 1, ZIPS: 1, ZIP: 16}[packing]
    line_bytes = (right - left + 1) * pixel_bytes(header["channels"])
    firsts = range(top, bottom + 1, lines)
    for first, offset in zip(firsts, struct.unpack_from(f"<{len(firsts)}Q", content, place)):
        line, size = struct.unpack_from("<ii", content, offset)
        chunk, whole = content[offset + 8:offset + 8 + size], line_bytes * min(lines, bottom + 1 - first)
        if line != first or len(chunk) != size:
            raise ValueError(f"the chunk of line {first} is missing")
        if (len(zlib.decompress(chunk)) if size < whole else size) != whole:
            raise ValueError(f"the chunk of line {first} is damaged")


def wrong_content(path, job, frame):
    """What is wrong with a frame's file; None: nothing."""
    with open(path, "rb") as file:
        content = file.read()
    if content == b"frame %d of job %d\n" % (frame, job):  # the stub's
        return None
    try:
        attributes = exr_attributes(content)
    except (ValueError, IndexError, KeyError, struct.error, zlib.error) as error:
        return f"is not whole: {error}"
    shown = attributes.get("marchd:frame"), attributes.get("marchd:job", b"").decode()
    if shown != (frame, str(job)):
        return f"shows frame {shown[0]} of job {shown[1]}"
    return None


def read_store(path):
    """Jobs by id: their output pattern, and the rows of their frames by number."""
    store = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    jobs = {}
    for number, text in store.execute("SELECT job, text FROM document"):
        document = json.loads(text)
        first = int(document["frames"].split("-")[0])
        jobs[number] = {"pattern": document["output"]["path"], "first": first, "frames": {}}
    for job, index, state, inode, size in store.execute("SELECT job, frame_index, state, inode, size_bytes FROM frame"):
        if job in jobs:
            jobs[job]["frames"][jobs[job]["first"] + index] = (state, inode, size)
    check = store.execute("PRAGMA integrity_check").fetchone()[0]
    store.close()
    return jobs, check


def is_of(pattern, path):
    """Whether the path is one of the pattern's files."""
    first, last = pattern.split("####")
    return re.fullmatch(re.escape(first) + "[0-9]{4,}" + re.escape(last), path) is not None


def files_below(folders):
    return {os.path.join(folder, name): os.lstat(os.path.join(folder, name))
            for root in folders for folder, _, names in os.walk(root) for name in names}


class Audit:
    def __init__(self):
        self.published = self.checked = 0
        self.found = {"lost": [], "published twice": [], "broken": [], "left over": [], "promises": []}

    def note(self, kind, text):
        self.found[kind].append(text)

    def failures(self):
        return [f"{kind}: {text}" for kind, texts in self.found.items() for text in texts]

    def check_frame(self, path, status, row, number, frame, books):
        _, inode, size = row
        self.checked += 1
        is_same = (status.st_ino, status.st_size) == (inode & (1 << 64) - 1, size)
        if row[0] == SUCCEEDED and not is_same and path not in books.replaced:
            self.note("broken", f"{path}: inode {status.st_ino}, {status.st_size} bytes; its row: {inode}, {size}")
        wrong = wrong_content(path, number, frame)
        if wrong:
            self.note("broken", f"{path} {wrong}")

    def check_job(self, number, row, said, files, books):
        told = set()
        for frame, cells in row["frames"].items():
            path = row["pattern"].replace("####", f"{frame:04}")
            if cells[0] in (SUCCEEDED, SKIPPED):
                told.add(path)
                if path in files:
                    self.check_frame(path, files[path], cells, number, frame, books)
                elif number not in books.robbed:
                    self.note("lost", f"{path}: job {number} tells of it, and it is not there")
            elif cells[0] == 1:
                self.note("promises", f"{path}: a publishing was not finished")
        if said["state"] == "succeeded" and len(told) != said["frames"] and number not in books.robbed:
            self.note("lost", f"job {number} succeeded with {len(told)} of {said['frames']} frames")
        for path in files:
            is_older = said["state"] == "canceled" and number in books.retried
            is_excused = number in books.robbed or path in books.unknown or is_older
            if path not in told and is_of(row["pattern"], path) and not is_excused:
                self.note("left over", f"{path}: job {number} tells nothing of it")

    def check_list(self, rows, frames):
        """`frames`: what job.frames told of each, by job and frame."""
        for (number, frame), told in frames.items():
            state = rows[number]["frames"].get(frame, (0,))[0] if number in rows else 0
            if STORED.get(told["state"], 0) != (state if state in STORED.values() else 0):
                self.note("promises", f"frame {frame} of job {number} is {told['state']} in the list, {state} in the store")
            if told["path"] and number in rows and told["path"] != rows[number]["pattern"].replace("####", f"{frame:04}"):
                self.note("promises", f"frame {frame} of job {number} is told as {told['path']}")

    def run(self, store_path, roots, said, frames, books, names):
        """`said`, `frames`: what the daemon told before it ended. `books`: what the campaign asked for."""
        files = files_below(roots)
        rows, check = read_store(store_path)
        if check != "ok":
            self.note("promises", f"the store: {check}")
        if set(rows) != {job["id"] for job in said}:
            others = sorted(set(rows) ^ {job["id"] for job in said})
            self.note("promises", f"the store has other jobs than the list: {others}")
        for job in said:
            if job["id"] in rows:
                self.check_job(job["id"], rows[job["id"]], job, files, books)
        self.check_list(rows, frames)
        for path in files:
            if path.endswith(".part") and not books.is_foreign(path):
                self.note("left over", path)
        self.check_books({job["id"]: job for job in said}, rows, files, books)
        self.check_names(names, books)

    def check_books(self, said, rows, files, books):
        for number in books.accepted - books.deleted - books.forgotten - books.maybe_deleted:
            if number not in said:
                self.note("lost", f"job {number} was accepted, and nobody knows it")
        for number in books.deleted & set(said):
            self.note("promises", f"job {number} was deleted, and is there again")
        for number in books.canceled & set(said):
            if said[number]["state"] != "canceled":
                self.note("promises", f"job {number} was canceled, and is {said[number]['state']}")
        patterns = {row["pattern"] for row in rows.values()}
        for pattern in books.refused & patterns:
            self.note("promises", f"{pattern}: the job was refused, and is there")
        for path, text in books.foreign.items():
            if path not in files:
                self.note("promises", f"{path}, a file of somebody else, is gone")
            else:
                with open(path, encoding="utf-8") as file:
                    if file.read() != text:
                        self.note("promises", f"{path}, a file of somebody else, was changed")
        for path in books.kept_files - set(files):
            self.note("lost", f"{path}: its job was deleted without files")
        for path in books.removed_files & set(files):
            self.note("left over", f"{path}: its job was deleted with files")

    def check_names(self, names, books):
        held = {}
        for inode, path in names:
            held.setdefault(path, []).append(inode)
        self.published = len(names)
        for path, inodes in held.items():
            if len(inodes) > 1 and not books.may_be_published_twice(path):
                self.note("published twice", f"{path} had the inodes {', '.join(inodes)}")
