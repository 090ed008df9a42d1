"""What the daemon answers: jobs, frames, workers, events, and the results of its methods.

Generated from `marchd --openrpc` by python/update."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from .answer import Answer


@dataclass(frozen=True)
class Job(Answer):
    """A job without its document."""

    # its number, which no other job ever has
    id: int
    # as the document has it
    name: str
    # where it stands
    state: Literal["queued", "running", "paused", "succeeded", "failed", "canceled"]
    # its quality is a draft's
    draft: bool
    # higher ones come first
    priority: int
    # the user who submitted it
    owner: str
    # the same as a number
    owner_uid: int
    # unix seconds
    submitted: float
    # unix seconds; null: no frame was begun
    started: float | None
    # unix seconds; null: it is not over
    finished: float | None
    # all of its frames
    frames: int
    # frames that wait
    queued: int
    # frames that workers have
    running: int
    # frames that are published
    succeeded: int
    # frames that failed in each attempt
    failed: int
    # frames that were canceled
    canceled: int
    # frames whose file was there
    skipped: int
    # of those that succeeded or were skipped: over the tolerance
    missed: int
    # of a frame's measured error
    tolerance: float | None
    # that it states, or that was chosen for the frame that was done last
    method: str | None
    # of that frame: the estimated relative RMSE
    measured_error: float | None
    # its error is below it with a confidence of 95 %
    error95: float | None
    # its frames, as in 1-100x2,140
    range: str
    # the absolute pattern of its files
    output: str
    # the pool that it asks for
    pool: str | None
    # median of recent frames, or what its plan foretells
    seconds_per_frame: float | None
    # seconds until it is over; null: unknown
    eta_s: float | None
    # of the frame whose phase is the furthest
    phase: Literal["encode", "link", "plan", "render", "audit"] | None
    # how much of that phase is done, from 0 to 1
    phase_progress: float | None
    # why it waits, or failed
    reason: str | None
    # jobs that it waits for; none: it waits for no job
    after: list[int]
    # as the document has it
    comment: str | None
    # as the document has them
    tags: list[str]


@dataclass(frozen=True)
class Frame(Answer):
    """A frame; with a file it has the accuracy, too."""

    # its number
    frame: int
    # where it stands
    state: Literal["queued", "running", "succeeded", "failed", "canceled", "skipped"]
    # attempts that were begun
    attempts: int
    # the worker that has it, or had it last
    worker: int | None
    # the machine of a running frame; null: the daemon's
    node: str | None
    # seconds of rendering
    render_s: float | None
    # seconds until the file was whole
    encode_s: float | None
    # seconds in which pixels were compared
    audit_s: float | None
    # of its file
    size_bytes: int | None
    # of its file
    hash: str | None
    # the absolute path of its file
    path: str | None
    # why it failed
    error: str | None
    # of a running frame: what its worker does
    phase: Literal["encode", "link", "plan", "render", "audit"] | None
    # how much of that phase is done, from 0 to 1
    phase_progress: float | None
    # what its pixels were compared with
    audit: Literal["reference", "step_halving"] | None = None
    # the estimated relative RMSE
    measured_error: float | None = None
    # the error is below it with a confidence of 95 %
    error95: float | None = None
    # pixels compared
    audit_rays: int | None = None
    # the method that was chosen
    method: str | None = None
    # the number of the plan with which the frame began
    plan: int | None = None
    # true: published, although it is over the tolerance
    missed: bool | None = None
    # share of the light that cut paths may have had
    cut_share: float | None = None
    # share of its samples that were traced
    traced: float | None = None


@dataclass(frozen=True)
class Worker(Answer):
    """A place of a worker, with the process that is there."""

    # its number
    id: int
    # local, or the name of a pool of the settings
    pool: str
    # its machine; null: the daemon's
    node: str | None
    # on its machine
    pid: int | None
    # what it does; waiting: for its node
    state: Literal["starting", "idle", "busy", "backing_off", "stopping", "waiting"]
    # how it renders
    backend: str | None
    # of GL
    vendor: str | None
    # of GL
    renderer: str | None
    # of GL
    version: str | None
    # of its GPU
    device_uuid: str | None
    # what restricts it
    sandbox: str | None
    # the job whose frames it has
    job: int | None
    # frames that it has
    frames: int
    # frames that it did
    done: int
    # why it does not work
    reason: str | None


@dataclass(frozen=True)
class Attempt(Answer):
    """One try at a frame."""

    # its number
    frame: int
    # from 1
    attempt: int
    # the worker that had it
    worker: int
    # unix seconds
    ended: float
    # lost: its worker was gone
    outcome: Literal["failed", "lost"]
    # what the worker said
    log: str


@dataclass(frozen=True)
class Plan(Answer):
    """How the frames of a segment are rendered."""

    # frames name it as their plan
    number: int
    # as a job would state it, of frames that are not refined
    quality: dict[str, Any]
    # why this one
    why: str
    # its relative RMSE in frames that lie evenly over the segment
    scouts: list[float]
    # what the modelled orders of scattering leave out: error, error95; or why it is unknown
    beyond: dict[str, Any] | None = None


@dataclass(frozen=True)
class Root(Answer):
    """An output root of the settings or of a job."""

    # absolute
    path: str
    # of its marker; null: it was never there
    id: str | None
    # whether files can be written below it
    is_there: bool
    # why not
    reason: str | None


@dataclass(frozen=True)
class Store(Answer):
    """The queue on disk."""

    # short: its disk is full; failing: nothing can be stored
    state: Literal["ok", "short", "failing"]
    # what is wrong
    reason: str | None
    # changes that are not on disk
    waiting: int


@dataclass(frozen=True)
class JobCounts(Answer):
    """Jobs by their state."""

    # jobs
    queued: int
    # jobs
    running: int
    # jobs
    paused: int
    # jobs
    succeeded: int
    # jobs
    failed: int
    # jobs
    canceled: int


@dataclass(frozen=True)
class FrameCounts(Answer):
    """Frames by their state."""

    # frames
    queued: int
    # frames
    running: int
    # frames
    succeeded: int
    # frames
    failed: int
    # frames
    canceled: int
    # frames
    skipped: int


@dataclass(frozen=True)
class NodeCounts(Answer):
    """Other machines."""

    # nodes whose workers can render
    up: int
    # nodes that are waited for
    waiting: int


@dataclass(frozen=True)
class Drain(Answer):
    """The farm begins no frame."""

    # who asked for it
    user: str
    # unix seconds
    since: float


@dataclass(frozen=True)
class Loop(Answer):
    """Turns of the daemon's loop since its start, in processor time."""

    # the longest turn
    longest_ms: float
    # all turns
    sum_s: float
    # upper bounds of classes of turns
    up_to_ms: list[int]
    # turns in each class, and above the last
    counts: list[int]


@dataclass(frozen=True)
class Sample(Answer):
    """A counter or a gauge."""

    # texts by their names
    labels: dict[str, Any]
    # now
    value: float


@dataclass(frozen=True)
class Histogram(Answer):
    """Observations by their size."""

    # texts by their names
    labels: dict[str, Any]
    # pairs of an upper end, and how many observations are up to it
    buckets: list[list[float]]
    # of the observations
    sum: float
    # all observations
    count: int


@dataclass(frozen=True)
class Family(Answer):
    """Samples of one name."""

    # of letters, digits and _
    name: str
    # what its samples are
    type: Literal["counter", "gauge", "histogram"]
    # one sentence
    help: str
    # by their labels
    samples: list[AnySample]


@dataclass(frozen=True)
class JobEvent(Answer):
    """A job's state or counts changed."""

    # what happened
    type: Literal["job"]
    # as it is now
    job: Job


@dataclass(frozen=True)
class FrameEvent(Answer):
    """An attempt started or ended."""

    # what happened
    type: Literal["frame"]
    # the job
    id: int
    # its number
    frame: int
    # queued: it is tried again
    state: Literal["queued", "running", "succeeded", "failed", "canceled", "skipped"]
    # from 1
    attempt: int
    # why the attempt failed
    error: str | None


@dataclass(frozen=True)
class PhaseEvent(Answer):
    """How far a running frame is."""

    # what happened
    type: Literal["phase"]
    # the job
    id: int
    # its number
    frame: int
    # from 1
    attempt: int
    # what its worker does
    phase: Literal["encode", "link", "plan", "render", "audit"]
    # how much of that phase is done, from 0 to 1
    phase_progress: float | None


@dataclass(frozen=True)
class WorkerEvent(Answer):
    """A worker started, is ready, stops or is gone."""

    # what happened
    type: Literal["worker"]
    # as it is now
    worker: Worker


@dataclass(frozen=True)
class DeletedEvent(Answer):
    """The last event of a job."""

    # what happened
    type: Literal["deleted"]
    # the job
    id: int


@dataclass(frozen=True)
class Token(Answer):
    """A token without its text."""

    # its number, which no other token ever has
    id: int
    # what its user calls it
    name: str
    # what it is for
    scope: Literal["read", "submit", "admin"]
    # unix seconds
    created: float
    # unix seconds; null: never
    expires: float | None
    # unix seconds, to a minute; null: never
    last_used: float | None
    # it is for one use
    once: bool
    # whose it is
    user: str


@dataclass(frozen=True)
class Notice(Answer):
    """What a target is to be told."""

    # greater than that of each notice before
    id: int
    # whose notice it is
    job: int
    # of the job
    owner_uid: int
    # unix seconds
    made: float
    # what happened
    event: Literal["done", "failed", "waiting", "missed"]
    # the name of its target; null: it goes to an address
    to: str | None
    # the address
    webhook: str | None
    # what the target gets, as JSON
    body: str


@dataclass(frozen=True)
class DaemonStatus(Answer):
    """The result of daemon.status."""

    # of marchd
    version: str
    # of the daemon
    pid: int
    # unix seconds
    started: float
    # the first of output_roots
    output_root: str
    # folders below which output goes
    output_roots: list[str]
    # folders below which jobs may read
    input_roots: list[str]
    # the output roots of settings and jobs
    roots: list[Root]
    # folder of the queue
    state_folder: str
    # whether changes can be stored
    store: Store
    # all jobs
    jobs: JobCounts
    # all frames
    frames: FrameCounts
    # places of workers
    workers: int
    # other machines
    nodes: NodeCounts
    # who drained the farm; null: nobody
    drain: Drain | None
    # how long the turns of the loop were
    loop: Loop


@dataclass(frozen=True)
class DaemonMetrics(Answer):
    """The result of daemon.metrics."""

    # what is counted, of all labels
    families: list[Family]


@dataclass(frozen=True)
class DaemonDrain(Answer):
    """The result of daemon.drain."""

    # frames that run
    running: int


@dataclass(frozen=True)
class DaemonUndrain(Answer):
    """The result of daemon.undrain."""

    # frames that run
    running: int


@dataclass(frozen=True)
class DaemonReload(Answer):
    """The result of daemon.reload."""

    # settings that hold now
    changed: list[str]
    # settings that changed, and need a restart
    restart: list[str]


@dataclass(frozen=True)
class WorkerList(Answer):
    """The result of worker.list."""

    # all places of workers
    workers: list[Worker]


@dataclass(frozen=True)
class JobSubmit(Answer):
    """The result of job.submit."""

    # the new job
    id: int
    # what nobody could check now
    warnings: list[str] | None = None


@dataclass(frozen=True)
class JobRetry(Answer):
    """The result of job.retry."""

    # frames that were queued
    retried: int


@dataclass(frozen=True)
class JobDelete(Answer):
    """The result of job.delete."""

    # files that are gone now
    files_removed: int
    # files that stay, since they are not what was published
    files_kept: int
    # files that were gone before
    files_missing: int
    # files of skipped frames, which stay
    files_found: int


@dataclass(frozen=True)
class JobList(Answer):
    """The result of job.list."""

    # by their ids
    jobs: list[Job]
    # the cursor of the next page; null: there is none
    next: str | None
    # how many there are on all pages
    total: int


@dataclass(frozen=True)
class JobShow(Answer):
    """The result of job.show."""

    # its number, which no other job ever has
    id: int
    # as the document has it
    name: str
    # where it stands
    state: Literal["queued", "running", "paused", "succeeded", "failed", "canceled"]
    # its quality is a draft's
    draft: bool
    # higher ones come first
    priority: int
    # the user who submitted it
    owner: str
    # the same as a number
    owner_uid: int
    # unix seconds
    submitted: float
    # unix seconds; null: no frame was begun
    started: float | None
    # unix seconds; null: it is not over
    finished: float | None
    # all of its frames
    frames: int
    # frames that wait
    queued: int
    # frames that workers have
    running: int
    # frames that are published
    succeeded: int
    # frames that failed in each attempt
    failed: int
    # frames that were canceled
    canceled: int
    # frames whose file was there
    skipped: int
    # of those that succeeded or were skipped: over the tolerance
    missed: int
    # of a frame's measured error
    tolerance: float | None
    # that it states, or that was chosen for the frame that was done last
    method: str | None
    # of that frame: the estimated relative RMSE
    measured_error: float | None
    # its error is below it with a confidence of 95 %
    error95: float | None
    # its frames, as in 1-100x2,140
    range: str
    # the absolute pattern of its files
    output: str
    # the pool that it asks for
    pool: str | None
    # median of recent frames, or what its plan foretells
    seconds_per_frame: float | None
    # seconds until it is over; null: unknown
    eta_s: float | None
    # of the frame whose phase is the furthest
    phase: Literal["encode", "link", "plan", "render", "audit"] | None
    # how much of that phase is done, from 0 to 1
    phase_progress: float | None
    # why it waits, or failed
    reason: str | None
    # jobs that it waits for; none: it waits for no job
    after: list[int]
    # as the document has it
    comment: str | None
    # as the document has them
    tags: list[str]
    # as it was submitted; null: of somebody else's job
    document: dict[str, Any] | None


@dataclass(frozen=True)
class JobFrames(Answer):
    """The result of job.frames."""

    # in the job's order
    frames: list[Frame]
    # the cursor of the next page; null: there is none
    next: str | None
    # how many there are without offset and limit
    total: int


@dataclass(frozen=True)
class JobFrameMap(Answer):
    """The result of job.frame_map."""

    # all frames of the job, as in 1-100x2,140
    frames: str
    # how many they are
    total: int
    # how many of them come before the first that is told
    offset: int
    # a letter a frame: q(ueued), r(unning), s(ucceeded), f(ailed), c(anceled), k: skipped, m(issed the tolerance)
    states: str
    # of rendering, audit and encoding of each frame that was rendered
    seconds: list[float | None]
    # measured error of each frame that has a file
    errors: list[float | None]
    # the bound of that error with a confidence of 95 %
    errors95: list[float | None]


@dataclass(frozen=True)
class JobPlans(Answer):
    """The result of job.plans."""

    # those of its owner for equal pictures, the newest first
    plans: list[Plan]


@dataclass(frozen=True)
class JobLog(Answer):
    """The result of job.log."""

    # that ended without a file
    attempts: list[Attempt]


@dataclass(frozen=True)
class AuthToken(Answer):
    """The result of auth.token."""

    # whose requests the connection's are from here on
    user: str
    # the same as a number
    uid: int
    # what they may be
    scope: Literal["read", "submit", "admin"]
    # unix seconds; null: never
    expires: float | None
    # after a token for one use: another one, in place of it
    session: str | None


@dataclass(frozen=True)
class TokenCreate(Answer):
    """The result of token.create."""

    # its number
    id: int
    # its text, which nobody can ask for again
    token: str


@dataclass(frozen=True)
class TokenList(Answer):
    """The result of token.list."""

    # of the user; of all users, for administrators
    tokens: list[Token]


@dataclass(frozen=True)
class NotifyPending(Answer):
    """The result of notify.pending."""

    # by their ids; of many the first
    notices: list[Notice]
    # how many were dropped since the daemon's start, because too many waited
    dropped: int


# A sample or a histogram, by the family's type.
AnySample: TypeAlias = Sample | Histogram


# The params of a notification `event`.
Event: TypeAlias = JobEvent | FrameEvent | PhaseEvent | WorkerEvent | DeletedEvent

__all__ = [
    "AnySample",
    "Attempt",
    "AuthToken",
    "DaemonDrain",
    "DaemonMetrics",
    "DaemonReload",
    "DaemonStatus",
    "DaemonUndrain",
    "DeletedEvent",
    "Drain",
    "Event",
    "Family",
    "Frame",
    "FrameCounts",
    "FrameEvent",
    "Histogram",
    "Job",
    "JobCounts",
    "JobDelete",
    "JobEvent",
    "JobFrameMap",
    "JobFrames",
    "JobList",
    "JobLog",
    "JobPlans",
    "JobRetry",
    "JobShow",
    "JobSubmit",
    "Loop",
    "NodeCounts",
    "Notice",
    "NotifyPending",
    "PhaseEvent",
    "Plan",
    "Root",
    "Sample",
    "Store",
    "Token",
    "TokenCreate",
    "TokenList",
    "Worker",
    "WorkerEvent",
    "WorkerList",
]
