"""The daemon as a process, what clients say to it, and how long it takes to answer."""
import json
import os
import resource
import select
import signal
import socket
import subprocess
import threading
import time

from cage import die_with_parent
from machine import STATE

PATIENCE_S = 600  # a guard against what never happens, not a measure: machines are slow and busy


MANY_FILES = 1024


def children(pid):
    try:
        with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
            return [int(child) for child in file.read().split()]
    except OSError:
        return []


class Failure(Exception):
    """A promise that was not kept."""


class Client:
    """A connection. `user` is who the daemon takes it for."""

    def __init__(self, path, user=0):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.settimeout(PATIENCE_S)
        if user:
            os.seteuid(user)
        try:
            self.socket.connect(path)
        except OSError:
            self.socket.close()
            raise
        finally:
            if user:
                os.seteuid(0)
        self.rest = b""

    def send(self, text):
        self.socket.sendall(text)

    def ask(self, method, params=None):
        """The answer's object; None where the daemon went away."""
        request = {"jsonrpc": "2.0", "id": 1, "method": method, "params": params or {}}
        try:
            self.send(json.dumps(request).encode() + b"\n")
            while True:
                answer = json.loads(self.read_line())
                if "method" not in answer:
                    return answer
        except (ConnectionError, EOFError):
            return None

    def read_line(self):
        while b"\n" not in self.rest:
            received = self.socket.recv(1 << 16)
            if not received:
                raise EOFError
            self.rest += received
        line, self.rest = self.rest.split(b"\n", 1)
        return line

    def close(self):
        self.socket.close()


class Watch(threading.Thread):
    """Asks the daemon how it is, again and again: the longest silence, and the most memory."""

    def __init__(self, farm):
        super().__init__(daemon=True)
        self.farm, self.silence_s, self.memory_bytes, self.ends = farm, 0.0, 0, False

    def run(self):
        while not self.ends:
            generation, began = self.farm.generation, time.monotonic()
            try:
                client = Client(self.farm.socket)
                answer = client.ask("daemon.status")
                client.close()
            except OSError:
                answer = None
            # What a signal of the campaign or a limit of descriptors caused is no silence of the daemon's.
            if answer and generation == self.farm.generation and self.farm.answer_s == PATIENCE_S:
                self.silence_s = max(self.silence_s, time.monotonic() - began)
            self.memory_bytes = max(self.memory_bytes, self.farm.memory_bytes())
            time.sleep(0.1)


class Farm:
    def __init__(self, folder, programs, machine, users, roots, workers=3):
        self.folder, self.programs, self.machine, self.users = folder, programs, machine, users
        self.socket, self.log = f"{folder}/sock", f"{folder}/daemon.log"
        self.state, self.roots, self.workers = f"{machine.disks[STATE].path}/state", roots, workers
        self.store = f"{self.state}/queue.db"
        self.process, self.is_stopped, self.is_up = None, False, False
        self.answer_s = PATIENCE_S
        self.generation = 0  # grows with each act that may keep the daemon from answering
        self.recoveries_s = []
        self.worker, self.launcher = f"{folder}/worker", f"{folder}/launch"
        self.has_nodes = False  # whether the next daemon has its workers on nodes
        self.modes = f"{folder}/modes"
        with open(self.worker, "w", encoding="utf-8") as file:
            file.write(f"""#!/bin/bash
ulimit -c 0
printf x >>{folder}/turns
turn=$(stat -c %s {folder}/turns)
read -ra modes <{self.modes}
mode=${{modes[turn % ${{#modes[@]}}]}}
[ "$mode" = real ] && exec {programs}/march-worker "$@"
exec {programs}/stub-worker --names-job --mode "$mode" "$@"
""")
        os.chmod(self.worker, 0o755)
        with open(self.launcher, "w", encoding="utf-8") as file:
            file.write(f"#!/bin/sh\nexec {programs}/march-worker --node --worker {self.worker}\n")
        os.chmod(self.launcher, 0o755)
        self.set_modes("write:0")

    def set_modes(self, modes):
        """What the next workers do."""
        with open(self.modes + ".new", "w", encoding="utf-8") as file:
            file.write(modes + "\n")
        os.rename(self.modes + ".new", self.modes)

    # The process

    def spawn(self, progress_limit_s=3):
        self.generation += 1
        self.answer_s = PATIENCE_S
        environment = dict(os.environ, **self.machine.environment, LIBGL_ALWAYS_SOFTWARE="1",
                           ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "detect_leaks=0") +
                           ":verify_asan_link_order=0")
        arguments = [f"{self.programs}/marchd", "--config", "/dev/null", "--state", self.state, "--socket", self.socket,
                     *self.worker_options(), "--worker-program", self.worker, "--stop-timeout", "1",
                     "--progress-limit", str(progress_limit_s), "--input-root", "/", "--backend", "software"]
        for root in self.roots:
            arguments += ["--output-root", root]
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                            env=environment, preexec_fn=die_with_parent)
        self.began, self.is_up = time.monotonic(), False
        self.machine.note_start()

    def worker_options(self):
        """As many workers, here or on two nodes."""
        if not self.has_nodes:
            return ["--workers", str(self.workers)]
        nodes = f"nodes=anna={self.workers - 1},ben"
        return ["--workers", "none", "--pool", f"far launcher=command {nodes} heartbeat=2 command='{self.launcher}'"]

    def start(self, **options):
        """Returns once the daemon answers; its time counts as a recovery."""
        self.spawn(**options)
        self.await_answer()

    def await_answer(self):
        ends = time.monotonic() + PATIENCE_S
        while not self.answers():
            if self.process.poll() is not None:
                if not self.may_have_ended():
                    raise Failure(f"the daemon did not start: exit status {self.process.returncode}")
                self.spawn()
            if time.monotonic() > ends:
                raise Failure(f"the daemon does not answer within {PATIENCE_S} s of its start")
            time.sleep(0.01)
        if not self.is_up:
            self.recoveries_s.append(time.monotonic() - self.began)
            self.is_up = True
            if self.users[1:]:
                os.chmod(self.socket, 0o666)
        self.generation += 1

    def answers(self):
        answer = self.ask("daemon.status")
        return answer is not None and "result" in answer

    def was_torn(self):
        """Whether the daemon died in the middle of a write, as it was made to."""
        return self.process.returncode == -signal.SIGKILL and self.machine.may_have_torn()

    def may_have_ended(self):
        """A start may be given up where the store's disk answers with errors; not where it is full."""
        return self.was_torn() or (self.process.returncode == 1 and not self.is_up and self.machine.has_failed(STATE))

    def ensure(self):
        """The daemon runs. One that was made to die in the middle of a write is started again, as a service would be."""
        if self.process.poll() is None:
            return
        if not self.may_have_ended():
            raise Failure(f"the daemon ended by itself: exit status {self.process.returncode}")
        self.spawn()

    def send(self, number):
        self.generation += 1
        if self.process.poll() is None:
            os.kill(self.process.pid, number)

    def stop(self, number=signal.SIGTERM):
        self.send(signal.SIGCONT)
        self.send(number)
        try:
            status = self.process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            raise Failure(f"the daemon does not end within {PATIENCE_S} s") from None
        is_excused = self.was_torn() or self.machine.is_state_hurt() or (not self.is_up and status == -number)
        if number == signal.SIGTERM and status and not is_excused:
            raise Failure(f"the daemon ended with status {status}, expected 0")

    def command(self, *words):
        """Begins a command of march, which speaks to this daemon."""
        return subprocess.Popen([f"{self.programs}/march", *words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True, preexec_fn=die_with_parent,
                                env=dict(os.environ, MARCHD_SOCKET=self.socket))

    def do(self, *words):
        """The exit status of a command, and what it said on standard error."""
        process = self.command(*words)
        try:
            said = process.communicate(timeout=PATIENCE_S)[1]
        except subprocess.TimeoutExpired:
            raise Failure(f"march {' '.join(words)} does not end within {PATIENCE_S} s") from None
        return process.returncode, said.strip()

    def limit_files(self, count):
        """Who connects to a daemon without descriptors waits until it has some."""
        self.generation += 1
        self.answer_s = PATIENCE_S if count >= MANY_FILES else 1
        if self.process.poll() is None:
            hard = resource.prlimit(self.process.pid, resource.RLIMIT_NOFILE)[1]
            resource.prlimit(self.process.pid, resource.RLIMIT_NOFILE, (min(count, hard), hard))

    def worker_pids(self):
        """Of the workers, and of the nodes."""
        pids = children(self.process.pid)
        return pids + [child for pid in pids for child in children(pid)]

    def memory_bytes(self):
        try:
            with open(f"/proc/{self.process.pid}/status", encoding="ascii") as file:
                lines = [line.split() for line in file if line.startswith("VmHWM")]
            return int(lines[0][1]) * 1024 if lines else 0
        except (OSError, AttributeError):
            return 0

    # Clients

    def client(self, user=0):
        return Client(self.socket, user)

    def ask(self, method, params=None, user=0):
        """The answer's object; None where there is no daemon, or it went away."""
        try:
            client = self.client(user)
        except OSError:
            return None
        client.socket.settimeout(self.answer_s)
        try:
            return client.ask(method, params)
        except TimeoutError:
            if self.answer_s == PATIENCE_S:
                raise Failure(f"{method} {params}: no answer within {PATIENCE_S} s") from None
            return None
        finally:
            client.close()

    def get(self, method, params=None):
        """The result, of a daemon that is well."""
        answer = self.ask(method, params)
        if answer is None or "error" in answer:
            raise Failure(f"{method} {params}: expected a result, got {answer}")
        return answer["result"]

    def jobs(self, states=None):
        return self.get("job.list", {"state": states} if states else None)["jobs"]

    def frames(self, job):
        found = []
        while True:
            page = self.get("job.frames", {"id": job, "offset": len(found), "limit": 10000})
            found += page["frames"]
            if len(found) >= page["total"]:
                return found

    def all_jobs_end(self):
        """Resumes and retries what has to be. Whether all are over now, and none has failed."""
        for job in self.jobs():
            if job["state"] == "paused":
                self.ask("job.resume", {"id": job["id"]})
            if job["state"] == "failed" or (job["failed"] and job["state"] not in ("canceled", "running", "queued")):
                self.ask("job.retry", {"id": job["id"]})
        return not self.jobs(["queued", "running", "paused", "failed"])

    def tell_frames(self, jobs):
        """What the daemon says of each frame that is not queued, by job and frame."""
        return {(job["id"], frame["frame"]): frame for job in jobs for frame in self.frames(job["id"])}

    def wait(self, what, is_done):
        ends = time.monotonic() + PATIENCE_S
        while not is_done():
            self.ensure()
            if time.monotonic() > ends:
                raise Failure(f"not within {PATIENCE_S} s: {what}")
            time.sleep(0.05)


def drain(client, limit_s):
    """Reads what comes, for so long at most."""
    ends = time.monotonic() + limit_s
    while time.monotonic() < ends and select.select([client.socket], [], [], 0.05)[0]:
        if not client.socket.recv(1 << 16):
            return
