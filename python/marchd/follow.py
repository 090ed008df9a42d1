"""Following jobs, without the connection: what to send on it, and which events come of what arrives.

The first events tell each job as it is, also after a connection was lost: no end is missed that came meanwhile."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, TypeAlias

from . import answers, calls, errors

_KINDS: dict[str, type[Any]] = {
    "job": answers.JobEvent,
    "frame": answers.FrameEvent,
    "phase": answers.PhaseEvent,
    "worker": answers.WorkerEvent,
    "deleted": answers.DeletedEvent,
}


@dataclass(frozen=True)
class Disconnected:
    """The connection is lost; it is tried again. What happens meanwhile is told as each job's state after it."""

    reason: str
    type: str = "disconnected"


@dataclass(frozen=True)
class Reconnected:
    """The connection is there again; a job event for each job follows."""

    type: str = "reconnected"


Event: TypeAlias = answers.Event | Disconnected | Reconnected


class Follower:
    """One connection's part of following. `ids` None: all jobs."""

    def __init__(self, ids: Iterable[int] | None, frames: bool, workers: bool, token: str | None) -> None:
        self.ids = None if ids is None else frozenset(ids)
        self._workers = workers
        self._told: set[int] = set()  # by events since the subscription: what a list says of them is older
        self._held: list[Event] | None = []  # of frames and workers, until each job is told; None: all are
        self._asked: dict[int, calls.Call[Any]] = {}
        self._number = 0
        self._to_send: list[str] = []
        if token is not None:
            self._ask(calls.token(token))
        one = next(iter(self.ids)) if self.ids is not None and len(self.ids) == 1 else None
        params: dict[str, Any] = {"frames": frames} if one is None else {"frames": frames, "id": one}
        self._subscription = self._ask(calls.raw("events.subscribe", params))

    def _ask(self, call: calls.Call[Any]) -> int:
        self._number += 1
        self._asked[self._number] = call
        self._to_send.append(call.encode(self._number))
        return self._number

    def take_to_send(self) -> list[str]:
        texts, self._to_send = self._to_send, []
        return texts

    def take(self, text: str) -> list[Event]:
        """What a message means. An error that ends the following is raised."""
        message = calls.decode(text)
        if "method" in message:
            return self._take_event(message["params"])
        call = self._asked.pop(message["id"], None)
        if call is None:
            raise errors.FarmError(str(message.get("error", {}).get("message", "an answer that nobody asked for")))
        if message["id"] == self._subscription:
            return self._take_subscription(call, message)
        result = call.take(message)
        if call.method != "job.list":
            return []
        return self._take_list(call, result)

    def _take_subscription(self, call: calls.Call[Any], message: Any) -> list[Event]:
        try:
            call.take(message)
        except errors.NotFound:
            return [answers.DeletedEvent("deleted", number) for number in self.ids or ()]
        if self.ids is None:
            self._ask(calls.jobs(calls.JobFilter(), None))
            return []
        numbers = sorted(self.ids)
        for start in range(0, len(numbers), calls.PAGE):
            self._ask(calls.some_jobs(numbers[start : start + calls.PAGE]))
        return []

    def _take_list(self, call: calls.Call[Any], result: Any) -> list[Event]:
        found = result.jobs if isinstance(result, answers.JobList) else result
        events: list[Event] = [answers.JobEvent("job", job) for job in found if job.id not in self._told]
        if isinstance(result, answers.JobList):
            if result.next is not None:
                self._ask(calls.jobs(calls.JobFilter(), result.next))
        else:
            gone = sorted(set(call.params["ids"]) - {job.id for job in found} - self._told)
            events += [answers.DeletedEvent("deleted", number) for number in gone]
        if self._held is not None and not any(asked.method == "job.list" for asked in self._asked.values()):
            events += self._held
            self._held = None
        return events

    def _take_event(self, params: Any) -> list[Event]:
        kind = _KINDS.get(params["type"])
        if kind is None:
            return []  # of a later daemon
        try:
            event: answers.Event = kind.from_json(params)
        except TypeError as error:
            raise errors.FarmError(f"the farm tells otherwise than this client expects: {error}") from error
        if isinstance(event, answers.WorkerEvent):
            return self._hold(event) if self._workers else []
        number = event.job.id if isinstance(event, answers.JobEvent) else event.id
        if self.ids is not None and number not in self.ids:
            return []
        if isinstance(event, (answers.JobEvent, answers.DeletedEvent)):
            self._told.add(number)
            return [event]
        return self._hold(event)

    def _hold(self, event: answers.Event) -> list[Event]:
        if self._held is None:
            return [event]
        self._held.append(event)
        return []


class Waiting:
    """What waiting for jobs still needs: events go in, until `is_done`."""

    def __init__(self, ids: Iterable[int]) -> None:
        self.order = list(ids)
        self.over: dict[int, answers.Job] = {}

    @property
    def is_done(self) -> bool:
        return all(number in self.over for number in self.order)

    def note(self, event: Event) -> None:
        if isinstance(event, answers.JobEvent) and event.job.state in calls.OVER:
            self.over[event.job.id] = event.job
        elif isinstance(event, answers.JobEvent):
            self.over.pop(event.job.id, None)
        elif isinstance(event, answers.DeletedEvent) and event.id not in self.over:
            raise errors.NotFound(f"job {event.id}: there is no such job", errors.NOT_FOUND)

    def jobs(self) -> list[answers.Job]:
        return [self.over[number] for number in self.order]
