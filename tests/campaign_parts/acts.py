"""What breaks and what clients do, one act at a time."""
import json
import os
import random
import shutil
import signal
import time

from books import Books
from client_acts import ClientActs
from farm import MANY_FILES
from machine import OUTPUT, STATE
from store_acts import StoreActs
from twin import Twin


class Acts(ClientActs, StoreActs):
    def __init__(self, farm, machine, seed, project):
        self.farm, self.machine, self.seed, self.books = farm, machine, seed, Books()
        with open(f"{project}/jobs/cloud.json", encoding="utf-8") as file:
            self.document = json.load(file)
        with open(f"{project}/tests/support/stated_quality.json", encoding="utf-8") as file:
            self.document["quality"] = json.load(file)["cloud"]
        self.document["resolution"] = [32, 18]
        self.round, self.submits, self.is_real, self.number = 0, 0, False, 0
        self.counts, self.conditions, self.idle_clients, self.waiting = {}, [], [], []
        self.unanswered = 0
        self.copy = None  # of the store: its path, the books then, the names that files had
        self.is_flipped = False  # a row may be damaged, and no start has restored it yet
        self.twin, self.twins = None, 0
        self.wrong = []  # promises broken in answers
        self.table = [
            (24, self.submit), (2, self.flood_jobs), (6, self.kill_worker), (2, self.stop_worker),
            (1, self.kill_workers), (4, self.kill_daemon), (1, self.kill_twice), (2, self.kill_all),
            (1, self.stop_daemon), (1, self.freeze_daemon), (1, self.reload), (1, self.limit_files),
            (2, self.jump_clock), (1, self.slow_disk), (1, self.fail_writes), (1, self.fail_syncs),
            (1, self.fail_renames), (1, self.tear_writes), (2, self.take_root_away), (1, self.fill_output),
            (1, self.fill_state), (1, self.lose_marker), (1, self.begin_second_farm), (1, self.rob_folder),
            (2, self.put_foreign_file), (4, self.pause), (5, self.resume), (2, self.cancel), (3, self.retry),
            (2, self.retry_a_part), (1, self.retry_by_force), (2, self.change_priority), (2, self.delete),
            (1, self.touch_others_job), (3, self.vanish), (2, self.subscribe_and_sleep), (1, self.ask_and_sleep),
            (2, self.wait_for_job), (1, self.flood_requests), (1, self.flood_documents), (2, self.talk_nonsense),
            (2, self.back_up), (1, self.restore), (1, self.flip_bit_while_down), (1, self.flip_bit_while_it_runs),
            (1, self.lose_store)]
        self.needs_mount = (self.take_root_away, self.fill_output, self.fill_state)

    # One act

    def choose(self):
        """The next act. Its choices come from the seed and its number alone, whatever the acts before it met."""
        self.number += 1
        self.random = random.Random(f"{self.seed}/{self.number}")
        return self.random.choices([act for _, act in self.table], [weight for weight, _ in self.table])[0]

    def act(self):
        self.end_conditions(one_step=True)
        self.farm.ensure()
        act = self.choose()
        with open(f"{self.farm.folder}/acts", "a", encoding="utf-8") as file:
            print(self.number, act.__name__, file=file)
        if act in self.needs_mount and not self.machine.can_mount:
            return
        self.counts[act.__name__] = self.counts.get(act.__name__, 0) + 1
        act()
        time.sleep(self.random.random() * 0.08)

    def condition(self, end):
        """`end` is called after some more acts."""
        self.conditions.append([self.random.randint(2, 8), end])

    def end_conditions(self, one_step=False):
        for condition in list(self.conditions):
            condition[0] -= 1
            if condition[0] <= 0 or not one_step:
                self.conditions.remove(condition)
                condition[1]()

    def calm_down(self):
        """Whatever was broken is whole again."""
        self.end_conditions()
        self.machine.mend()
        for client in self.idle_clients:
            client.close()
        self.idle_clients = []
        for pid in self.farm.worker_pids():
            self.send_signal(pid, signal.SIGCONT)

    # Processes

    @staticmethod
    def send_signal(pid, number):
        try:
            os.kill(pid, number)
        except ProcessLookupError:
            pass

    def signal_worker(self, number):
        pids = self.farm.worker_pids()
        if pids:
            self.send_signal(self.random.choice(pids), number)

    def kill_worker(self):
        self.signal_worker(signal.SIGKILL)

    def stop_worker(self):
        self.signal_worker(signal.SIGSTOP)

    def kill_workers(self):
        for pid in self.farm.worker_pids():
            self.send_signal(pid, signal.SIGKILL)

    def start_again(self):
        """A daemon whose disk is full may wait for room, and one whose disk fails may end: it answers when all is well."""
        self.farm.spawn(self.progress_limit_s())
        if not self.machine.is_state_hurt():
            self.farm.await_answer()
            self.is_flipped = False

    def progress_limit_s(self):
        return 120 if self.is_real else 3

    def kill_daemon(self):
        self.farm.stop(signal.SIGKILL)
        self.start_again()

    def kill_twice(self):
        """The second time while it starts."""
        self.farm.stop(signal.SIGKILL)
        self.farm.spawn(self.progress_limit_s())
        time.sleep(self.random.random() * 0.3)
        self.kill_daemon()

    def kill_all(self):
        pids = self.farm.worker_pids()
        self.farm.send(signal.SIGKILL)
        for pid in pids:
            self.send_signal(pid, signal.SIGKILL)
        self.kill_daemon()

    def stop_daemon(self):
        self.farm.stop(signal.SIGTERM)
        self.start_again()

    def freeze_daemon(self):
        """At times for longer than a worker may be silent (10 s) or without progress (3 s)."""
        self.farm.send(signal.SIGSTOP)
        time.sleep(self.random.choice((self.random.random(), self.random.random(), 4, 11)))
        self.farm.send(signal.SIGCONT)

    def begin_second_farm(self):
        """It writes into an output root of the first, and beside frames of one of its jobs."""
        if not self.twin:
            self.twins += 1
            self.twin = Twin(f"{self.farm.folder}/twin.{self.twins}", self.farm.programs, self.farm.roots[0])
        elif self.random.random() < 0.5:
            self.twin.kill()
        root = self.farm.roots[0]
        self.twin.submit(self.document, f"{root}/twin.{self.twins}/{self.number}", self.random.randint(1, 20))
        number = self.any_job()
        # A job of its own may still write there, from an act before.
        if number and self.books.jobs[number]["root"] == root and self.books.jobs[number]["folder"] not in self.twin.folders:
            self.twin.submit(self.document, self.books.jobs[number]["folder"], self.random.randint(1, 20))

    def end_second_farm(self):
        """What it told, once all of its jobs are over; None without it."""
        twin, self.twin = self.twin, None
        return (twin, *twin.finish()) if twin else None

    def reload(self):
        """Not of a daemon that starts: the service manager does not either."""
        if self.farm.is_up:
            self.farm.send(signal.SIGHUP)

    def limit_files(self):
        self.farm.limit_files(self.random.randint(16, 48))
        self.condition(lambda: self.farm.limit_files(MANY_FILES))

    # The machine

    def jump_clock(self):
        self.machine.set_clock(self.random.choice((0, -1000, 3600_000, -86400_000, 315360000_000)))

    def any_disk(self):
        return self.random.choice((STATE, OUTPUT))

    def break_disk(self, **fields):
        disk = self.any_disk()
        self.machine.set_disk(disk, **fields)

        def end():
            self.machine.set_disk(disk)
            if "one_sync_in" in fields:
                self.may_publish_again()
        self.condition(end)

    def slow_disk(self):
        self.break_disk(delay_us=self.random.choice((1000, 20000, 100000)))

    def fail_writes(self):
        self.break_disk(one_write_in=self.random.choice((1, 3, 20)))

    def fail_syncs(self):
        self.break_disk(one_sync_in=self.random.choice((1, 3, 20)))

    def fail_renames(self):
        self.break_disk(one_rename_in=self.random.choice((1, 3, 20)))

    def tear_writes(self):
        self.break_disk(one_tear_in=self.random.choice((5, 30, 100)))

    def may_publish_again(self):
        """A frame whose name cannot be synced is rendered again, for a crash might lose it."""
        self.books.again |= {job["folder"] for job in self.books.jobs.values()}

    def fill_output(self):
        self.fill(OUTPUT)

    def fill_state(self):
        self.fill(STATE)

    def fill(self, number):
        disk = self.machine.disks[number]
        if disk.is_there:
            disk.fill()
            self.condition(disk.empty)

    def take_root_away(self):
        disk = self.machine.disks[OUTPUT]
        if not disk.is_there:
            return
        disk.take_away()

        def bring_back():
            left = [os.path.join(folder, name) for folder, _, names in os.walk(disk.path) for name in names]
            if left:
                self.wrong.append(f"{len(left)} files were written below the mount point of an absent root: {left[0]}")
            for name in os.listdir(disk.path):
                shutil.rmtree(f"{disk.path}/{name}", ignore_errors=True)
            disk.bring_back()
        self.condition(bring_back)

    def lose_marker(self):
        """The folder at the root's path is no root now. The marker comes back, and all goes on."""
        marker = f"{self.machine.disks[OUTPUT].place}/.marchd-root"
        if os.path.exists(marker):
            os.rename(marker, marker + ".away")

            def bring_back():
                if os.path.exists(marker):
                    self.wrong.append("a root that lost its marker was marked a second time")
                os.rename(marker + ".away", marker)
            self.condition(bring_back)

    # Files

    @staticmethod
    def list_folder(folder):
        """The paths of what is in it."""
        try:
            return [f"{folder}/{name}" for name in os.listdir(folder)]
        except OSError:
            return []

    def rob_folder(self):
        number = self.any_job()
        folder = self.books.jobs[number]["folder"] if number else None
        if number is None or self.is_out_of_reach(number) or (self.twin and folder in self.twin.folders):
            return
        self.books.robbed.add(number)
        self.books.again.add(folder)
        self.books.forget_folder(folder)
        shutil.rmtree(folder, ignore_errors=True)

    def put_foreign_file(self):
        """Names that look like the farm's, and are not."""
        number = self.any_job()
        if number is None or self.is_out_of_reach(number):
            return
        folder = self.books.jobs[number]["folder"]
        path = f"{folder}/{self.random.choice(('notes.txt', 's.0001.exr.old', 't.0001.exr.1.1.1.part', 's.exr.part'))}"
        text = f"foreign {self.random.random()}"
        try:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        except OSError:
            self.quietly(lambda: os.remove(path))
            self.books.foreign.pop(path, None)
            return
        self.books.foreign[path] = text
