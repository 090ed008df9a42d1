"""marchd: submit jobs to a render farm, wait for them, and hear what happens to them."""

from .answers import (
    Attempt,
    DaemonStatus,
    DeletedEvent,
    Frame,
    FrameEvent,
    Job,
    JobEvent,
    JobShow,
    PhaseEvent,
    Worker,
    WorkerEvent,
)
from .async_farm import AsyncEvents, AsyncFarm
from .errors import (
    ConnectionLost,
    Conflict,
    FarmError,
    JobError,
    NotAllowed,
    NotFound,
    NotTrusted,
    StoreError,
    WrongRequest,
)
from .farm import Events, Farm
from .follow import Disconnected, Event, Reconnected
from .job_files import load_job, resolve_files
from .job_format import JobDocument
from .pictures import Picture

__all__ = [
    "AsyncEvents",
    "AsyncFarm",
    "Attempt",
    "Conflict",
    "ConnectionLost",
    "DaemonStatus",
    "DeletedEvent",
    "Disconnected",
    "Event",
    "Events",
    "Farm",
    "FarmError",
    "Frame",
    "FrameEvent",
    "Job",
    "JobDocument",
    "JobError",
    "JobEvent",
    "JobShow",
    "NotAllowed",
    "NotFound",
    "NotTrusted",
    "PhaseEvent",
    "Picture",
    "Reconnected",
    "StoreError",
    "Worker",
    "WorkerEvent",
    "WrongRequest",
    "load_job",
    "resolve_files",
]
