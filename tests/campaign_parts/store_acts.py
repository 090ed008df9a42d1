"""What happens to the store: bits that flip, a file that is lost, copies that are made and put back."""
import contextlib
import copy
import os
import signal
import sqlite3
import subprocess

from farm import PATIENCE_S, Failure

SQLITE_HEADER_BYTES = 100


class StoreActs:
    def make_well(self):
        """What is broken is mended, and the daemon has seen it."""
        self.end_conditions()
        self.machine.mend()
        self.farm.ensure()
        self.farm.await_answer()
        if self.is_flipped:
            self.stop_daemon()
        self.farm.wait("the store commits again", lambda: self.farm.get("daemon.status")["store"]["state"] == "ok")

    def do(self, *words):
        """A command that has to succeed on a machine that is well."""
        status, said = self.farm.do(*words)
        if status:
            raise Failure(f"march {' '.join(words)} ended with status {status}: {said}")

    # Copies

    def back_up(self):
        path = f"{self.farm.folder}/copy.db"
        names = self.machine.names_given()
        status, said = self.farm.do("backup", path, self.farm.state)
        if not status:
            self.copy = (path, copy.deepcopy(self.books), names)
        elif self.farm.is_up and not self.machine.is_state_hurt() and not self.is_flipped:
            self.wrong.append(f"march backup ended with status {status}: {said}")

    def restore(self):
        """The farm is again what it was at the backup. What was asked since is forgotten, but no id is given again."""
        if not self.copy:
            return
        self.make_well()
        self.farm.stop(signal.SIGTERM)
        path, books, names = self.copy
        self.do("restore", path, self.farm.state)
        self.books.return_to(books, names, self.machine.names_given())
        self.start_again()

    def keep_backup(self):
        """The copy that the daemon keeps for itself is of now."""
        self.do("backup", f"{self.farm.state}/backup.db", self.farm.state)

    # Damage

    def flip(self, place):
        with open(self.farm.store, "r+b", buffering=0) as file:
            file.seek(place)
            byte = file.read(1)[0]
            file.seek(place)
            file.write(bytes([byte ^ 1 << self.random.randrange(8)]))

    def flip_bit_while_down(self):
        """Any bit: nothing may have changed."""
        self.make_well()
        self.farm.stop(signal.SIGTERM)
        self.keep_backup()
        share = self.random.random()
        size = os.path.getsize(self.farm.store)
        self.flip(SQLITE_HEADER_BYTES + int(share * (size - SQLITE_HEADER_BYTES)))
        self.start_again()

    def any_cell(self):
        """The job and a text of some row; None: there is none, or it cannot be read now."""
        table, column = self.random.choice((("frame", "hash"), ("document", "text"), ("attempt", "log")))
        share = self.random.random()
        try:
            with contextlib.closing(sqlite3.connect(f"file:{self.farm.store}?mode=ro", uri=True)) as store:
                rows = store.execute(f"SELECT job, {column} FROM {table} WHERE {column} > ''").fetchall()
        except sqlite3.Error:
            return None
        return rows[int(share * len(rows))] if rows else None

    def flip_bit_while_it_runs(self):
        """A bit of a row: the row is restored."""
        self.make_well()
        cell = self.any_cell()
        if not cell:
            return
        self.keep_backup()
        with open(self.farm.store, "rb") as file:
            place = file.read().find(cell[1].encode())
        share = self.random.random()
        # A frame has numbers before its hash: its size and its inode.
        begin, length = (-8, 40) if len(cell[1]) == 32 else (0, min(len(cell[1]), 500))
        if place > 0:
            self.flip(place + begin + int(share * length))
            self.is_flipped = True
            if cell[0] in self.books.jobs:
                self.books.again.add(self.books.jobs[cell[0]]["folder"])

    def lose_store(self):
        """A start without its store asks, and makes none."""
        self.make_well()
        self.farm.stop(signal.SIGTERM)
        os.rename(self.farm.store, f"{self.farm.state}.away.db")
        self.farm.spawn(self.progress_limit_s())
        try:
            status = self.farm.process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            raise Failure("a daemon without its store runs") from None
        if status != 2 or os.path.exists(self.farm.store):
            self.wrong.append(f"a start without its store ended with status {status}, expected 2 and no new store")
        os.rename(f"{self.farm.state}.away.db", self.farm.store)
        self.start_again()
