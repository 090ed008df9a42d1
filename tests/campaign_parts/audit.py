"""What must hold, looked at from outside: files, and the rows of the store, which is read while no daemon runs."""
import json
import os
import sqlite3
import struct

SUCCEEDED, SKIPPED = 2, 5  # as the store writes the states of frames; 1 is a publishing that was not finished


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
    top, bottom = struct.unpack_from("<4i", found["dataWindow"])[1::2]
    lines = {0: 1, 2: 1, 3: 16}.get(found["compression"][0], 16)
    count = (bottom - top) // lines + 1
    for offset in struct.unpack_from(f"<{count}Q", content, place + 1):
        size = struct.unpack_from("<i", content, offset + 4)[0] if 0 < offset <= len(content) - 8 else len(content)
        if offset + 8 + size > len(content):
            raise ValueError("a chunk is missing")
    return found


def wrong_content(path, frame):
    """What is wrong with a frame's file; None: nothing."""
    with open(path, "rb") as file:
        content = file.read()
    if content == b"frame %d\n" % frame:  # the stub's
        return None
    try:
        attributes = exr_attributes(content)
    except (ValueError, IndexError, KeyError, struct.error) as error:
        return f"is not whole: {error}"
    if attributes.get("marchd:frame") != frame:
        return f"shows frame {attributes.get('marchd:frame')}"
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

    def check_frame(self, path, status, row, frame):
        _, inode, size = row
        self.checked += 1
        if row[0] == SUCCEEDED and (status.st_ino, status.st_size) != (inode & (1 << 64) - 1, size):
            self.note("broken", f"{path}: inode {status.st_ino}, {status.st_size} bytes; its row: {inode}, {size}")
        wrong = wrong_content(path, frame)
        if wrong:
            self.note("broken", f"{path} {wrong}")

    def check_job(self, number, row, said, files, books):
        told = set()
        for frame, cells in row["frames"].items():
            path = row["pattern"].replace("####", f"{frame:04}")
            if cells[0] in (SUCCEEDED, SKIPPED):
                told.add(path)
                if path in files:
                    self.check_frame(path, files[path], cells, frame)
                elif number not in books.robbed:
                    self.note("lost", f"{path}: job {number} tells of it, and it is not there")
            elif cells[0] == 1:
                self.note("promises", f"{path}: a publishing was not finished")
        if said["state"] == "succeeded" and len(told) != said["frames"] and number not in books.robbed:
            self.note("lost", f"job {number} succeeded with {len(told)} of {said['frames']} frames")
        folder = os.path.dirname(row["pattern"]) + "/"
        for path in files:
            if path.startswith(folder) and path.endswith(".exr") and path not in told and number not in books.robbed:
                self.note("left over", f"{path}: job {number} tells nothing of it")

    def run(self, store_path, roots, said, books, names):
        """`said`: what job.list told before the daemon ended. `books`: what the campaign asked for."""
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
        for path in files:
            if path.endswith(".part") and path not in books.foreign:
                self.note("left over", path)
        self.check_books({job["id"]: job for job in said}, rows, files, books)
        self.check_names(names, books)

    def check_books(self, said, rows, files, books):
        for number in books.accepted - books.deleted:
            if number not in said and number not in books.maybe_deleted:
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
            if len(inodes) > 1 and os.path.dirname(path) not in books.again:
                self.note("published twice", f"{path} had the inodes {', '.join(inodes)}")
