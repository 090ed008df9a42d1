"""A farm, for programs that wait for each answer. AsyncFarm is the same for asyncio."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from types import TracebackType
from typing import Any, TypeVar

from . import answers, calls, errors, pictures
from . import address as addresses
from .calls import Call, Document, FrameState, JobFilter, JobState
from .channel import Channel
from .errors import ConnectionLost
from .follow import Disconnected, Event, Follower, Reconnected, Waiting
from .job_files import load_job

T = TypeVar("T")
PAUSE_S = 0.2  # between attempts to connect again


class Farm:
    """Methods raise FarmError and its kinds. May be used by several threads; one of them waits for an answer at a time.

    `address` is unix:PATH, http://HOST:PORT or https://HOST; None: where march looks. A connection that is lost is made
    again: what only asks is asked again for `patience_s`, a change is not sent twice but raises ConnectionLost.
    `cafile`: a PEM file of the certificates that are trusted at https://; None: those of the system."""

    def __init__(
        self,
        address: str | None = None,
        token: str | None = None,
        patience_s: float = 60.0,
        cafile: str | os.PathLike[str] | None = None,
    ) -> None:
        self.address = addresses.find(address, token, cafile)
        self.patience_s = patience_s
        self._token = token
        self._lock = threading.Lock()
        self._channel: Channel | None = None
        self.has_answered = False
        self._number = 0

    @classmethod
    def connect(
        cls,
        address: str | None = None,
        token: str | None = None,
        patience_s: float = 60.0,
        cafile: str | os.PathLike[str] | None = None,
    ) -> Farm:
        """A farm that answers now."""
        farm = cls(address, token, patience_s, cafile)
        try:
            farm.status()
        except BaseException:
            farm.close()
            raise
        return farm

    def __enter__(self) -> Farm:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        with self._lock:
            self._drop()

    def status(self) -> answers.DaemonStatus:
        return self._do(calls.status())

    def workers(self) -> list[answers.Worker]:
        return self._do(calls.workers())

    def submit(self, job: Document | str | os.PathLike[str], paused: bool = False) -> int:
        """A document, or the path of a job file. Returns the job's number. JobError says at which place it is wrong."""
        document = load_job(job) if isinstance(job, (str, os.PathLike)) else job
        return self._do(calls.submit(document, paused))

    def job(self, number: int) -> answers.JobShow:
        """The job with its document, which is None where it is somebody else's."""
        return self._do(calls.job(number))

    def jobs(
        self,
        state: JobState | Iterable[JobState] | None = None,
        owner: str | None = None,
        name: str | None = None,
        since: float | None = None,
        before: float | None = None,
        newest_first: bool = False,
    ) -> Iterator[answers.Job]:
        """All jobs that fulfil what is given, in pages. `name` is a part of the name, times are unix seconds."""
        filter = JobFilter(state, owner, name, since, before, newest_first)
        cursor: str | None = None
        while True:
            page = self._do(calls.jobs(filter, cursor))
            yield from page.jobs
            if (cursor := page.next) is None:
                return

    def frames(
        self, number: int, state: FrameState | Iterable[FrameState] | None = None, range: str | None = None
    ) -> Iterator[answers.Frame]:
        """The job's frames, in pages."""
        cursor: str | None = None
        while True:
            page = self._do(calls.frames(number, state, range, cursor))
            yield from page.frames
            if (cursor := page.next) is None:
                return

    def frame_map(self, number: int, offset: int = 0) -> answers.JobFrameMap:
        """The states, seconds and errors of up to 50,000 frames in short, from the frame at `offset` on."""
        return self._do(calls.frame_map(number, offset))

    def log(self, number: int, frame: int | None = None, limit: int | None = None) -> list[answers.Attempt]:
        """Attempts that failed or were lost, the newest first; of one frame, or of all."""
        return self._do(calls.log(number, frame, limit))

    def pause(self, number: int) -> answers.Job:
        return self._do(calls.change("pause", number))

    def resume(self, number: int) -> answers.Job:
        return self._do(calls.change("resume", number))

    def cancel(self, number: int) -> answers.Job:
        return self._do(calls.change("cancel", number))

    def priority(self, number: int, value: int) -> answers.Job:
        return self._do(calls.priority(number, value))

    def retry(
        self,
        number: int,
        state: FrameState | Iterable[FrameState] | None = None,
        range: str | None = None,
        force: bool = False,
    ) -> int:
        """How many frames are rendered again: those that failed, or those in the named states."""
        return self._do(calls.retry(number, state, range, force))

    def delete(self, number: int, files: bool = False) -> answers.JobDelete:
        return self._do(calls.delete(number, files))

    def drain(self) -> int:
        """No frame is begun from now on. Returns how many run."""
        return self._do(calls.drain())

    def undrain(self) -> int:
        return self._do(calls.undrain())

    def reload(self) -> answers.DaemonReload:
        return self._do(calls.reload())

    def call(self, method: str, params: Mapping[str, Any] | None = None) -> Any:
        """Any method of docs/protocol.md; the result as JSON has it."""
        return self._do(calls.raw(method, params or {}))

    def wait(self, number: int, timeout_s: float | None = None) -> answers.Job:
        """The job when it is over, in whatever state; the daemon may restart meanwhile. TimeoutError: it is not."""
        return self.wait_all([number], timeout_s)[0]

    def wait_all(self, numbers: Iterable[int], timeout_s: float | None = None) -> list[answers.Job]:
        """The jobs when all of them are over. NotFound: one was deleted before it was over."""
        waiting = Waiting(numbers)
        if waiting.is_done:
            return []
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        with Events(self, waiting.order, frames=False, workers=False) as events:
            while not waiting.is_done:
                event = events.next_until(deadline)
                if event is None:
                    left = sorted(set(waiting.order) - set(waiting.over))
                    raise TimeoutError(f"not over within {timeout_s} s: jobs {left}")
                waiting.note(event)
        return waiting.jobs()

    def events(self, jobs: int | Iterable[int] | None = None, frames: bool = True, workers: bool = True) -> Events:
        """What happens to these jobs, or to all, from now on: first a JobEvent for each in its present state."""
        return Events(self, [jobs] if isinstance(jobs, int) else jobs, frames, workers and jobs is None)

    def picture(self, number: int, frame: int, **options: pictures.Option) -> pictures.Picture:
        """A frame as PNG; through march-web alone. Options: exposure, channel, x, y, w, h, size."""
        return pictures.get_picture(self.address, self._token, number, frame, options)

    def header(self, number: int, frame: int) -> dict[str, Any]:
        """What a frame's file says of itself: the result of worker.header; through march-web alone."""
        return pictures.get_header(self.address, self._token, number, frame)

    def open_channel(self) -> Channel:
        """A connection of its own."""
        return Channel(self.address, self._token)

    @property
    def socket_token(self) -> str | None:
        """What a connection to the daemon's own socket says who it is by."""
        return self._token if self.address.paths else None

    def _drop(self) -> None:
        if self._channel:
            self._channel.close()
            self._channel = None

    def _connected(self) -> Channel:
        if self._channel and not self._channel.is_alive():
            self._drop()
        if not self._channel:
            channel = self.open_channel()
            try:
                if self.socket_token is not None:
                    self._ask(channel, calls.token(self.socket_token))
            except BaseException:
                channel.close()
                raise
            self._channel = channel
        return self._channel

    def _ask(self, channel: Channel, call: Call[T]) -> T:
        self._number += 1
        channel.send(call.encode(self._number))
        while True:
            answer = calls.decode(channel.receive() or "")
            if answer.get("id") == self._number:
                return call.take(answer)
            if "error" in answer:
                raise errors.of_answer(call.method, answer["error"]["code"], answer["error"]["message"])

    def _do(self, call: Call[T]) -> T:
        deadline: float | None = None
        with self._lock:
            while True:
                try:
                    result = self._ask(self._connected(), call)
                    self.has_answered = True
                    return result
                except ConnectionLost:
                    self._drop()
                    if not (call.is_safe and self.has_answered):
                        raise
                    deadline = deadline or time.monotonic() + self.patience_s
                    if time.monotonic() >= deadline:
                        raise
                    time.sleep(PAUSE_S)
                except BaseException as error:
                    if not isinstance(error, errors.FarmError):
                        self._drop()  # an answer may still come
                    raise


class Events(Iterator[Event]):
    """An endless iterator; close it, or use it with `with`. A daemon that goes away is waited for during the farm's
    patience_s, which Disconnected and Reconnected tell; then ConnectionLost is raised."""

    def __init__(self, farm: Farm, ids: Iterable[int] | None, frames: bool, workers: bool) -> None:
        self._farm = farm
        self._ids = None if ids is None else list(ids)
        self._frames = frames
        self._workers = workers
        self._events: list[Event] = []
        self._lost_since: float | None = None
        self._is_closed = False
        try:
            self._open()
        except ConnectionLost as error:
            if not farm.has_answered:
                raise
            self._lose(error)

    def __enter__(self) -> Events:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        self._is_closed = True
        if self._channel:
            self._channel.close()

    def __next__(self) -> Event:
        event = self.next_until(None)
        assert event is not None
        return event

    def next_until(self, deadline: float | None) -> Event | None:
        """The next event. None: there is none until the deadline, a time of time.monotonic()."""
        while not self._events:
            if self._is_closed:
                raise StopIteration
            try:
                if self._channel is None and not self._open_again(deadline):
                    return None
                if not self._take(deadline):
                    return None
            except ConnectionLost as error:
                self._lose(error)
        return self._events.pop(0)

    def _open(self) -> None:
        self._follower = Follower(self._ids, self._frames, self._workers, self._farm.socket_token)
        self._channel: Channel | None = None
        self._channel = self._farm.open_channel()

    def _take(self, deadline: float | None) -> bool:
        assert self._channel
        for text in self._follower.take_to_send():
            self._channel.send(text)
        received = self._channel.receive(deadline)
        if received is None:
            return False
        if self._lost_since is not None:
            self._lost_since = None
            self._events.append(Reconnected())
        self._events += self._follower.take(received)
        return True

    def _lose(self, error: ConnectionLost) -> None:
        if self._channel:
            self._channel.close()
            self._channel = None
        if self._lost_since is None:
            self._lost_since = time.monotonic()
            self._events.append(Disconnected(error.message))
        elif time.monotonic() - self._lost_since > self._farm.patience_s:
            raise error

    def _open_again(self, deadline: float | None) -> bool:
        left_s = PAUSE_S if deadline is None else deadline - time.monotonic()
        if left_s <= 0:
            return False
        time.sleep(min(PAUSE_S, left_s))
        self._open()
        return True
