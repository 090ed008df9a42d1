"""Pictures of frames, which march-web makes: a daemon's own socket has none."""

from __future__ import annotations

import http.client
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlencode

from . import errors
from .address import Address, no_farm

Option = float | int | str | None
TIMEOUT_S = 300.0
_CODES = {400: errors.PARAMS, 401: errors.NOT_ALLOWED, 403: errors.NOT_ALLOWED, 404: errors.NOT_FOUND}


@dataclass(frozen=True)
class Picture:
    """A frame as a PNG. With the `exposure` of one, others can be compared to it."""

    png: bytes
    width_px: int
    height_px: int
    file_width_px: int
    file_height_px: int
    exposure: float | None  # stops; None: of what is no light


def get_picture(address: Address, token: str | None, job: int, frame: int, options: Mapping[str, Option]) -> Picture:
    answer, body = _get(address, token, f"{job}/{frame}.png", options)
    about = json.loads(answer.headers["Marchd-Picture"])
    width_px, height_px = about["width_px"], about["height_px"]
    return Picture(body, width_px, height_px, about["file_width_px"], about["file_height_px"], about.get("exposure"))


def get_header(address: Address, token: str | None, job: int, frame: int) -> dict[str, Any]:
    header: dict[str, Any] = json.loads(_get(address, token, f"{job}/{frame}.json", {})[1])
    return header


def _open(address: Address) -> http.client.HTTPConnection:
    context = address.tls()
    if not context:
        return http.client.HTTPConnection(address.host, address.port, timeout=TIMEOUT_S)
    return http.client.HTTPSConnection(address.host, address.port, timeout=TIMEOUT_S, context=context)


def _get(
    address: Address, token: str | None, name: str, options: Mapping[str, Option]
) -> tuple[http.client.HTTPResponse, bytes]:
    if address.paths:
        raise errors.FarmError("pictures are made by march-web: connect to its address, http://...")
    query = urlencode({key: value for key, value in options.items() if value is not None})
    target = f"{address.base}/frame/{name}" + (f"?{query}" if query else "")
    connection = _open(address)
    try:
        connection.request("GET", target, headers={"Authorization": f"Bearer {token}"} if token else {})
        answer = connection.getresponse()
        body = answer.read()
    except OSError as error:
        raise no_farm(address, error) from error
    except http.client.HTTPException as error:
        raise errors.ConnectionLost(f"{address.text}: {error!r}") from error
    finally:
        connection.close()
    if answer.status == 200:
        return answer, body
    raise _refusal(answer, body)


def _refusal(answer: http.client.HTTPResponse, body: bytes) -> errors.FarmError:
    try:
        text = str(json.loads(body)["error"])
    except (ValueError, TypeError, KeyError):
        text = f"HTTP status {answer.status} {answer.reason}"
    return errors.of_answer("frame", _CODES.get(answer.status, 0), text)
