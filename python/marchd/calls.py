"""The daemon's methods as values: what is sent, and how the result is read. Farm and AsyncFarm send the same calls."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from . import answers, errors
from .job_format import JobDocument

T = TypeVar("T")
JobState = Literal["queued", "running", "paused", "succeeded", "failed", "canceled"]
FrameState = Literal["queued", "running", "succeeded", "failed", "canceled", "skipped"]
Document = JobDocument | Mapping[str, Any]

PAGE = 1000
OVER: frozenset[str] = frozenset({"succeeded", "failed", "canceled"})


@dataclass(frozen=True)
class Call(Generic[T]):
    """A request. A safe one changes nothing: it is sent again where its connection was lost."""

    method: str
    params: dict[str, Any]
    read: Callable[[Any], T]
    is_safe: bool = False

    def encode(self, number: int) -> str:
        request = {"jsonrpc": "2.0", "id": number, "method": self.method, "params": self.params}
        try:
            return json.dumps(request, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        except ValueError as error:
            raise errors.JobError(f"{self.method}: {error}") from None

    def take(self, answer: Mapping[str, Any]) -> T:
        if "error" in answer:
            raise errors.of_answer(self.method, answer["error"]["code"], answer["error"]["message"])
        try:
            return self.read(answer["result"])
        except (KeyError, TypeError) as error:
            text = f"{self.method}: the farm answers otherwise than this client expects: {error}"
            raise errors.FarmError(text) from error


def decode(text: str) -> dict[str, Any]:
    """A message of the daemon: an answer has an id, and a result or an error; a notification a method and params."""
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        message = None
    if isinstance(message, dict):
        error = message.get("error", {"code": 0, "message": ""})
        is_answer = "id" in message and ("result" in message or "error" in message)
        is_told = isinstance(message.get("params"), dict) and isinstance(message["params"].get("type"), str)
        is_right = is_told if "method" in message else is_answer
        if is_right and isinstance(error, dict) and {"code", "message"} <= error.keys():
            return message
    raise errors.ConnectionLost(f"the farm does not keep the protocol: {text:.200}")


def _given(**params: Any) -> dict[str, Any]:
    return {name: value for name, value in params.items() if value is not None}


def _states(state: str | Iterable[str] | None) -> str | list[str] | None:
    return state if state is None or isinstance(state, str) else list(state)


def raw(method: str, params: Mapping[str, Any]) -> Call[Any]:
    return Call(method, dict(params), lambda result: result)


def token(text: str) -> Call[Any]:
    return Call("auth.token", {"token": text}, lambda result: result, is_safe=True)


def status() -> Call[answers.DaemonStatus]:
    return Call("daemon.status", {}, answers.DaemonStatus.from_json, is_safe=True)


def workers() -> Call[list[answers.Worker]]:
    return Call("worker.list", {}, lambda result: answers.WorkerList.from_json(result).workers, is_safe=True)


def drain() -> Call[int]:
    return Call("daemon.drain", {}, lambda result: answers.DaemonDrain.from_json(result).running)


def undrain() -> Call[int]:
    return Call("daemon.undrain", {}, lambda result: answers.DaemonUndrain.from_json(result).running)


def reload() -> Call[answers.DaemonReload]:
    return Call("daemon.reload", {}, answers.DaemonReload.from_json)


def submit(document: Document, paused: bool) -> Call[int]:
    params = {"document": document, "paused": paused}
    return Call("job.submit", params, lambda result: answers.JobSubmit.from_json(result).id)


def job(number: int) -> Call[answers.JobShow]:
    return Call("job.show", {"id": number}, answers.JobShow.from_json, is_safe=True)


@dataclass(frozen=True)
class JobFilter:
    """Which jobs: those that fulfil all that is not None. `name` is a part of a name, times are unix seconds."""

    state: JobState | Iterable[JobState] | None = None
    owner: str | None = None
    name: str | None = None
    since: float | None = None
    before: float | None = None
    newest_first: bool = False


def jobs(filter: JobFilter, cursor: str | None, limit: int = PAGE) -> Call[answers.JobList]:
    params = _given(state=_states(filter.state), owner=filter.owner, name=filter.name, since=filter.since)
    params |= _given(before=filter.before, cursor=cursor, order="-id" if filter.newest_first else None, limit=limit)
    return Call("job.list", params, answers.JobList.from_json, is_safe=True)


def some_jobs(numbers: Iterable[int]) -> Call[list[answers.Job]]:
    """Those of at most 1000 jobs that are known."""
    params = {"ids": list(numbers)}
    return Call("job.list", params, lambda result: answers.JobList.from_json(result).jobs, is_safe=True)


def frames(
    number: int, state: FrameState | Iterable[FrameState] | None, range: str | None, cursor: str | None
) -> Call[answers.JobFrames]:
    params = {"id": number, **_given(state=_states(state), range=range, cursor=cursor), "limit": PAGE}
    return Call("job.frames", params, answers.JobFrames.from_json, is_safe=True)


def frame_map(number: int, offset: int) -> Call[answers.JobFrameMap]:
    return Call("job.frame_map", {"id": number, "offset": offset}, answers.JobFrameMap.from_json, is_safe=True)


def log(number: int, frame: int | None, limit: int | None) -> Call[list[answers.Attempt]]:
    params = {"id": number, **_given(frame=frame, limit=limit)}
    return Call("job.log", params, lambda result: answers.JobLog.from_json(result).attempts, is_safe=True)


def change(method: Literal["pause", "resume", "cancel"], number: int) -> Call[answers.Job]:
    return Call(f"job.{method}", {"id": number}, answers.Job.from_json)


def priority(number: int, value: int) -> Call[answers.Job]:
    return Call("job.priority", {"id": number, "priority": value}, answers.Job.from_json)


def retry(number: int, state: FrameState | Iterable[FrameState] | None, range: str | None, force: bool) -> Call[int]:
    params = {"id": number, **_given(state=_states(state), range=range), "force": force}
    return Call("job.retry", params, lambda result: answers.JobRetry.from_json(result).retried)


def delete(number: int, files: bool) -> Call[answers.JobDelete]:
    return Call("job.delete", {"id": number, "files": files}, answers.JobDelete.from_json)
