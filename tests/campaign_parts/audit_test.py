"""The audit notices each way in which a farm could break its promises: one made-up farm, or story, for each."""
import json
import os
import sqlite3
import struct
import sys
import tempfile
import unittest
import unittest.mock
import zlib

sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
from acts import Acts  # noqa: E402
from audit import Audit  # noqa: E402
from books import Books  # noqa: E402
from listener import EventAudit  # noqa: E402


def exr_file(frame, job):
    """Two lines of a hundred pixels: one is packed, one did not get smaller."""
    attributes = (("compression", "compression", b"\x02"), ("dataWindow", "box2i", struct.pack("<4i", 0, 0, 99, 1)),
                  ("channels", "chlist", b"R\0" + struct.pack("<i4x2i", 1, 1, 1) + b"\0"),
                  ("marchd:frame", "int", struct.pack("<i", frame)), ("marchd:job", "string", str(job).encode()))
    head = b"v/1\x01\x02\0\0\0" + b"".join(
        name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
        for name, kind, value in attributes) + b"\0"
    lines = [struct.pack("<ii", line, len(pixels)) + pixels
             for line, pixels in enumerate((zlib.compress(bytes(200)), bytes(range(200))))]
    first = len(head) + 16
    return head + struct.pack("<2Q", first, first + len(lines[0])) + b"".join(lines)


class MadeUpFarm(unittest.TestCase):
    """A farm of one job with two frames, both published."""

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = f"{self.scratch.name}/a"
        self.paths = [f"{self.folder}/s.{frame:04}.exr" for frame in (1, 2)]
        os.mkdir(self.folder)
        for frame, path in enumerate(self.paths, 1):
            self.write(path, f"frame {frame} of job 7\n")
        self.store = f"{self.scratch.name}.db"
        database = sqlite3.connect(self.store)
        database.execute("CREATE TABLE document (job, text)")
        database.execute("CREATE TABLE frame (job, frame_index, state, inode, size_bytes)")
        document = {"frames": "1-2", "output": {"path": f"{self.folder}/s.####.exr"}}
        database.execute("INSERT INTO document VALUES (7, ?)", [json.dumps(document)])
        for index, path in enumerate(self.paths):
            status = os.stat(path)
            database.execute("INSERT INTO frame VALUES (7, ?, 2, ?, ?)", (index, status.st_ino, status.st_size))
        database.commit()
        database.close()
        self.said = [{"id": 7, "state": "succeeded", "frames": 2}]
        self.frames = {(7, frame): {"state": "succeeded", "path": path} for frame, path in enumerate(self.paths, 1)}
        self.names = [[str(os.stat(path).st_ino), path] for path in self.paths]
        self.books = Books()
        self.books.accepted.add(7)

    def tearDown(self):
        os.remove(self.store)
        self.scratch.cleanup()

    @staticmethod
    def write(path, text):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def change_row(self, statement):
        database = sqlite3.connect(self.store)
        database.execute(statement)
        database.commit()
        database.close()

    def found(self):
        audit = Audit()
        audit.run(self.store, [self.scratch.name], self.said, self.frames, self.books, self.names)
        return {kind for kind, texts in audit.found.items() if texts}

    def test_a_farm_that_is_well(self):
        self.assertEqual(self.found(), set())

    def test_a_file_is_missing(self):
        os.remove(self.paths[1])
        self.assertEqual(self.found(), {"lost"})

    def test_a_row_is_missing(self):
        self.change_row("DELETE FROM frame WHERE frame_index = 1")
        self.assertEqual(self.found(), {"lost", "left over", "promises"})

    def test_another_file_of_the_same_content(self):
        os.rename(self.paths[0], f"{self.scratch.name}/held.txt")
        self.write(self.paths[0], "frame 1 of job 7\n")
        self.assertEqual(self.found(), {"broken"})

    def test_a_torn_file(self):
        self.write(self.paths[0], "fram")
        self.assertEqual(self.found(), {"broken"})

    def put_picture(self, content):
        with open(self.paths[0], "wb") as file:
            file.write(content)
        self.change_row(f"UPDATE frame SET size_bytes = {len(content)} WHERE frame_index = 0")

    def test_a_picture(self):
        self.put_picture(exr_file(1, 7))
        self.assertEqual(self.found(), set())

    def test_a_torn_picture(self):
        for length in (20, 300, len(exr_file(1, 7)) - 1):
            self.put_picture(exr_file(1, 7)[:length])
            self.assertEqual(self.found(), {"broken"})

    def test_a_picture_with_damaged_pixels(self):
        content = bytearray(exr_file(1, 7))
        content[content.index(zlib.compress(bytes(200))) + 5] ^= 1
        self.put_picture(content)
        self.assertEqual(self.found(), {"broken"})

    def test_the_picture_of_another_frame_or_job(self):
        for picture in (exr_file(2, 7), exr_file(1, 8)):
            self.put_picture(picture)
            self.assertEqual(self.found(), {"broken"})

    def test_the_content_of_another_frame_or_job(self):
        for text in ("frame 2 of job 7\n", "frame 1 of job 8\n"):
            self.write(self.paths[0], text)
            self.assertEqual(self.found(), {"broken"})

    def test_a_list_that_says_otherwise(self):
        self.frames[7, 1]["state"] = "failed"
        self.assertEqual(self.found(), {"promises"})
        self.frames[7, 1] = {"state": "succeeded", "path": self.paths[1]}
        self.assertEqual(self.found(), {"promises"})

    def test_a_part_file(self):
        self.write(f"{self.folder}/s.0001.exr.7.1.1.part", "")
        self.assertEqual(self.found(), {"left over"})

    def test_a_name_that_held_two_files(self):
        self.names.append(["1", self.paths[0]])
        self.assertEqual(self.found(), {"published twice"})

    def test_a_publishing_cut_short(self):
        self.change_row("UPDATE frame SET state = 1 WHERE frame_index = 1")
        self.assertIn("promises", self.found())

    def test_an_accepted_job_that_nobody_knows(self):
        self.books.accepted.add(8)
        self.assertEqual(self.found(), {"lost"})

    def test_a_deleted_job_that_is_there_again(self):
        self.books.deleted.add(7)
        self.assertEqual(self.found(), {"promises"})

    def test_a_canceled_job_that_went_on(self):
        self.books.canceled.add(7)
        self.assertEqual(self.found(), {"promises"})

    def test_a_refused_job_that_is_there(self):
        self.books.refused.add(f"{self.folder}/s.####.exr")
        self.assertEqual(self.found(), {"promises"})

    def test_files_of_somebody_else(self):
        self.books.foreign = {f"{self.folder}/notes.txt": "mine"}
        self.assertEqual(self.found(), {"promises"})
        self.write(f"{self.folder}/notes.txt", "not mine")
        self.assertEqual(self.found(), {"promises"})

    def test_files_of_deleted_jobs(self):
        self.books.kept_files = {f"{self.folder}/s.0003.exr"}
        self.assertEqual(self.found(), {"lost"})
        self.books.kept_files, self.books.removed_files = set(), {self.paths[0]}
        self.assertEqual(self.found(), {"left over"})

    def test_files_of_frames_that_were_queued_again_and_canceled(self):
        self.change_row("DELETE FROM frame WHERE frame_index = 0")
        self.said[0]["state"] = "canceled"
        self.books.canceled.add(7)
        self.assertIn("left over", self.found())
        self.books.retried.add(7)
        self.assertEqual(self.found() & {"left over"}, set())

    def test_what_a_restored_backup_excuses(self):
        then = Books()
        self.books.accepted.add(8)
        self.books.canceled.add(7)
        self.books.deleted.add(7)
        self.books.jobs[7] = {"folder": self.folder}
        then.accepted.add(7)
        self.books.return_to(then, self.names, self.names + [["1", self.paths[0]]])
        self.names.append(["1", self.paths[0]])
        self.change_row("UPDATE frame SET inode = 1 WHERE frame_index = 0")
        self.assertEqual(self.found(), set())
        self.change_row("DELETE FROM frame WHERE frame_index = 0")
        self.assertEqual(self.found() & {"left over"}, set())
        self.change_row("UPDATE frame SET inode = 1 WHERE frame_index = 1")
        self.assertEqual(self.found() & {"broken", "left over"}, {"broken"})
        self.change_row("DELETE FROM frame WHERE frame_index = 1")
        self.assertIn("left over", self.found())


class Stories(unittest.TestCase):
    """What a daemon could tell in its events."""

    def setUp(self):
        self.audit = EventAudit()

    def tell(self, *story):
        for state, attempt in story:
            self.audit.note({"type": "frame", "id": 7, "frame": 1, "state": state, "attempt": attempt})
        return len(self.audit.wrong)

    def test_in_order(self):
        self.assertEqual(self.tell(("running", 1), ("queued", 1), ("running", 2), ("running", 4), ("succeeded", 4)), 0)
        self.audit.compare({(7, 1): "succeeded"})
        self.audit.compare_names({(7, 1): "/a/s"}, {"/a/s": 1}, Books())
        self.assertEqual(self.audit.wrong, [])

    def test_a_file_that_its_root_took_away_and_brought_back(self):
        self.assertEqual(self.tell(("running", 1), ("queued", 1), ("succeeded", 1)), 0)
        self.assertEqual(self.tell(("succeeded", 1)), 1)

    def test_one_end_twice(self):
        self.assertEqual(self.tell(("running", 1), ("succeeded", 1), ("succeeded", 1)), 1)

    def test_an_attempt_twice(self):
        self.assertEqual(self.tell(("running", 1), ("running", 1)), 1)

    def test_an_end_of_an_earlier_attempt(self):
        self.assertEqual(self.tell(("running", 1), ("running", 2), ("queued", 1)), 1)

    def test_a_frame_that_began_after_its_end(self):
        self.assertEqual(self.tell(("running", 2), ("succeeded", 2), ("running", 2)), 1)

    def test_a_frame_that_succeeded_twice(self):
        self.tell(("running", 1), ("succeeded", 1), ("running", 2), ("succeeded", 2))
        self.audit.compare_names({(7, 1): "/a/s"}, {"/a/s": 2}, Books())
        self.assertEqual(len(self.audit.wrong), 1)

    def test_a_success_that_a_killed_daemon_had_told(self):
        self.tell(("running", 1), ("succeeded", 1))
        self.audit.begin_session()
        self.assertEqual(self.tell(("succeeded", 1)), 0)
        self.audit.compare_names({(7, 1): "/a/s"}, {"/a/s": 1}, Books())
        self.assertEqual(self.audit.wrong, [])
        self.audit.begin_session()
        self.tell(("running", 2), ("succeeded", 2))
        self.audit.compare_names({(7, 1): "/a/s"}, {"/a/s": 1}, Books())
        self.assertEqual(len(self.audit.wrong), 2)

    def test_a_success_without_a_file(self):
        self.tell(("running", 1), ("succeeded", 1))
        self.audit.compare_names({(7, 1): "/a/s"}, {}, Books())
        self.assertEqual(len(self.audit.wrong), 1)

    def test_an_end_that_is_not_told(self):
        self.tell(("running", 1))
        self.audit.compare({(7, 1): "succeeded"})
        self.assertEqual(len(self.audit.wrong), 1)

    def test_a_list_that_says_otherwise(self):
        self.tell(("running", 1), ("failed", 1))
        self.audit.compare({(7, 1): "queued"})
        self.assertEqual(len(self.audit.wrong), 1)

    def test_a_job_after_its_deletion(self):
        self.audit.note({"type": "deleted", "id": 7})
        self.assertEqual(self.tell(("running", 1)), 1)

    def test_counts_that_do_not_add_up(self):
        job = {"id": 7, "state": "succeeded", "frames": 2, "queued": 0, "running": 0, "succeeded": 1, "failed": 0,
               "canceled": 1, "skipped": 0}
        self.audit.note({"type": "job", "job": job})
        self.assertEqual(len(self.audit.wrong), 1)
        self.audit.note({"type": "job", "job": dict(job, canceled=0)})
        self.assertEqual(len(self.audit.wrong), 3)


class Choices(unittest.TestCase):
    @staticmethod
    def acts(seed, draws):
        """The names of acts, and a number that each draws. `draws`: how much an act draws, which depends on the farm."""
        acts = Acts(unittest.mock.MagicMock(), unittest.mock.MagicMock(), seed, f"{sys.path[0]}/../..")
        return [(acts.choose().__name__, acts.random.random(), [acts.random.random() for _ in range(draws)])[:2]
                for _ in range(200)]

    def test_a_seed_repeats_its_acts(self):
        self.assertEqual(self.acts(5, 0), self.acts(5, 3))
        self.assertNotEqual(self.acts(5, 0), self.acts(6, 0))


if __name__ == "__main__":
    unittest.main()
