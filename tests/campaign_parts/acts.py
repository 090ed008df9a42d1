"""What clients do and what breaks, one act at a time, and the books of what the farm has promised since."""
import json
import os
import shutil
import signal
import time

from farm import MANY_FILES, drain
from machine import OUTPUT, STATE

BAD_LINES = (b"what?\n", b"{}\n", b"[]\n", b'{"jsonrpc":"2.0","id":1,"method":"job.show","params":{"id":-1}}\n',
             b'{"jsonrpc":"2.0","id":1,"method":"job.submit","params":{"document":{"version":1}}}\n',
             b'{"jsonrpc":"2.0","id":"' + b"x" * 100000 + b'"}\n', b"\xff\xfe\n", b"[" * 1000 + b"\n")


class Books:
    """What was asked for and answered, and what a person did to the files."""

    def __init__(self):
        self.jobs = {}  # pattern, folder, frames and user of each accepted job, by id
        self.accepted, self.deleted, self.maybe_deleted, self.canceled = set(), set(), set(), set()
        self.refused = set()  # patterns of jobs that were refused
        self.robbed = set()  # jobs whose folder was removed
        self.again = set()  # folders whose frames may be published again
        self.foreign = {}  # files of somebody else: text by path
        self.kept_files, self.removed_files = set(), set()
        self.paused = set()


class Acts:
    def __init__(self, farm, machine, choices, project):
        self.farm, self.machine, self.random, self.books = farm, machine, choices, Books()
        with open(f"{project}/jobs/cloud.json", encoding="utf-8") as file:
            self.document = json.load(file)
        with open(f"{project}/tests/support/stated_quality.json", encoding="utf-8") as file:
            self.document["quality"] = json.load(file)["cloud"]
        self.document["resolution"] = [32, 18]
        self.round, self.submits, self.is_real = 0, 0, False
        self.counts, self.conditions, self.idle_clients = {}, [], []
        self.unanswered = self.violations = 0
        self.wrong = []  # promises broken in answers
        disk_acts = [(2, self.take_root_away), (1, self.fill_output), (1, self.fill_state)] if machine.can_mount else []
        self.table = disk_acts + [
            (24, self.submit), (2, self.flood_jobs), (6, self.kill_worker), (2, self.stop_worker),
            (1, self.kill_workers), (4, self.kill_daemon), (1, self.kill_twice), (2, self.kill_all),
            (1, self.stop_daemon), (1, self.freeze_daemon),
            (1, self.reload), (1, self.limit_files), (2, self.jump_clock), (1, self.slow_disk), (1, self.fail_writes),
            (1, self.fail_syncs), (1, self.fail_renames), (1, self.tear_writes), (1, self.rob_folder),
            (2, self.put_foreign_file), (4, self.pause), (5, self.resume), (2, self.cancel), (3, self.retry),
            (1, self.retry_by_force), (2, self.change_priority), (2, self.delete), (1, self.touch_others_job),
            (3, self.vanish), (2, self.subscribe_and_sleep), (1, self.flood_requests),
            (1, self.flood_documents), (2, self.talk_nonsense)]

    # One act

    def act(self):
        self.end_conditions(one_step=True)
        self.farm.ensure()
        act = self.random.choices([act for _, act in self.table], [weight for weight, _ in self.table])[0]
        self.count(act.__name__)
        act()
        time.sleep(self.random.random() * 0.08)

    def count(self, name):
        self.counts[name] = self.counts.get(name, 0) + 1

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

    # Clients

    def any_user(self):
        return self.random.choice(self.farm.users)

    def any_job(self):
        known = sorted(self.books.accepted - self.books.deleted)
        return self.random.choice(known[-40:]) if known else None

    def submit(self, frames=None, user=None):
        frames = frames or (self.random.randint(1, 3) if self.is_real else self.random.randint(1, 60))
        user = self.any_user() if user is None else user
        root = self.random.choice(self.farm.roots)
        self.submits += 1
        folder = f"{root}/{self.round}/{self.submits}"
        pattern = f"{folder}/s.####.exr"
        document = dict(self.document, frames=f"1-{frames}", priority=self.random.randint(0, 100),
                        output=dict(self.document["output"], path=pattern))
        answer = self.farm.ask("job.submit", {"document": document}, user)
        if answer is None:
            self.unanswered += 1
        elif "result" in answer:
            number = answer["result"]["id"]
            if number <= max(self.books.accepted, default=0):
                self.wrong.append(f"job id {number} was given after {max(self.books.accepted)}")
            self.books.accepted.add(number)
            self.books.jobs[number] = {"folder": folder, "frames": frames, "user": user, "root": root}
        elif "one_sync_in" not in self.machine.fields[STATE]:
            # After a sync that failed, a crash decides whether the commit is on disk.
            self.books.refused.add(pattern)

    def flood_jobs(self):
        user = self.any_user()
        for _ in range(25):
            self.submit(1, user)

    def change(self, method, more=None, user=0):
        """The id and the answer; None, None without a job."""
        number = self.any_job()
        if number is None:
            return None, None
        return number, self.farm.ask(method, dict(more or {}, id=number), user)

    def pause(self):
        number, _ = self.change("job.pause")
        self.books.paused.add(number)

    def resume(self):
        self.change("job.resume")

    def cancel(self):
        if self.random.random() < 0.5:
            return
        number, answer = self.change("job.cancel")
        if answer and answer.get("result", {}).get("state") == "canceled":
            self.books.canceled.add(number)

    def retry(self, more=None):
        states = self.random.choice((["failed"], ["failed", "canceled"]))
        number, _ = self.change("job.retry", more or {"state": states})
        if number:
            self.books.canceled.discard(number)
        return number

    def retry_by_force(self):
        number = self.retry({"state": ["succeeded", "failed"], "range": "1-5", "force": True})
        if number:
            self.books.again.add(self.books.jobs[number]["folder"])

    def change_priority(self):
        self.change("job.priority", {"priority": self.random.randint(0, 100)})

    def delete(self):
        number = self.any_job()
        if number is None or number in self.books.robbed or self.is_out_of_reach(number):
            return
        folder, with_files = self.books.jobs[number]["folder"], self.random.random() < 0.5
        self.books.maybe_deleted.add(number)
        answer = self.farm.ask("job.delete", {"id": number, "files": with_files})
        if answer is None:
            self.books.robbed.add(number)
            return
        if "result" not in answer:
            self.books.maybe_deleted.discard(number)
            return
        self.books.deleted.add(number)
        there = {f"{folder}/{name}" for name in self.list_folder(folder) if name.endswith(".exr")}
        if not with_files:
            self.books.kept_files |= there
        elif not answer["result"]["files_kept"]:
            numbers = range(1, self.books.jobs[number]["frames"] + 1)
            self.books.removed_files |= there | {f"{folder}/s.{n:04}.exr" for n in numbers}

    def is_out_of_reach(self, number):
        disk = self.machine.disks[OUTPUT]
        return not disk.is_there and self.books.jobs[number]["root"] == disk.path

    def touch_others_job(self):
        """Who is neither owner nor administrator must be refused."""
        number = self.any_job()
        if number is None or len(self.farm.users) < 3:
            return
        stranger = next(user for user in self.farm.users[1:] if user != self.books.jobs[number]["user"])
        answer = self.farm.ask(self.random.choice(("job.cancel", "job.pause", "job.delete")), {"id": number}, stranger)
        if answer and "result" in answer:
            self.wrong.append(f"user {stranger} changed job {number} of user {self.books.jobs[number]['user']}")

    def connect(self):
        try:
            return self.farm.client(self.any_user())
        except OSError:
            return None

    def vanish(self):
        client = self.connect()
        if not client:
            return
        line = self.random.choice((b'{"jsonrpc":"2.0","id":1,"method":"job.cancel","par',
                                   b'{"jsonrpc":"2.0","id":1,"method":"events.subscribe"}\n'))
        self.try_to_send(client, line)
        client.close()

    def subscribe_and_sleep(self):
        client = self.connect()
        if client:
            count = self.random.choice((1, 64))
            self.try_to_send(client, b'{"jsonrpc":"2.0","id":1,"method":"events.subscribe"}\n' * count)
            self.idle_clients.append(client)
        while len(self.idle_clients) > 40:
            self.idle_clients.pop(0).close()

    def flood_requests(self):
        client = self.connect()
        if client:
            client.socket.settimeout(2)
            self.try_to_send(client, b'{"jsonrpc":"2.0","id":1,"method":"job.list"}\n' * 300)
            client.close()

    def talk_nonsense(self):
        client = self.connect()
        if client:
            self.try_to_send(client, self.random.choice(BAD_LINES))
            self.quietly(lambda: drain(client, 0.2))
            client.close()

    def try_to_send(self, client, text):
        self.quietly(lambda: client.send(text))

    @staticmethod
    def quietly(action):
        try:
            action()
        except OSError:
            pass

    def flood_documents(self):
        """Jobs of a megabyte each at one moment, whose output nobody may write, so that all of it is only checked."""
        keys = [[n, [n % 7, 1, 2]] for n in range(10000)]
        lights = [dict(self.document["lights"][0], position={"keys": keys}) for _ in range(4)]
        document = dict(self.document, lights=lights, output={"path": "/nowhere/s.####.exr"})
        line = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "job.submit", "params": {"document": document}})
        clients = [client for client in (self.connect() for _ in range(6)) if client]
        for client in clients:
            client.socket.settimeout(2)
            self.try_to_send(client, line.encode() + b"\n")
        for client in clients:
            client.close()

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
        self.farm.send(signal.SIGSTOP)
        time.sleep(self.random.random())
        self.farm.send(signal.SIGCONT)

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

    # Files

    @staticmethod
    def list_folder(folder):
        try:
            return os.listdir(folder)
        except OSError:
            return []

    def rob_folder(self):
        number = self.any_job()
        if number is None or self.is_out_of_reach(number):
            return
        folder = self.books.jobs[number]["folder"]
        self.books.robbed.add(number)
        self.books.again.add(folder)
        foreign = self.books.foreign
        self.books.foreign = {path: foreign[path] for path in foreign if os.path.dirname(path) != folder}
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
