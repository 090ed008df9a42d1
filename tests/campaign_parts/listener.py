"""A client that hears all events, and what must hold of them."""
import json
import threading
import time

from farm import Client

ENDS = ("succeeded", "skipped", "failed", "canceled", "queued")
FRAME_STATES = ("queued", "running", "succeeded", "failed", "canceled", "skipped")


class EventAudit:
    """Looks at one event after the other. A session is a connection: what happens between two is not heard."""

    def __init__(self):
        self.wrong, self.heard = [], 0
        self.published = {}  # how often a frame was said to have succeeded, by job and frame
        self.succeeded = {}  # the attempt of which that was said last: a daemon that was killed before says it again
        self.begin_session()

    def begin_session(self):
        self.running, self.ended, self.last, self.deleted = {}, {}, {}, set()

    def note(self, event):
        self.heard += 1
        kind, number = event["type"], event.get("id", event.get("job", {}).get("id"))
        if number in self.deleted:
            self.wrong.append(f"{kind} of job {number} after its deletion")
        if kind == "frame":
            self.note_frame((number, event["frame"]), event["state"], event["attempt"])
        elif kind == "job":
            self.note_job(event["job"])
        elif kind == "deleted":
            self.deleted.add(number)

    def note_frame(self, frame, state, attempt):
        """A frame that is queued again because its root is away succeeds if its file had its name by then."""
        name = f"frame {frame[1]} of job {frame[0]}, attempt {attempt}"
        if state == "running":
            if attempt <= max(self.running.get(frame, 0), self.ended.get(frame, 0)):
                self.wrong.append(f"{name}: begins after attempt {max(self.running.get(frame, 0), self.ended.get(frame, 0))}")
            self.running[frame], self.last[frame] = attempt, state
            return
        if state not in ENDS:
            self.wrong.append(f"{name}: {state}")
        is_settled = state == "succeeded" and attempt == self.ended.get(frame) and self.last[frame] == "queued"
        if (attempt <= self.ended.get(frame, 0) and not is_settled) or attempt < self.running.get(frame, 0):
            self.wrong.append(f"{name}: {state} after a later end or start")
        self.ended[frame], self.last[frame] = attempt, state
        if state == "succeeded":
            self.published[frame] = self.published.get(frame, 0) + (self.succeeded.get(frame) != attempt)
            self.succeeded[frame] = attempt

    def note_job(self, job):
        if sum(job[state] for state in FRAME_STATES) != job["frames"]:
            self.wrong.append(f"job {job['id']}: its frames' states do not add up")
        if job["state"] == "succeeded" and job["succeeded"] + job["skipped"] != job["frames"]:
            self.wrong.append(f"job {job['id']} succeeded with {job['succeeded']} of {job['frames']}")

    def compare(self, told):
        """`told`: states by job and frame, of a farm in which all jobs are over."""
        ends = ("succeeded", "skipped", "failed")
        for frame, state in self.last.items():
            if (state in ends or told.get(frame) in ends) and told.get(frame, state) != state:
                self.wrong.append(f"frame {frame[1]} of job {frame[0]}: the last event says {state}, "
                                  f"the list {told[frame]}")

    def compare_names(self, paths, counts, books):
        """`paths` of each frame; `counts`: how often the daemon gave a file that name."""
        for frame, count in self.published.items():
            path = paths.get(frame)
            if path and count > counts.get(path, 0):
                self.wrong.append(f"{path}: {count} events of its success, {counts.get(path, 0)} files")
            if path and count > 1 and not books.may_be_published_twice(path):
                self.wrong.append(f"{path}: {count} events of its success")


class Listener(threading.Thread):
    """Subscribes, and connects again where the connection ends."""

    def __init__(self, farm):
        super().__init__(daemon=True)
        self.farm, self.audit, self.ends = farm, EventAudit(), False
        self.sessions, self.client = 0, None
        self.is_caught_up = threading.Event()

    def run(self):
        while not self.ends:
            try:
                self.listen()
            except (OSError, EOFError):
                pass
            time.sleep(0.02)

    def listen(self):
        client = Client(self.farm.socket)
        client.send(b'{"jsonrpc":"2.0","id":1,"method":"events.subscribe"}\n')
        self.audit.begin_session()
        self.sessions += 1
        self.client = client
        try:
            while not self.ends:
                message = json.loads(client.read_line())
                if "method" in message:
                    self.audit.note(message["params"])
                elif message.get("id") == 2:
                    self.is_caught_up.set()
        finally:
            self.client = None
            client.close()

    def catch_up(self):
        """Returns when all has been heard that was said until now; False where the connection ended, or is none."""
        self.is_caught_up.clear()
        client, sessions = self.client, self.sessions
        try:
            client.send(b'{"jsonrpc":"2.0","id":2,"method":"daemon.status"}\n')
        except (AttributeError, OSError):
            return False
        return self.is_caught_up.wait(60) and sessions == self.sessions
