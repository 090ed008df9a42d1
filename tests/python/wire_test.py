"""The Python client's parts that need no daemon: WebSocket frames, lines, addresses, errors, following, the classes."""

from __future__ import annotations

import asyncio
import json
import os
import unittest
from random import Random
from typing import Any
from unittest import mock

from marchd import AsyncFarm, Farm, address, answers, calls, errors, follow
from marchd.answer import read
from marchd.async_farm import AsyncChannel, Link
from marchd.websocket import WebSocket


def opened(rest: bytes = b"") -> tuple[WebSocket, list[str]]:
    """A WebSocket whose request is answered; RFC 6455, section 1.3, has the key and what it is answered with."""
    key = bytes([0x74, 0x68, 0x65, 0x20, 0x73, 0x61, 0x6D, 0x70, 0x6C, 0x65, 0x20, 0x6E, 0x6F, 0x6E, 0x63, 0x65])
    with mock.patch("os.urandom", return_value=key):
        wire = WebSocket("farm:8470", "/ws", {"Authorization": "Bearer t"})
    head = b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nSec-WebSocket-Protocol: marchd\r\n"
    return wire, wire.feed(head + b"Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n\r\n" + rest)


def told(*parts: bytes) -> list[str]:
    wire, messages = opened()
    for part in parts:
        messages += wire.feed(part)
    return messages


class WebSockets(unittest.TestCase):
    def test_request_is_that_of_the_standard(self) -> None:
        wire, _ = opened()
        self.assertTrue(wire.is_open)
        self.assertIn(b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n", wire.opening)
        self.assertTrue(wire.opening.startswith(b"GET /ws HTTP/1.1\r\nHost: farm:8470\r\n"))
        self.assertTrue(wire.opening.endswith(b"\r\nAuthorization: Bearer t\r\n\r\n"))

    def test_examples_of_the_standard(self) -> None:
        """Section 5.7."""
        self.assertEqual(told(b"\x81\x05Hello"), ["Hello"])
        self.assertEqual(told(b"\x01\x03Hel\x80\x02lo"), ["Hello"])
        self.assertEqual(told(b"\x01\x03Hel\x89\x05Hello\x80\x02lo"), ["Hello"])
        long, longer = b"\x81\x7e\x01\x00" + b"x" * 256, b"\x81\x7f" + (65536).to_bytes(8, "big") + b"y" * 65536
        self.assertEqual(told(long, longer), ["x" * 256, "y" * 65536])
        wire, _ = opened()
        wire.feed(b"\x89\x05Hello")
        with mock.patch("os.urandom", return_value=b"\x37\xfa\x21\x3d"):
            self.assertEqual(wire.encode("Hello"), b"\x81\x85\x37\xfa\x21\x3d\x7f\x9f\x4d\x51\x58")
        self.assertEqual(wire.take_replies()[:2], b"\x8a\x85")
        self.assertEqual(wire.take_replies(), b"")
        self.assertEqual(wire.encode("")[:2], b"\x81\x80")
        self.assertEqual(wire.encode("z" * 300)[:4], b"\x81\xfe\x01\x2c")
        self.assertEqual(wire.encode("z" * 70000)[:10], b"\x81\xff" + (70000).to_bytes(8, "big"))

    def test_bytes_may_come_in_any_parts(self) -> None:
        data = b"\x01\x03H\xc3\xa4\x80\x02lo\x81\x7e\x01\x00" + b"x" * 256
        for size in (1, 2, 3, 7):
            self.assertEqual(told(*(data[i : i + size] for i in range(0, len(data), size))), ["Hälo", "x" * 256])
        self.assertEqual(opened(b"\x81\x02ok")[1], ["ok"])

    def test_what_is_no_frame_ends_the_connection(self) -> None:
        for data in (b"\x81\x85aaaaHello", b"\xc1\x01a", b"\x82\x01a", b"\x80\x01a", b"\x01\x01a\x81\x01b", b"\x09\x00",
                     b"\x89\x7e\x00\x80", b"\x81\x02\xc3\x28", b"\x81\x7f" + b"\xff" * 8, b"\x83\x00"):
            with self.assertRaises(errors.ConnectionLost, msg=data):
                told(data + b"\0" * 128)
        with self.assertRaisesRegex(errors.NotAllowed, "no such token"):
            told(b"\x88\x0f" + (1008).to_bytes(2, "big") + b"no such token")
        with self.assertRaisesRegex(errors.ConnectionLost, "the daemon is away: no daemon"):
            told(b"\x88\x0b" + (1013).to_bytes(2, "big") + b"no daemon")

    def test_other_answers_open_nothing(self) -> None:
        accept = b"Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"
        with self.assertRaises(errors.NotAllowed):
            WebSocket("farm", "/ws", {}).feed(b"HTTP/1.1 401 Unauthorized\r\n\r\n")
        for head in (b"HTTP/1.1 200 OK\r\n", b"SSH-2.0\r\n", b"HTTP/1.1 101 S\r\n" + accept, b"x" * 70000):
            with self.assertRaises(errors.ConnectionLost, msg=head):
                WebSocket("farm", "/ws", {}).feed(head + (b"\r\n" if head[0] != ord("x") else b""))


    def test_random_bytes_end_in_messages_or_in_an_error(self) -> None:
        random = Random(18)
        samples = [b"\x81\x05Hello", b"\x01\x03Hel\x80\x02lo", b"\x81\x7e\x01\x00" + b"x" * 256, b"\x89\x01a"]
        counts = [0, 0]
        for _ in range(3000):
            data = bytearray(b"".join(random.choices(samples, k=3)))
            for _ in range(random.randrange(4)):
                data[random.randrange(len(data))] = random.randrange(256)
            try:
                counts[0] += len(told(bytes(data)))
            except errors.FarmError:
                counts[1] += 1
        self.assertGreater(min(counts), 100)


class Messages(unittest.TestCase):
    def test_what_is_no_message_ends_the_connection(self) -> None:
        answers_without = ['{"id":1}', '{"id":1,"error":1}', '{"id":1,"error":{"code":1}}', "{}"]
        events_without = ['{"method":"event"}', '{"method":"event","params":{}}']
        for text in ["", "nonsense", "[]", "null", "1", "[" * 100000, *answers_without, *events_without]:
            with self.assertRaises(errors.ConnectionLost, msg=text[:20]):
                calls.decode(text)
        with self.assertRaises(errors.FarmError):
            calls.status().take({"id": 1, "result": {}})
        with self.assertRaises(errors.FarmError):
            calls.submit({}, False).take({"id": 1, "result": None})
        with self.assertRaises(errors.FarmError):
            follow.Follower(None, True, True, None).take('{"method":"event","params":{"type":"job"}}')


class Lines(unittest.TestCase):
    def test_lines_may_come_in_any_parts(self) -> None:
        data = '{"a":1}\n{"ä":2}\n\n'.encode()
        for size in range(1, len(data) + 1):
            lines = address.Lines()
            parts = [lines.feed(data[i : i + size]) for i in range(0, len(data), size)]
            self.assertEqual([line for part in parts for line in part], ['{"a":1}', '{"ä":2}', ""])


class Addresses(unittest.TestCase):
    def test_text_is_a_socket_or_an_address_of_march_web(self) -> None:
        self.assertEqual(address.parse("unix:/run/x").paths, ("/run/x",))
        self.assertEqual(address.parse("/run/x").paths, ("/run/x",))
        web = address.parse("https://farm.example/a/")
        self.assertEqual((web.authority, web.port, web.is_secure, web.base), ("farm.example", 443, True, "/a"))
        self.assertEqual(address.parse("http://[::1]:8470").authority, "[::1]:8470")
        for wrong in ("ftp://x", "http://", "http://x?token=1", "http://user@x"):
            with self.assertRaises(errors.FarmError):
                address.parse(wrong)

    def test_token_is_not_sent_over_a_network_in_clear_text(self) -> None:
        for text in ("http://127.0.0.1:8470", "http://[::1]:8470", "http://localhost:1", "https://farm.example", "/s"):
            Farm(text, "t")
            AsyncFarm(text, "t")
        for kind in (Farm, AsyncFarm):
            for text in ("http://farm.example:8470", "http://10.0.0.1", "http://localhost.example"):
                with self.assertRaisesRegex(errors.FarmError, "https://"):
                    kind(text, "t")
            with self.assertRaisesRegex(errors.FarmError, "control characters"):
                kind("https://farm.example", "t\r\nHost: other")

    def test_usual_places_are_those_of_march(self) -> None:
        def usual(**variables: str) -> tuple[str, ...]:
            with mock.patch.dict(os.environ, variables, clear=True):
                return address.usual().paths

        self.assertEqual(usual(MARCHD_SOCKET="/s", HOME="/h"), ("/s",))
        self.assertEqual(usual(XDG_RUNTIME_DIR="/r", HOME="/h"), ("/run/marchd/marchd.sock", "/r/marchd.sock"))
        self.assertEqual(usual(XDG_STATE_HOME="/st", HOME="/h")[1], "/st/marchd/marchd.sock")
        self.assertEqual(usual(HOME="/h")[1], "/h/.local/state/marchd/marchd.sock")


class Errors(unittest.TestCase):
    def test_message_tells_the_place(self) -> None:
        def place(method: str, message: str, code: int = errors.PARAMS) -> tuple[str, str | None]:
            error = errors.of_answer("job.submit" if method == "submit" else method, code, message)
            return type(error).__name__, error.place

        self.assertEqual(place("submit", "document.scene.media[0].g: expected"), ("JobError", "scene.media[0].g"))
        self.assertEqual(place("submit", "params.paused: expected"), ("JobError", "paused"))
        self.assertEqual(place("submit", "output.path: job 3 writes it", errors.CONFLICT), ("Conflict", "output.path"))
        self.assertEqual(place("submit", "the system does not say who: x", errors.NOT_ALLOWED), ("NotAllowed", None))
        self.assertEqual(place("job.frames", "params.limit: expected"), ("WrongRequest", "limit"))
        self.assertEqual(place("job.frames", "job 3: there is no such job", errors.NOT_FOUND), ("NotFound", None))
        self.assertEqual(place("x", "method: there is no x", -32601), ("FarmError", None))


class Answers(unittest.TestCase):
    def test_later_members_are_left_out_and_missing_ones_told(self) -> None:
        value: dict[str, Any] = {"user": "u", "since": 1.5, "later": 1}
        self.assertEqual(answers.Drain.from_json(value), answers.Drain("u", 1.5))
        self.assertEqual(answers.Drain.from_json(value).to_json(), {"user": "u", "since": 1.5})
        with self.assertRaises(TypeError):
            answers.Drain.from_json({"user": "u"})
        with self.assertRaises(TypeError):
            answers.Drain.from_json([])

    def test_lists_and_unions_are_read(self) -> None:
        drain = {"user": "u", "since": 1}
        self.assertEqual(read(list[answers.Drain], [drain]), [answers.Drain("u", 1)])
        self.assertEqual(read(answers.Drain | None, drain), answers.Drain("u", 1))
        self.assertIsNone(read(answers.Drain | None, None))
        self.assertEqual(read(list[float | None], [1, None]), [1, None])


def job(number: int, state: str = "queued") -> dict[str, Any]:
    empty: dict[str, Any] = {name: 0 for name in answers.Job.__dataclass_fields__}
    return empty | {"id": number, "state": state, "tags": []}


class Following(unittest.TestCase):
    def follower(self, *ids: int) -> follow.Follower:
        follower = follow.Follower(ids or None, True, True, None)
        (asked,) = follower.take_to_send()
        self.assertEqual(json.loads(asked)["method"], "events.subscribe")
        self.assertEqual(follower.take('{"id":1,"result":{}}'), [])
        return follower

    @staticmethod
    def event(follower: follow.Follower, **params: Any) -> list[follow.Event]:
        return follower.take(json.dumps({"method": "event", "params": params}))

    def test_list_does_not_tell_what_an_event_told_newer(self) -> None:
        follower = self.follower()
        (asked,) = follower.take_to_send()
        self.assertEqual(json.loads(asked)["method"], "job.list")
        self.assertEqual(len(self.event(follower, type="job", job=job(2, "failed"))), 1)
        self.assertEqual(len(self.event(follower, type="deleted", id=3)), 1)
        listed = {"jobs": [job(1), job(2), job(3)], "next": "c", "total": 4}
        events = follower.take(json.dumps({"id": 2, "result": listed}))
        self.assertEqual([event.job.id for event in events if isinstance(event, answers.JobEvent)], [1])
        self.assertEqual(json.loads(follower.take_to_send()[0])["params"]["cursor"], "c")

    def test_jobs_are_told_before_their_frames(self) -> None:
        follower = self.follower()
        follower.take_to_send()
        frame = {"type": "frame", "id": 1, "frame": 5, "state": "running", "attempt": 1, "error": None}
        self.assertEqual(self.event(follower, **frame), [])
        self.assertEqual(follower.take(json.dumps({"id": 2, "result": {"jobs": [], "next": "c", "total": 1}})), [])
        listed = follower.take(json.dumps({"id": 3, "result": {"jobs": [job(1)], "next": None, "total": 1}}))
        self.assertEqual([event.type for event in listed], ["job", "frame"])
        self.assertEqual([event.type for event in self.event(follower, **frame)], ["frame"])

    def test_jobs_that_are_not_listed_are_gone(self) -> None:
        follower = self.follower(5, 6)
        self.assertEqual(json.loads(follower.take_to_send()[0])["params"], {"ids": [5, 6]})
        events = follower.take(json.dumps({"id": 2, "result": {"jobs": [job(6)], "next": None, "total": 1}}))
        self.assertEqual([event.type for event in events], ["job", "deleted"])
        self.assertEqual(self.event(follower, type="job", job=job(7)), [])
        self.assertEqual(self.event(follower, type="of a later daemon"), [])

    def test_wait_ends_with_the_last_job_and_starts_again_with_a_retry(self) -> None:
        waiting = follow.Waiting([1, 2])
        waiting.note(answers.JobEvent.from_json({"type": "job", "job": job(1, "failed")}))
        waiting.note(answers.JobEvent.from_json({"type": "job", "job": job(1, "running")}))
        waiting.note(answers.JobEvent.from_json({"type": "job", "job": job(2, "succeeded")}))
        self.assertFalse(waiting.is_done)
        waiting.note(answers.JobEvent.from_json({"type": "job", "job": job(1, "canceled")}))
        self.assertTrue(waiting.is_done)
        self.assertEqual([done.state for done in waiting.jobs()], ["canceled", "succeeded"])
        with self.assertRaises(errors.NotFound):
            follow.Waiting([3]).note(answers.DeletedEvent("deleted", 3))


class Links(unittest.IsolatedAsyncioTestCase):
    async def test_all_who_wait_hear_why_a_connection_ends(self) -> None:
        channel = mock.AsyncMock(spec=AsyncChannel)
        ends = asyncio.Event()

        async def receive() -> str:
            await ends.wait()
            raise errors.NotAllowed("the token is not valid", errors.NOT_ALLOWED)

        channel.receive = receive
        link = Link(channel)
        waiting = [asyncio.ensure_future(link.ask(calls.status())) for _ in range(2)]
        await asyncio.sleep(0)
        ends.set()
        failures = await asyncio.gather(*waiting, return_exceptions=True)
        failures += await asyncio.gather(link.ask(calls.status()), return_exceptions=True)
        self.assertEqual([type(failure) for failure in failures], [errors.NotAllowed] * 3)
        await link.close()


if __name__ == "__main__":
    unittest.main()
