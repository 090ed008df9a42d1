"""The Python client through march-web: every method, pictures, tokens, and a daemon that goes away behind it."""

from __future__ import annotations

import asyncio
import unittest
from unittest import mock

import farm_test
import marchd
from marchd import AsyncFarm, ConnectionLost, Farm, NotAllowed, NotFound
from private_farm import PATIENCE_S, document


class WebCase(farm_test.FarmCase):
    def setUp(self) -> None:
        super().setUp()
        self.token = ""
        self.address = ""

    def make_token(self, scope: str) -> str:
        with Farm(str(self.daemon.socket)) as farm:
            return str(farm.call("token.create", {"scope": scope, "name": "test"})["token"])

    def connect(self) -> Farm:
        self.token = self.make_token("admin")
        self.address = self.daemon.start_web()
        farm = Farm.connect(self.address, self.token, PATIENCE_S)
        self.addCleanup(farm.close)
        return farm


class WebMethods(WebCase, farm_test.Methods):
    """All of the methods' tests again."""


class WebErrors(WebCase):
    def test_tokens_say_what_is_allowed(self) -> None:
        self.daemon.start("write:0")
        self.connect()
        for token in (None, "", "wrong", self.token[:-1] + ("a" if self.token[-1] != "a" else "b")):
            with self.assertRaises(NotAllowed, msg=token):
                Farm.connect(self.address, token)
            with self.assertRaises(NotAllowed, msg=token):
                asyncio.run(AsyncFarm.connect(self.address, token))
        with Farm(self.address, self.make_token("read")) as farm:
            self.assertEqual(list(farm.jobs()), [])
            with self.assertRaises(NotAllowed):
                farm.submit(document("read", "1"))
        with Farm(str(self.daemon.socket), self.make_token("read")) as farm:
            self.assertEqual(list(farm.jobs()), [])
            with self.assertRaises(NotAllowed):
                farm.submit(document("read", "1"))
        with self.assertRaises(NotAllowed):
            Farm(str(self.daemon.socket), "wrong").status()

    def test_wrong_job_names_its_place(self) -> None:
        self.daemon.start("write:0")
        with self.assertRaises(marchd.JobError) as caught:
            self.connect().submit(document("wrong", "1", fps="x"))
        self.assertEqual(caught.exception.place, "fps")


class Pictures(WebCase):
    def test_frame_is_seen(self) -> None:
        self.daemon.start(None)
        farm = self.connect()
        number = farm.submit(document("real", "3"))
        self.assertEqual(farm.wait(number, PATIENCE_S).state, "succeeded")
        picture = farm.picture(number, 3)
        self.assertEqual((picture.png[:4], picture.width_px, picture.file_height_px), (b"\x89PNG", 32, 18))
        assert picture.exposure is not None
        brighter = farm.picture(number, 3, exposure=picture.exposure + 2, size=16)
        self.assertEqual((brighter.width_px, brighter.exposure), (16, picture.exposure + 2))
        self.assertNotEqual(farm.picture(number, 3, channel="A").png, picture.png)
        self.assertIn("real", str(farm.header(number, 3)))

        async def ask() -> marchd.Picture:
            async with AsyncFarm(self.address, self.token) as same:
                self.assertEqual(await same.header(number, 3), farm.header(number, 3))
                return await same.picture(number, 3)

        self.assertEqual(asyncio.run(ask()), picture)
        with self.assertRaises(marchd.WrongRequest):
            farm.picture(number, 3, channel="nonsense")
        with self.assertRaises(NotFound):
            farm.picture(number, 4)
        with self.assertRaises(NotAllowed):
            Farm(self.address, "wrong").picture(number, 3)
        with self.assertRaises(ConnectionLost):
            Farm("http://127.0.0.1:9").header(number, 3)


class WebRestarts(WebCase):
    def test_wait_goes_on_when_the_daemon_is_killed(self) -> None:
        self.daemon.start("write:50000")
        farm = self.connect()
        number = farm.submit(document("long", "1-3"))
        with farm.events(number) as events:
            next(events)
            self.daemon.kill()
            kinds = [next(events).type]
            while kinds[-1] != "disconnected":
                kinds.append(next(events).type)
            with mock.patch.object(farm, "patience_s", 0.0), self.assertRaises(ConnectionLost):
                farm.status()
            with self.assertRaises(ConnectionLost):
                farm.cancel(number)
            self.daemon.start("write:0")
            self.assertEqual([next(events).type, next(events).type], ["reconnected", "job"])
        self.assertEqual(farm.wait(number, PATIENCE_S).state, "succeeded")

    def test_async_wait_goes_on_when_the_daemon_is_killed(self) -> None:
        self.daemon.start("write:50000")
        self.connect()

        async def run() -> None:
            async with await AsyncFarm.connect(self.address, self.token, PATIENCE_S) as farm:
                number = await farm.submit(document("long", "1-3"))
                waiting = asyncio.create_task(farm.wait(number))
                async with farm.events() as events:
                    await anext(events)
                    self.daemon.kill()
                    await asyncio.to_thread(self.daemon.start, "write:0")
                    while (await anext(events)).type != "reconnected":
                        pass
                self.assertEqual((await waiting).state, "succeeded")
                with self.assertRaises(NotFound):
                    await farm.job(4711)

        asyncio.run(run())


if __name__ == "__main__":
    unittest.main()
