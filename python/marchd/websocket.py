"""The client's side of RFC 6455, without a socket: bytes in, text messages out. No extension is asked for."""

from __future__ import annotations

import base64
import hashlib
import os
import struct

from .errors import NOT_ALLOWED, ConnectionLost, NotAllowed

_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_CONTINUATION, _TEXT, _BINARY, _CLOSE, _PING, _PONG = 0, 1, 2, 8, 9, 10
HEAD_LIMIT, MESSAGE_LIMIT = 64 * 1024, 256 * 1024 * 1024


class WebSocket:
    """One connection: send `opening`, hand what comes to `feed`, and send what `take_replies` gives after it."""

    def __init__(self, host: str, path: str, headers: dict[str, str]) -> None:
        self._key = base64.b64encode(os.urandom(16))
        self._bytes = bytearray()
        self._message = bytearray()
        self._is_within = False  # a message whose last part is still to come
        self._replies = bytearray()
        self.is_open = False
        lines = [f"GET {path} HTTP/1.1", f"Host: {host}", "Upgrade: websocket", "Connection: Upgrade"]
        lines += ["Sec-WebSocket-Version: 13", "Sec-WebSocket-Protocol: marchd"]
        lines += [f"Sec-WebSocket-Key: {self._key.decode()}"]
        lines += [f"{name}: {value}" for name, value in headers.items()]
        self.opening = "".join(line + "\r\n" for line in [*lines, ""]).encode("latin-1")

    def encode(self, text: str) -> bytes:
        return _frame(_TEXT, text.encode())

    def take_replies(self) -> bytes:
        replies = bytes(self._replies)
        self._replies.clear()
        return replies

    def feed(self, received: bytes) -> list[str]:
        """The messages that are whole now. ConnectionLost: the other side closes, or does not keep the protocol."""
        self._bytes += received
        if not self.is_open and not self._read_head():
            return []
        messages: list[str] = []
        while (part := self._take_frame()) is not None:
            self._note(*part, messages)
        return messages

    def _read_head(self) -> bool:
        head, separator, rest = bytes(self._bytes).partition(b"\r\n\r\n")
        if not separator:
            if len(self._bytes) > HEAD_LIMIT:
                raise ConnectionLost("the answer to the WebSocket's request is too long")
            return False
        status, *lines = head.decode("latin-1").split("\r\n")
        headers = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
        code = status.split(" ")[1] if status.count(" ") else "0"
        if code in ("401", "403"):
            raise NotAllowed(f"the server refuses: {status}", NOT_ALLOWED)
        accept = base64.b64encode(hashlib.sha1(self._key + _GUID).digest()).decode()
        if code != "101" or headers.get("sec-websocket-accept") != accept:
            raise ConnectionLost(f"the server opens no WebSocket: {status}")
        if headers.get("sec-websocket-protocol") != "marchd" or "sec-websocket-extensions" in headers:
            raise ConnectionLost("the server does not speak marchd's protocol on its WebSocket")
        self._bytes = bytearray(rest)
        self.is_open = True
        return True

    def _take_frame(self) -> tuple[bool, int, bytes] | None:
        """The first frame: whether it is a message's last, its kind, its bytes. None: it is not whole."""
        if len(self._bytes) < 2:
            return None
        first, second = self._bytes[0], self._bytes[1]
        start, length = 2, second & 127
        if length > 125:
            form = ">H" if length == 126 else ">Q"
            start += struct.calcsize(form)
            if len(self._bytes) < start:
                return None
            (length,) = struct.unpack_from(form, self._bytes, 2)
        if first & 0x70 or second & 0x80 or length > MESSAGE_LIMIT:
            raise ConnectionLost("the server sends what is no WebSocket frame")
        if len(self._bytes) < start + length:
            return None
        body = bytes(self._bytes[start : start + length])
        del self._bytes[: start + length]
        return bool(first & 0x80), first & 15, body

    def _note(self, is_last: bool, kind: int, body: bytes, messages: list[str]) -> None:
        if kind in (_CLOSE, _PING, _PONG):
            self._note_control(is_last, kind, body)
            return
        expected = _CONTINUATION if self._is_within else _TEXT
        if kind != expected or len(self._message) + len(body) > MESSAGE_LIMIT:
            raise ConnectionLost("the server sends a WebSocket message that is none of text")
        self._message += body
        self._is_within = not is_last
        if is_last:
            try:
                messages.append(self._message.decode())
            except UnicodeDecodeError:
                raise ConnectionLost("the server sends text that is not UTF-8") from None
            self._message.clear()

    def _note_control(self, is_last: bool, kind: int, body: bytes) -> None:
        if not is_last or len(body) > 125:
            raise ConnectionLost("the server sends what is no WebSocket frame")
        if kind == _PING:
            self._replies += _frame(_PONG, body)
        elif kind == _CLOSE:
            code = int.from_bytes(body[:2], "big")
            reason = body[2:].decode(errors="replace")
            if code == 1008:
                raise NotAllowed(reason or "the server refuses", NOT_ALLOWED)
            away = "the daemon is away" if code == 1013 else f"the server closes the WebSocket ({code})"
            raise ConnectionLost(f"{away}: {reason}" if reason else away)


def _frame(kind: int, body: bytes) -> bytes:
    """A whole message, masked as a client's must be."""
    length = len(body)
    head = bytes([0x80 | kind])
    if length < 126:
        head += bytes([0x80 | length])
    elif length < 65536:
        head += bytes([0x80 | 126]) + struct.pack(">H", length)
    else:
        head += bytes([0x80 | 127]) + struct.pack(">Q", length)
    mask = os.urandom(4)
    pattern = mask * (length // 4 + 1)
    masked = int.from_bytes(body, "big") ^ int.from_bytes(pattern[:length], "big")
    return head + mask + masked.to_bytes(length, "big")
