"""A browser's part for the tests of march-web: raw requests over a socket, byte by byte, and WebSockets.

It has none of a library's politeness: what a test sends is sent as it is.
"""
# SPDX-License-Identifier: Apache-2.0
import base64
import json
import os
import socket
import struct

PATIENCE_S = 300  # a guard against what never comes


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    def json(self):
        return json.loads(self.body)

    def __repr__(self):
        return f"{self.status} {self.headers} {self.body[:200]!r}"


class Client:
    """One connection."""

    def __init__(self, port, host="127.0.0.1", source=None, window=0):
        """`source`: the address that it comes from. `window`: bytes that the kernel keeps for it, unless 0."""
        self.port = port
        self.socket = socket.socket()
        self.socket.settimeout(PATIENCE_S)
        if source:
            self.socket.bind((source, 0))
        if window:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, window)
        self.socket.connect((host, port))
        self.buffer = b""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, data):
        self.socket.sendall(data)

    def receive(self):
        """More bytes into the buffer; False: the peer has closed the connection."""
        try:
            data = self.socket.recv(1 << 20)
        except ConnectionResetError:
            return False
        self.buffer += data
        return bool(data)

    def is_closed(self):
        """Waits for the end."""
        while self.receive():
            pass
        return True

    def take(self, size):
        while len(self.buffer) < size:
            if not self.receive():
                raise EOFError(f"closed after {len(self.buffer)} of {size} bytes")
        data, self.buffer = self.buffer[:size], self.buffer[size:]
        return data

    def answer(self, method="GET"):
        while b"\r\n\r\n" not in self.buffer:
            if not self.receive():
                raise EOFError(f"closed before an answer: {self.buffer!r}")
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        lines = head.decode("latin-1").split("\r\n")
        headers = {}
        for line in lines[1:]:
            name, value = line.split(":", 1)
            headers[name.lower()] = value.strip()
        size = 0 if method == "HEAD" else int(headers.get("content-length", 0))
        return Answer(int(lines[0].split()[1]), headers, self.take(size))

    def ask(self, method, path, headers=(), body=None, host=None):
        """`headers`: pairs, or a dict; None as `host`: this machine's."""
        pairs = list(headers.items()) if isinstance(headers, dict) else list(headers)
        lines = [f"{method} {path} HTTP/1.1", f"Host: {host or f'localhost:{self.port}'}"]
        lines += [f"{name}: {value}" for name, value in pairs]
        if body is not None:
            body = body if isinstance(body, bytes) else body.encode()
            lines.append(f"Content-Length: {len(body)}")
        self.send("\r\n".join(lines).encode("latin-1") + b"\r\n\r\n" + (body or b""))
        return self.answer(method)


def ask(port, method, path, headers=(), body=None, host=None):
    """One request on a connection of its own."""
    with Client(port) as client:
        return client.ask(method, path, headers, body, host)


def bearer(token):
    return {"Authorization": f"Bearer {token}"}


def call(port, token, method, params=None):
    """The daemon's answer over /rpc."""
    body = json.dumps({"jsonrpc": "2.0", "id": 1, "method": method, "params": params or {}})
    answer = ask(port, "POST", "/rpc", bearer(token), body)
    assert answer.status == 200, answer
    return answer.json()


class Closed(Exception):
    """The server has closed the WebSocket."""

    def __init__(self, code, reason):
        super().__init__(f"{code} {reason}")
        self.code, self.reason = code, reason


class WebSocket:
    def __init__(self, port, headers=(), path="/ws", protocol="marchd", host=None, window=0):
        self.client = Client(port, window=window)
        pairs = list(headers.items()) if isinstance(headers, dict) else list(headers)
        pairs += [("Upgrade", "websocket"), ("Connection", "Upgrade"), ("Sec-WebSocket-Version", "13"),
                  ("Sec-WebSocket-Key", base64.b64encode(os.urandom(16)).decode())]
        if protocol:
            pairs.append(("Sec-WebSocket-Protocol", protocol))
        self.opening = self.client.ask("GET", path, pairs, host=host)

    def close(self):
        self.client.socket.close()

    def frame(self, opcode, payload, final=True, masked=True):
        size = len(payload)
        head = bytes([opcode | (0x80 if final else 0)])
        mark = 0x80 if masked else 0
        if size < 126:
            head += bytes([mark | size])
        elif size < 1 << 16:
            head += bytes([mark | 126]) + struct.pack(">H", size)
        else:
            head += bytes([mark | 127]) + struct.pack(">Q", size)
        if not masked:
            return head + payload
        return head + b"\0\0\0\0" + payload  # a mask of zeros leaves it as it is

    def send(self, text):
        self.client.send(self.frame(1, text if isinstance(text, bytes) else text.encode()))

    def receive(self):
        """The next text; answers pings."""
        while True:
            first, second = self.client.take(2)
            size = second & 0x7F
            if size == 126:
                (size,) = struct.unpack(">H", self.client.take(2))
            elif size == 127:
                (size,) = struct.unpack(">Q", self.client.take(8))
            payload = self.client.take(size)
            opcode = first & 0x0F
            if opcode == 8:
                code = struct.unpack(">H", payload[:2])[0] if size >= 2 else 0
                raise Closed(code, payload[2:].decode())
            if opcode == 9:
                self.client.send(self.frame(10, payload))
            elif opcode in (0, 1):
                assert first & 0x80, "a message in pieces"
                return payload.decode()

    def call(self, number, method, params=None):
        """The answer to a request; what comes before it is dropped."""
        self.send(json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params or {}}))
        while True:
            message = json.loads(self.receive())
            if message.get("id") == number:
                return message
