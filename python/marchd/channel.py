"""A connection to a farm that blocks: text messages out and in."""

from __future__ import annotations

import socket
import ssl
import time
from collections import deque

from . import address as addresses
from .errors import ConnectionLost

CONNECT_S = 30.0


def _connect_socket(address: addresses.Address) -> socket.socket:
    reason = OSError("nowhere to look")
    for path in address.paths:
        connection = socket.socket(socket.AF_UNIX)
        try:
            connection.connect(path)
            return connection
        except OSError as error:
            connection.close()
            reason = error
    if address.paths:
        raise addresses.no_farm(address, reason)
    context = address.tls()
    try:
        plain = socket.create_connection((address.host, address.port), CONNECT_S)
        return context.wrap_socket(plain, server_hostname=address.host) if context else plain
    except OSError as error:
        raise addresses.no_farm(address, error) from error


class Channel:
    """An open connection. Every way in which it can end is ConnectionLost."""

    def __init__(self, address: addresses.Address, token: str | None) -> None:
        self._framing = address.framing(token)
        self._messages: deque[str] = deque()
        self._socket = _connect_socket(address)
        try:
            if self._framing.opening:
                self._send(self._framing.opening)
            deadline = time.monotonic() + CONNECT_S
            while not self._framing.is_open:
                if not self._read(deadline):
                    raise ConnectionLost(f"{address.text} does not answer")
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        self._socket.close()

    def send(self, text: str) -> None:
        self._send(self._framing.encode(text))

    def receive(self, deadline: float | None = None) -> str | None:
        """The next message. None: there is none until the deadline (of time.monotonic)."""
        while not self._messages:
            if not self._read(deadline):
                return None
        return self._messages.popleft()

    def is_alive(self) -> bool:
        """Whether the other side has not ended the connection, as far as is known without waiting."""
        try:
            while self._read(time.monotonic()):
                pass
        except ConnectionLost:
            return False
        return True

    def _send(self, data: bytes) -> None:
        try:
            self._socket.settimeout(None)
            self._socket.sendall(data)
        except OSError as error:
            raise ConnectionLost(f"the connection is lost: {error.strerror or error}") from error

    def _read(self, deadline: float | None) -> bool:
        """Takes what has come, or waits for something. False: there is nothing until the deadline."""
        try:
            self._socket.settimeout(None if deadline is None else max(0.0, deadline - time.monotonic()))
            received = self._socket.recv(1 << 18)
        except (BlockingIOError, ssl.SSLWantReadError):
            return False
        except OSError as error:
            if isinstance(error, TimeoutError) and error.errno is None:
                return False
            raise ConnectionLost(f"the connection is lost: {error.strerror or error}") from error
        if not received:
            raise ConnectionLost("the farm ended the connection")
        self._messages.extend(self._framing.feed(received))
        if replies := self._framing.take_replies():
            self._send(replies)
        return True
