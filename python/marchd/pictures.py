"""Pictures of frames, which march-web makes: a daemon's own socket has none."""

from __future__ import annotations

import http.client
import ssl
from collections.abc import Mapping
from urllib.parse import urlencode

from . import errors
from .address import Address, no_farm

Option = float | int | str | None
TIMEOUT_S = 120.0
_CODES = {
    400: errors.PARAMS,
    401: errors.NOT_ALLOWED,
    403: errors.NOT_ALLOWED,
    404: errors.NOT_FOUND,
    409: errors.CONFLICT,
}


def get(address: Address, token: str | None, job: int, name: str, options: Mapping[str, Option]) -> bytes:
    """GET /frame/JOB/NAME."""
    if address.paths:
        raise errors.FarmError("pictures are made by march-web: connect to its address, http://...")
    query = urlencode({key: value for key, value in options.items() if value is not None})
    target = f"{address.base}/frame/{job}/{name}" + (f"?{query}" if query else "")
    if address.is_secure:
        connection: http.client.HTTPConnection = http.client.HTTPSConnection(
            address.host, address.port, timeout=TIMEOUT_S, context=ssl.create_default_context()
        )
    else:
        connection = http.client.HTTPConnection(address.host, address.port, timeout=TIMEOUT_S)
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
        return body
    text = body[:1000].decode(errors="replace").strip() or answer.reason
    raise errors.of_answer("frame", _CODES.get(answer.status, 0), f"{text} (HTTP status {answer.status})")
