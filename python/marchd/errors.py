"""What can go wrong, as exceptions: each has the daemon's code, and where in a job or in the parameters it is wrong."""

from __future__ import annotations

import re

PARAMS, NOT_FOUND, NOT_ALLOWED, CONFLICT, STORE = -32602, 1, 2, 3, 4
_PLACE = re.compile(r"((?:\w+|\[\d+\])(?:\.\w+|\[\d+\])*): (.*)", re.S)


class FarmError(Exception):
    """The farm refused, or could not be asked. `code` is that of docs/protocol.md; None: there was no answer."""

    def __init__(self, message: str, code: int | None = None, place: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.code = code
        self.place = place  # "scene.media[0].g" of a job, "limit" of parameters; None: the message names no place


class WrongRequest(FarmError):
    """The daemon does not take such a request."""


class JobError(WrongRequest):
    """The job is wrong at `place`."""


class NotFound(FarmError):
    """There is no such job."""


class NotAllowed(FarmError):
    """This user may not do that, or would exceed a limit."""


class Conflict(FarmError):
    """It cannot be done as things are: the job is over, another job writes the file, ..."""


class StoreError(FarmError):
    """The daemon cannot store anything at the moment."""


class NotTrusted(FarmError):
    """The certificate of an https:// address is not of an authority that is trusted, is another host's, or is too old."""


class ConnectionLost(FarmError):
    """There is no daemon, or it went away. Whether the last change was done is then unknown."""


_CLASSES = {NOT_FOUND: NotFound, NOT_ALLOWED: NotAllowed, CONFLICT: Conflict, STORE: StoreError}


def of_answer(method: str, code: int, message: str) -> FarmError:
    """The exception that stands for an answer with an error."""
    text = message
    for prefix in ("params.", "document."):
        text = text.removeprefix(prefix)
    is_job = method == "job.submit"
    found = _PLACE.fullmatch(text) if is_job or text != message else None
    place = found.group(1) if found else None
    if code == PARAMS:
        return (JobError if is_job and place else WrongRequest)(text if is_job else message, code, place)
    return _CLASSES.get(code, FarmError)(text if is_job else message, code, place)
