"""Where a farm is: a unix socket, or march-web's address; and how messages become bytes there."""

from __future__ import annotations

import ipaddress
import os
import ssl
from dataclasses import dataclass, replace
from typing import Protocol
from urllib.parse import urlsplit

from .errors import ConnectionLost, FarmError, NotTrusted
from .websocket import WebSocket


class Framing(Protocol):
    """Messages as bytes. `opening` is sent first; nothing else is before `is_open`."""

    opening: bytes
    is_open: bool

    def encode(self, text: str) -> bytes: ...

    def feed(self, received: bytes) -> list[str]: ...

    def take_replies(self) -> bytes: ...


class Lines:
    """A message is a line: the daemon's own socket."""

    opening = b""
    is_open = True

    def __init__(self) -> None:
        self._parts: list[bytes] = []

    def encode(self, text: str) -> bytes:
        return text.encode() + b"\n"

    def feed(self, received: bytes) -> list[str]:
        head, newline, rest = received.rpartition(b"\n")
        if not newline:
            self._parts.append(rest)
            return []
        whole = b"".join([*self._parts, head])
        self._parts = [rest]
        return [line.decode(errors="replace") for line in whole.split(b"\n")]

    def take_replies(self) -> bytes:
        return b""


@dataclass(frozen=True)
class Address:
    """A farm's address, read from text: unix:PATH, a path, http://HOST:PORT or https://HOST."""

    text: str
    paths: tuple[str, ...]  # of sockets, which are tried in order; empty: march-web
    host: str = ""
    port: int = 0
    is_secure: bool = False
    base: str = ""  # of paths of the URL, without / at its end
    cafile: str | None = None  # PEM file of certificates that are trusted; None: those of the system

    def framing(self, token: str | None) -> Framing:
        if self.paths:
            return Lines()
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        return WebSocket(self.authority, f"{self.base}/ws", headers)

    def tls(self) -> ssl.SSLContext | None:
        """What checks the certificate of an https:// address, and that it is this host's; None: no TLS."""
        if not self.is_secure:
            return None
        try:
            return ssl.create_default_context(cafile=self.cafile)
        except OSError as error:
            raise FarmError(f"certificates of {self.cafile}: {error.strerror or error}") from error

    @property
    def authority(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return host if self.port == (443 if self.is_secure else 80) else f"{host}:{self.port}"


def find(text: str | None, token: str | None, cafile: str | os.PathLike[str] | None) -> Address:
    """Where a farm is, by what its user has said: FarmError where that cannot be."""
    address = usual() if text is None else parse(text)
    if cafile is not None and not address.is_secure:
        raise FarmError(f"cafile is for https:// addresses, not for {address.text}")
    _check_token(address, token)
    return address if cafile is None else replace(address, cafile=os.fspath(cafile))


def parse(text: str) -> Address:
    if text.startswith("unix:"):
        return Address(text, (text.removeprefix("unix:"),))
    if "://" not in text:
        return Address(text, (text,))
    parts = urlsplit(text)
    if parts.scheme not in ("http", "https") or not parts.hostname or parts.query or parts.fragment or parts.username:
        raise FarmError(f'expected unix:PATH, http://HOST:PORT or https://HOST, got "{text}"')
    is_secure = parts.scheme == "https"
    port = parts.port or (443 if is_secure else 80)
    return Address(text, (), parts.hostname, port, is_secure, parts.path.rstrip("/"))


def _check_token(address: Address, token: str | None) -> None:
    """Refuses to send a token in clear text over a network, and one that would be more than a header's value."""
    if token is not None and not (token.isascii() and token.isprintable() and " " not in token):
        raise FarmError("a token has no spaces and no control characters")
    if token and address.host and not address.is_secure and not _is_this_machine(address.host):
        raise FarmError(f"a token is sent over https:// or to this machine only, not to {address.text}")


def _is_this_machine(host: str) -> bool:
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def usual() -> Address:
    """Where march looks: $MARCHD_SOCKET, else the system's farm, else the user's own."""
    named = os.environ.get("MARCHD_SOCKET")
    if named:
        return Address(named, (named,))
    paths = ["/run/marchd/marchd.sock"]
    if runtime := os.environ.get("XDG_RUNTIME_DIR"):
        paths.append(f"{runtime}/marchd.sock")
    elif state := os.environ.get("XDG_STATE_HOME"):
        paths.append(f"{state}/marchd/marchd.sock")
    elif home := os.environ.get("HOME"):
        paths.append(f"{home}/.local/state/marchd/marchd.sock")
    return Address(" or ".join(paths), tuple(paths))


def no_farm(address: Address, reason: OSError) -> FarmError:
    if isinstance(reason, ssl.SSLCertVerificationError):
        return NotTrusted(f"the certificate of {address.text} is not trusted: {reason.verify_message}")
    return ConnectionLost(f"no farm answers at {address.text}: {reason.strerror or reason}")
