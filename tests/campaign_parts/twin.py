"""A second farm, which writes into an output root of the first."""
import os
import signal

from audit import Audit
from books import Books
from farm import Farm
from machine import Machine


class Twin:
    def __init__(self, folder, programs, root):
        os.mkdir(folder)
        self.machine = Machine(folder, programs, False)
        self.farm = Farm(folder, programs, self.machine, [0], [root], workers=1)
        self.farm.set_modes("write:5 write:50 crash short")
        self.books, self.folders = Books(), set()
        self.name = f"u{folder.rsplit('.', 1)[1]}"  # of its files: one before it may have written into the same folder
        self.farm.start()

    def submit(self, document, folder, frames):
        output = dict(document["output"], path=f"{folder}/{self.name}.####.exr")
        answer = self.farm.get("job.submit", {"document": dict(document, frames=f"1-{frames}", output=output)})
        self.books.accepted.add(answer["id"])
        self.folders.add(folder)

    def kill(self):
        self.farm.stop(signal.SIGKILL)
        self.farm.start()

    def finish(self):
        """All of its jobs end, and so does it."""
        self.farm.set_modes("write:0")
        self.kill()
        self.farm.wait("all jobs of the second farm end", self.farm.all_jobs_end)
        self.farm.wait("part files of the second farm are removed", lambda: not self.parts_left())
        jobs = self.farm.jobs()
        frames = self.farm.tell_frames(jobs)
        self.farm.stop(signal.SIGTERM)
        return jobs, frames

    def parts_left(self):
        return [name for folder in self.folders if os.path.isdir(folder) for name in os.listdir(folder)
                if name.startswith(self.name + ".") and name.endswith(".part")]

    def audit(self, roots, jobs, frames, is_foreign):
        """What is wrong, of its jobs alone. No farm may run."""
        audit = Audit()
        self.books.is_foreign = is_foreign
        audit.run(self.farm.store, roots, jobs, frames, self.books, self.machine.names_given())
        return [f"of the second farm: {text}" for text in audit.failures()]
