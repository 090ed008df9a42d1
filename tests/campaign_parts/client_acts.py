"""What clients ask for, well or badly."""
import json
import shutil
import subprocess

from audit import is_of
from farm import PATIENCE_S, drain
from machine import OUTPUT, STATE

BAD_LINES = (b"what?\n", b"{}\n", b"[]\n", b'{"jsonrpc":"2.0","id":1,"method":"job.show","params":{"id":-1}}\n',
             b'{"jsonrpc":"2.0","id":1,"method":"job.submit","params":{"document":{"version":1}}}\n',
             b'{"jsonrpc":"2.0","id":"' + b"x" * 100000 + b'"}\n', b"\xff\xfe\n", b"[" * 1000 + b"\n")


class ClientActs:
    def any_user(self):
        return self.random.choice(self.farm.users)

    def any_job(self):
        known = self.books.known()[-40:]
        return known[int(self.random.random() * len(known))] if known else None

    def submit(self, frames=None, user=None):
        frames = frames or (self.random.randint(1, 3) if self.is_real else self.random.randint(1, 60))
        user = self.any_user() if user is None else user
        root = self.random.choice(self.farm.roots)
        self.submits += 1
        folder = f"{root}/{self.round}/{self.submits}"
        pattern = f"{folder}/s.####.exr"
        document = dict(self.document, frames=f"1-{frames}", priority=self.random.randint(0, 100),
                        order=self.random.choice(([], ["first", "last"], ["middle", 4])),
                        output=dict(self.document["output"], path=pattern))
        if not self.is_real and self.random.random() < 0.1:
            document["frame_limit"] = 2
        answer = self.farm.ask("job.submit", {"document": document}, user)
        if answer is None:
            self.unanswered += 1
        elif "result" in answer:
            number = answer["result"]["id"]
            if number <= max(self.books.accepted, default=0):
                self.wrong.append(f"job id {number} was given after {max(self.books.accepted)}")
            self.books.accepted.add(number)
            self.books.jobs[number] = {"folder": folder, "frames": frames, "user": user, "root": root,
                                       "round": self.round}
        elif "one_sync_in" not in self.machine.fields[STATE]:
            # After a sync that failed, a crash decides whether the commit is on disk.
            self.books.refused.add(pattern)

    def flood_jobs(self):
        user = self.any_user()
        for _ in range(self.random.choice((25, 25, 25, 150))):
            self.submit(1, user)

    def change(self, method, more=None, user=0):
        """The id and the answer; None, None without a job."""
        number = self.any_job()
        if number is None:
            return None, None
        return number, self.farm.ask(method, dict(more or {}, id=number), user)

    def pause(self):
        self.change("job.pause")

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

    def any_range(self):
        first = self.random.randint(1, 30)
        return f"{first}-{first + self.random.randint(0, 30)}x{self.random.randint(1, 3)}"

    def retry_a_part(self):
        """Frames that succeeded are looked at again, and skipped by a worker that looks."""
        number = self.retry({"state": ["succeeded", "failed", "canceled", "skipped"], "range": self.any_range()})
        self.note_retried(number)

    def note_retried(self, number):
        """Its files stay, and are replaced as its frames are rendered, or not if it is canceled before."""
        if number:
            self.books.again.add(self.books.jobs[number]["folder"])
            self.books.retried.add(number)

    def retry_by_force(self):
        number = self.retry({"state": ["succeeded", "failed"], "range": self.any_range(), "force": True})
        self.note_retried(number)

    def change_priority(self):
        """Above 100 they are for administrators."""
        user, priority = self.any_user(), self.random.randint(0, 200)
        number, answer = self.change("job.priority", {"priority": priority}, user)
        if user and priority > 100 and answer and "result" in answer:
            self.wrong.append(f"user {user} gave job {number} the priority {priority}")

    def delete(self):
        number, with_files = self.any_job(), self.random.random() < 0.5
        if number is not None and number not in self.books.robbed and not self.is_out_of_reach(number):
            self.delete_job(number, with_files)

    def delete_job(self, number, with_files):
        folder = self.books.jobs[number]["folder"]
        self.books.maybe_deleted.add(number)
        answer = self.farm.ask("job.delete", {"id": number, "files": with_files})
        if answer is None:
            self.books.robbed.add(number)
            return
        if "result" not in answer:
            self.books.maybe_deleted.discard(number)
            return
        self.books.deleted.add(number)
        there = {path for path in self.list_folder(folder) if is_of(f"{folder}/s.####.exr", path)}
        if not with_files:
            self.books.kept_files |= there
        elif not answer["result"]["files_kept"] and not answer["result"]["files_found"]:
            numbers = range(1, self.books.jobs[number]["frames"] + 1)
            self.books.kept_files -= there
            self.books.removed_files |= (there | {f"{folder}/s.{n:04}.exr" for n in numbers}) - self.books.unknown

    def tidy_up(self, oldest):
        """Nothing of rounds before `oldest` stays: the farm does not grow. All jobs are over, and all is well."""
        listed = {job["id"] for job in self.farm.jobs()}
        for number, job in list(self.books.jobs.items()):
            if job["round"] >= oldest:
                continue
            if number in listed:
                self.delete_job(number, True)
                if number not in self.books.deleted:
                    self.wrong.append(f"job {number} cannot be deleted")
            left = self.books.removed_files & set(self.list_folder(job["folder"]))
            if left:
                self.wrong.append(f"{min(left)}: its job was deleted with files")
            shutil.rmtree(job["folder"], ignore_errors=True)
            self.books.forget_folder(job["folder"])
            self.books.removed_files -= {path for path in self.books.removed_files if path.startswith(job["folder"] + "/")}
            self.books.deleted.add(number)
            del self.books.jobs[number]
        for number in listed - self.books.accepted:  # whose submit had no answer
            self.farm.ask("job.delete", {"id": number, "files": True})
        for twin in range(1, self.twins + 1):
            shutil.rmtree(f"{self.farm.roots[0]}/twin.{twin}", ignore_errors=True)
            shutil.rmtree(f"{self.farm.folder}/twin.{twin}", ignore_errors=True)

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

    def ask_and_sleep(self):
        """Answers that nobody reads."""
        client = self.connect()
        if client:
            client.socket.settimeout(2)
            self.try_to_send(client, b'{"jsonrpc":"2.0","id":1,"method":"job.list"}\n' * 300)
            self.idle_clients.append(client)

    def wait_for_job(self):
        """A command that waits, through all that happens to the daemon, until a job has ended."""
        number = self.any_job()
        if number and len(self.waiting) < 5:
            self.waiting.append((number, self.farm.command("wait", str(number))))

    def end_waiting(self):
        """All jobs are over."""
        for number, process in self.waiting:
            try:
                said = process.communicate(timeout=PATIENCE_S)[1]
            except subprocess.TimeoutExpired:
                process.kill()
                said = "it does not end"
            # It may begin while a torn daemon is dead; then this is all that it says.
            is_early = process.returncode == 3 and said.startswith("march wait: no daemon answers")
            if process.returncode not in (0, 1) and not is_early:
                self.wrong.append(f"march wait {number} ended with status {process.returncode}: {said.strip()}")
        self.waiting = []

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
