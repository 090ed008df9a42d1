"""The audit notices each way in which a farm could break its promises: one made-up farm for each."""
import json
import os
import sqlite3
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
from acts import Books  # noqa: E402
from audit import Audit  # noqa: E402


class MadeUpFarm(unittest.TestCase):
    """A farm of one job with two frames, both published."""

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = f"{self.scratch.name}/a"
        self.paths = [f"{self.folder}/s.{frame:04}.exr" for frame in (1, 2)]
        os.mkdir(self.folder)
        for frame, path in enumerate(self.paths, 1):
            self.write(path, f"frame {frame}\n")
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
        audit.run(self.store, [self.scratch.name], self.said, self.books, self.names)
        return {kind for kind, texts in audit.found.items() if texts}

    def test_a_farm_that_is_well(self):
        self.assertEqual(self.found(), set())

    def test_a_file_is_missing(self):
        os.remove(self.paths[1])
        self.assertEqual(self.found(), {"lost"})

    def test_a_row_is_missing(self):
        self.change_row("DELETE FROM frame WHERE frame_index = 1")
        self.assertEqual(self.found(), {"lost", "left over"})

    def test_another_file_of_the_same_content(self):
        os.rename(self.paths[0], f"{self.scratch.name}/held.txt")
        self.write(self.paths[0], "frame 1\n")
        self.assertEqual(self.found(), {"broken"})

    def test_a_torn_file(self):
        self.write(self.paths[0], "fram")
        self.assertEqual(self.found(), {"broken"})

    def test_a_torn_picture(self):
        with open(self.paths[0], "wb") as file:
            file.write(b"v/1\x01\x02\x00\x00\x00compression\x00")
        self.change_row(f"UPDATE frame SET size_bytes = {os.stat(self.paths[0]).st_size} WHERE frame_index = 0")
        self.assertEqual(self.found(), {"broken"})

    def test_the_content_of_another_frame(self):
        self.write(self.paths[0], "frame 2\n")
        self.assertEqual(self.found(), {"broken"})

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


if __name__ == "__main__":
    unittest.main()
