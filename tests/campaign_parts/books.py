"""The books of what was asked of the farm and answered: what it has promised since."""
import os


class Books:
    """What was asked for and answered, and what a person did to the files."""

    def __init__(self):
        self.jobs = {}  # folder, root, frames, user and round of each accepted job that was not tidied up, by id
        self.accepted, self.deleted, self.maybe_deleted, self.canceled = set(), set(), set(), set()
        self.refused = set()  # patterns of jobs that were refused
        self.robbed = set()  # jobs whose folder was removed
        self.again = set()  # folders whose frames may be published again
        self.foreign = {}  # files of somebody else: text by path
        self.kept_files, self.removed_files = set(), set()
        self.forgotten = set()  # jobs that came after the backup that was restored
        self.retried = set()  # jobs whose frames were queued again after they had succeeded
        self.unknown = set()  # files that were published after it, which the store may not know
        self.replaced = set()  # files that were published again after it, so that the store has an older inode

    def return_to(self, copy, names_then, names_now):
        """The store is again what it was when these books were `copy`; files are not. The names that files had got."""
        self.jobs = {**copy.jobs, **self.jobs}
        self.forgotten |= self.accepted - copy.accepted
        self.robbed |= self.maybe_deleted - copy.maybe_deleted
        self.deleted, self.maybe_deleted = set(copy.deleted), set(copy.maybe_deleted)
        self.canceled, self.removed_files = set(copy.canceled), set(copy.removed_files)
        self.again |= {job["folder"] for job in self.jobs.values()}
        later = {path for _, path in names_now[len(names_then):]}
        self.unknown |= later
        self.replaced |= {path for _, path in names_then} & later

    def may_be_published_twice(self, path):
        """Of a job whose submit had no answer, only the names tell that a restored backup brought it back."""
        return os.path.dirname(path) in self.again or path in self.unknown

    def known(self):
        return sorted(set(self.jobs) - self.deleted - self.forgotten)

    def forget_folder(self, folder):
        """It was removed, with all that was in it."""
        self.foreign = {path: text for path, text in self.foreign.items() if os.path.dirname(path) != folder}
        self.kept_files = {path for path in self.kept_files if os.path.dirname(path) != folder}

    def is_foreign(self, path):
        """Whether a part file is none that the farm could know of."""
        folder = os.path.dirname(path)
        return path in self.foreign or folder in {self.jobs[number]["folder"] for number in self.forgotten & set(self.jobs)}
