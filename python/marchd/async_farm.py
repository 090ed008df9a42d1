"""A farm, for programs that run on asyncio. The methods are those of Farm."""

from __future__ import annotations

import asyncio
import os
import time
from collections import deque
from collections.abc import AsyncIterator, Iterable, Mapping
from types import TracebackType
from typing import Any, TypeVar

from . import address as addresses
from . import answers, calls, errors, pictures
from .calls import Call, Document, FrameState, JobFilter, JobState
from .channel import CONNECT_S
from .errors import ConnectionLost
from .farm import PAUSE_S
from .follow import Disconnected, Event, Follower, Reconnected, Waiting
from .job_files import load_job

T = TypeVar("T")


async def _open_streams(address: addresses.Address) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    reason = OSError("nowhere to look")
    for path in address.paths:
        try:
            return await asyncio.open_unix_connection(path)
        except OSError as error:
            reason = error
    if address.paths:
        raise addresses.no_farm(address, reason)
    secure = address.tls()
    try:
        return await asyncio.wait_for(asyncio.open_connection(address.host, address.port, ssl=secure), CONNECT_S)
    except OSError as error:
        raise addresses.no_farm(address, error) from error


class AsyncChannel:
    """An open connection: text messages out and in. Every way in which it can end is ConnectionLost."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, framing: addresses.Framing) -> None:
        self._reader = reader
        self._writer = writer
        self._framing = framing
        self._messages: deque[str] = deque()

    @classmethod
    async def open(cls, address: addresses.Address, token: str | None) -> AsyncChannel:
        channel = cls(*await _open_streams(address), address.framing(token))
        try:
            await asyncio.wait_for(channel._begin(), CONNECT_S)
        except BaseException as error:
            channel.close()
            if isinstance(error, TimeoutError):
                raise ConnectionLost(f"{address.text} does not answer") from None
            raise
        return channel

    async def _begin(self) -> None:
        if self._framing.opening:
            await self._send(self._framing.opening)
        while not self._framing.is_open:
            await self._read()

    def close(self) -> None:
        self._writer.transport.abort()  # TLS's farewell would wait for the peer, and the loop may end before

    async def send(self, text: str) -> None:
        await self._send(self._framing.encode(text))

    async def receive(self) -> str:
        while not self._messages:
            await self._read()
        return self._messages.popleft()

    async def _send(self, data: bytes) -> None:
        try:
            self._writer.write(data)
            await self._writer.drain()
        except OSError as error:
            raise ConnectionLost(f"the connection is lost: {error.strerror or error}") from error

    async def _read(self) -> None:
        try:
            received = await self._reader.read(1 << 18)
        except OSError as error:
            raise ConnectionLost(f"the connection is lost: {error.strerror or error}") from error
        if not received:
            raise ConnectionLost("the farm ended the connection")
        self._messages.extend(self._framing.feed(received))
        if replies := self._framing.take_replies():
            await self._send(replies)


class Link:
    """A connection on which many ask at once; a task hands each answer to whom it is for."""

    def __init__(self, channel: AsyncChannel) -> None:
        self._channel = channel
        self._number = 0
        self._waiting: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self.lost: errors.FarmError | None = None
        self._task = asyncio.ensure_future(self._receive())

    async def _receive(self) -> None:
        try:
            while True:
                answer = calls.decode(await self._channel.receive())
                if answer.get("id") is None and "error" in answer:
                    raise ConnectionLost(f"the farm ended the connection: {answer['error']['message']}")
                future = self._waiting.pop(answer.get("id", 0), None)
                if future and not future.done():
                    future.set_result(answer)
        except errors.FarmError as error:
            self.lost = error
        for future in self._waiting.values():
            if not future.done():
                future.set_exception(self._why())

    def _why(self) -> errors.FarmError:
        assert self.lost
        return type(self.lost)(self.lost.message, self.lost.code)  # each who waits gets one of their own

    async def ask(self, call: Call[T]) -> T:
        if self.lost:
            raise self._why()
        self._number += 1
        number = self._number
        future = self._waiting[number] = asyncio.get_running_loop().create_future()
        try:
            await self._channel.send(call.encode(number))
            return call.take(await future)
        finally:
            self._waiting.pop(number, None)
            if future.done() and not future.cancelled():
                future.exception()  # it is raised already

    async def close(self) -> None:
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)
        self._channel.close()


class AsyncFarm:
    """As Farm; requests of several tasks run at the same time on one connection."""

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
        self._link: Link | None = None
        self.has_answered = False
        self._lock = asyncio.Lock()

    @classmethod
    async def connect(
        cls,
        address: str | None = None,
        token: str | None = None,
        patience_s: float = 60.0,
        cafile: str | os.PathLike[str] | None = None,
    ) -> AsyncFarm:
        """A farm that answers now."""
        farm = cls(address, token, patience_s, cafile)
        try:
            await farm.status()
        except BaseException:
            await farm.close()
            raise
        return farm

    async def __aenter__(self) -> AsyncFarm:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        async with self._lock:
            link, self._link = self._link, None
            if link:
                await link.close()

    async def status(self) -> answers.DaemonStatus:
        return await self._do(calls.status())

    async def workers(self) -> list[answers.Worker]:
        return await self._do(calls.workers())

    async def submit(self, job: Document | str | os.PathLike[str], paused: bool = False) -> int:
        document = load_job(job) if isinstance(job, (str, os.PathLike)) else job
        return await self._do(calls.submit(document, paused))

    async def job(self, number: int) -> answers.JobShow:
        return await self._do(calls.job(number))

    async def jobs(
        self,
        state: JobState | Iterable[JobState] | None = None,
        owner: str | None = None,
        name: str | None = None,
        since: float | None = None,
        before: float | None = None,
        newest_first: bool = False,
    ) -> AsyncIterator[answers.Job]:
        filter = JobFilter(state, owner, name, since, before, newest_first)
        cursor: str | None = None
        while True:
            page = await self._do(calls.jobs(filter, cursor))
            for job in page.jobs:
                yield job
            if (cursor := page.next) is None:
                return

    async def frames(
        self, number: int, state: FrameState | Iterable[FrameState] | None = None, range: str | None = None
    ) -> AsyncIterator[answers.Frame]:
        cursor: str | None = None
        while True:
            page = await self._do(calls.frames(number, state, range, cursor))
            for frame in page.frames:
                yield frame
            if (cursor := page.next) is None:
                return

    async def frame_map(self, number: int, offset: int = 0) -> answers.JobFrameMap:
        return await self._do(calls.frame_map(number, offset))

    async def log(self, number: int, frame: int | None = None, limit: int | None = None) -> list[answers.Attempt]:
        return await self._do(calls.log(number, frame, limit))

    async def pause(self, number: int) -> answers.Job:
        return await self._do(calls.change("pause", number))

    async def resume(self, number: int) -> answers.Job:
        return await self._do(calls.change("resume", number))

    async def cancel(self, number: int) -> answers.Job:
        return await self._do(calls.change("cancel", number))

    async def priority(self, number: int, value: int) -> answers.Job:
        return await self._do(calls.priority(number, value))

    async def retry(
        self,
        number: int,
        state: FrameState | Iterable[FrameState] | None = None,
        range: str | None = None,
        force: bool = False,
    ) -> int:
        return await self._do(calls.retry(number, state, range, force))

    async def delete(self, number: int, files: bool = False) -> answers.JobDelete:
        return await self._do(calls.delete(number, files))

    async def drain(self) -> int:
        return await self._do(calls.drain())

    async def undrain(self) -> int:
        return await self._do(calls.undrain())

    async def reload(self) -> answers.DaemonReload:
        return await self._do(calls.reload())

    async def call(self, method: str, params: Mapping[str, Any] | None = None) -> Any:
        return await self._do(calls.raw(method, params or {}))

    async def wait(self, number: int, timeout_s: float | None = None) -> answers.Job:
        return (await self.wait_all([number], timeout_s))[0]

    async def wait_all(self, numbers: Iterable[int], timeout_s: float | None = None) -> list[answers.Job]:
        waiting = Waiting(numbers)
        if waiting.is_done:
            return []

        async def follow() -> None:
            async with AsyncEvents(self, waiting.order, frames=False, workers=False) as events:
                async for event in events:
                    waiting.note(event)
                    if waiting.is_done:
                        return

        try:
            await asyncio.wait_for(follow(), timeout_s)
        except TimeoutError:
            left = sorted(set(waiting.order) - set(waiting.over))
            raise TimeoutError(f"not over within {timeout_s} s: jobs {left}") from None
        return waiting.jobs()

    def events(self, jobs: int | Iterable[int] | None = None, frames: bool = True, workers: bool = True) -> AsyncEvents:
        return AsyncEvents(self, [jobs] if isinstance(jobs, int) else jobs, frames, workers and jobs is None)

    async def picture(self, number: int, frame: int, **options: pictures.Option) -> pictures.Picture:
        return await asyncio.to_thread(pictures.get_picture, self.address, self._token, number, frame, options)

    async def header(self, number: int, frame: int) -> dict[str, Any]:
        return await asyncio.to_thread(pictures.get_header, self.address, self._token, number, frame)

    async def open_channel(self) -> AsyncChannel:
        """A connection of its own."""
        return await AsyncChannel.open(self.address, self._token)

    @property
    def socket_token(self) -> str | None:
        """What a connection to the daemon's own socket says who it is by."""
        return self._token if self.address.paths else None

    async def _connected(self) -> Link:
        async with self._lock:
            if self._link and self._link.lost:
                link, self._link = self._link, None
                await link.close()
            if not self._link:
                link = Link(await self.open_channel())
                try:
                    if self.socket_token is not None:
                        await link.ask(calls.token(self.socket_token))
                except BaseException:
                    await link.close()
                    raise
                self._link = link
            return self._link

    async def _do(self, call: Call[T]) -> T:
        deadline: float | None = None
        while True:
            try:
                result = await (await self._connected()).ask(call)
                self.has_answered = True
                return result
            except ConnectionLost:
                if not (call.is_safe and self.has_answered):
                    raise
                deadline = deadline or time.monotonic() + self.patience_s
                if time.monotonic() >= deadline:
                    raise
                await asyncio.sleep(PAUSE_S)


class AsyncEvents(AsyncIterator[Event]):
    """As Events: an endless iterator, to be closed or used with `async with`."""

    def __init__(self, farm: AsyncFarm, ids: Iterable[int] | None, frames: bool, workers: bool) -> None:
        self._farm = farm
        self._ids = None if ids is None else list(ids)
        self._frames = frames
        self._workers = workers
        self._events: deque[Event] = deque()
        self._channel: AsyncChannel | None = None
        self._has_begun = False
        self._lost_since: float | None = None
        self._is_closed = False

    async def __aenter__(self) -> AsyncEvents:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        self._is_closed = True
        if self._channel:
            self._channel.close()

    async def __anext__(self) -> Event:
        while not self._events:
            if self._is_closed:
                raise StopAsyncIteration
            try:
                if not self._channel:
                    await self._open()
                await self._take()
            except ConnectionLost as error:
                self._lose(error)
        return self._events.popleft()

    async def _open(self) -> None:
        if self._lost_since is not None:
            await asyncio.sleep(PAUSE_S)
        self._follower = Follower(self._ids, self._frames, self._workers, self._farm.socket_token)
        self._channel = await self._farm.open_channel()

    async def _take(self) -> None:
        assert self._channel
        for text in self._follower.take_to_send():
            await self._channel.send(text)
        received = await self._channel.receive()
        self._has_begun = True
        if self._lost_since is not None:
            self._lost_since = None
            self._events.append(Reconnected())
        self._events.extend(self._follower.take(received))

    def _lose(self, error: ConnectionLost) -> None:
        if self._channel:
            self._channel.close()
            self._channel = None
        if not (self._has_begun or self._farm.has_answered):
            raise error
        if self._lost_since is None:
            self._lost_since = time.monotonic()
            self._events.append(Disconnected(error.message))
        elif time.monotonic() - self._lost_since > self._farm.patience_s:
            raise error
