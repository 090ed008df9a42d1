"""The Python client against a real daemon, with stub workers: each method, errors, and daemons that go away."""

from __future__ import annotations

import asyncio
import json
import os
import socket
import subprocess
import threading
import time
import unittest
from typing import Any

import marchd
from marchd import AsyncFarm, Conflict, ConnectionLost, Farm, FarmError, JobError, NotFound, WrongRequest
from private_farm import BIN, PATIENCE_S, ROOT, PrivateFarm, document


class FarmCase(unittest.TestCase):
    def setUp(self) -> None:
        self.daemon = PrivateFarm()
        self.addCleanup(self.daemon.close)

    def connect(self) -> Farm:
        farm = Farm.connect(f"unix:{self.daemon.socket}", patience_s=PATIENCE_S)
        self.addCleanup(farm.close)
        return farm


class Methods(FarmCase):
    def test_job_is_submitted_waited_for_and_deleted(self) -> None:
        self.daemon.start("write:0")
        farm = self.connect()
        number = farm.submit(document("one", "1-2500"))
        job = farm.wait(number, PATIENCE_S)
        self.assertEqual((job.id, job.state, job.succeeded, job.name), (number, "succeeded", 2500, "one"))
        frames = list(farm.frames(number))
        self.assertEqual([frame.frame for frame in frames], list(range(1, 2501)))
        self.assertTrue(all(frame.path and os.path.exists(frame.path) for frame in frames))
        self.assertEqual([frame.frame for frame in farm.frames(number, "succeeded", "7,9-10")], [7, 9, 10])
        self.assertEqual(farm.frame_map(number, 2498).states, "ss")
        self.assertEqual(farm.retry(number, ["succeeded"], "5", force=True), 1)
        self.assertEqual(farm.wait(number, PATIENCE_S).succeeded, 2500)
        shown = farm.job(number)
        assert shown.document
        self.assertEqual(shown.document["frames"], "1-2500")
        self.assertEqual(farm.call("job.show", {"id": number})["name"], "one")
        self.assertEqual(farm.delete(number, files=True).files_removed, 2500)
        with self.assertRaises(NotFound) as caught:
            farm.job(number)
        self.assertEqual(caught.exception.code, 1)

    def test_job_is_paused_changed_and_canceled(self) -> None:
        self.daemon.start("write:50000")
        farm = self.connect()
        number = farm.submit(document("two", "1-10"), paused=True)
        self.assertEqual(farm.job(number).state, "paused")
        self.assertEqual(farm.priority(number, 70).priority, 70)
        self.assertIn(farm.resume(number).state, ("queued", "running"))
        self.assertEqual(farm.pause(number).state, "paused")
        with self.assertRaises(TimeoutError):
            farm.wait(number, 0.2)
        self.assertEqual(farm.cancel(number).state, "canceled")
        with self.assertRaises(Conflict):
            farm.pause(number)
        self.assertEqual([worker.pool for worker in farm.workers()], ["local", "local"])
        self.assertEqual(farm.status().jobs.canceled, 1)
        self.assertIsInstance(farm.drain(), int)
        drained = farm.status().drain
        assert drained
        self.assertTrue(drained.user)
        farm.undrain()
        self.assertEqual(farm.reload().restart, [])

    def test_attempts_that_failed_are_told(self) -> None:
        self.daemon.start("fail:frame")
        farm = self.connect()
        number = farm.submit(document("three", "1"))
        self.assertEqual(farm.wait(number, PATIENCE_S).state, "failed")
        self.assertEqual({attempt.outcome for attempt in farm.log(number)}, {"failed"})
        self.assertEqual(len(farm.log(number, frame=1, limit=1)), 1)
        (frame,) = farm.frames(number, ["failed"])
        self.assertIn("told to fail", frame.error or "")

    def test_jobs_are_listed_in_pages_and_by_filters(self) -> None:
        self.daemon.start("write:0")

        async def submit_all() -> list[int]:
            async with AsyncFarm(str(self.daemon.socket)) as farm:
                jobs = (document(f"many{i}", "1", output={"path": f"many/{i}.####.exr"}) for i in range(1010))
                return list(await asyncio.gather(*(farm.submit(job, paused=True) for job in jobs)))

        numbers = asyncio.run(submit_all())
        farm = self.connect()
        self.assertEqual(len(set(numbers)), 1010)
        self.assertEqual([job.id for job in farm.jobs()], sorted(numbers))
        self.assertEqual([job.id for job in farm.jobs(newest_first=True)], sorted(numbers, reverse=True))
        self.assertEqual([job.name for job in farm.jobs("paused", name="MANY77")][:1], ["many77"])
        self.assertEqual(list(farm.jobs(("running", "failed"))), [])
        self.assertEqual(list(farm.jobs(since=time.time() + 1000)), [])
        with farm.events() as events:
            told = {event.job.id for event in (next(events) for _ in numbers) if isinstance(event, marchd.JobEvent)}
        self.assertEqual(told, set(numbers))

    def test_job_files_are_read_as_march_reads_them(self) -> None:
        self.daemon.start("write:50000")
        farm = self.connect()
        files = sorted(path for path in (ROOT / "jobs").glob("*.json") if path.name not in ("schema.json", "scan.json"))
        for path in files:
            by_march = ["submit", str(path), "--paused", "--json", "--socket", str(self.daemon.socket)]
            told = subprocess.run([BIN / "march", *by_march], check=True, capture_output=True).stdout
            first = farm.job(json.loads(told)["id"]).document
            farm.cancel(json.loads(told)["id"])
            second = farm.job(number := farm.submit(path, paused=True)).document
            farm.cancel(number)
            self.assertEqual(second, first, path)
        self.assertGreater(len(files), 8)


class Errors(FarmCase):
    def test_wrong_job_names_its_place(self) -> None:
        self.daemon.start("write:0")
        farm = self.connect()
        job = document("wrong", "1")
        job["scene"]["media"][0]["phase"] = [{"g": 2}]
        with self.assertRaises(JobError) as caught:
            farm.submit(job)
        self.assertEqual((caught.exception.place, caught.exception.code), ("scene.media[0].phase[0].g", -32602))
        self.assertIn("expected", caught.exception.message)
        wrong: list[tuple[str, Any, str]] = [("fps", "x", "fps"), ("resolution", [0, 1], "resolution[0]")]
        for key, value, place in wrong:
            with self.assertRaises(JobError) as caught:
                farm.submit(document("wrong", "1", **{key: value}))
            self.assertEqual(caught.exception.place, place)
        with self.assertRaises(WrongRequest):
            farm.submit(document("wrong", "1", nonsense=1))
        with self.assertRaises(WrongRequest) as request:
            farm.call("job.frames", {"id": 1, "limit": -1, "nonsense": 2})
        self.assertNotIsInstance(request.exception, JobError)
        with self.assertRaises(FarmError) as unknown:
            farm.call("job.sbumit")
        self.assertEqual(unknown.exception.code, -32601)
        farm.submit(document("same", "1-2"), paused=True)
        with self.assertRaises(Conflict) as conflict:
            farm.submit(document("same", "2-3"), paused=True)
        self.assertEqual(conflict.exception.place, "output.path")
        with self.assertRaises(JobError):
            farm.submit(document("infinite", "1", time_offset=float("inf")))
        with self.assertRaises(FarmError):
            farm.submit(document("long", "1", comment="x" * (5 << 20)))
        self.assertEqual(farm.status().jobs.paused, 1)

    def test_farm_that_is_not_there_is_told_at_once(self) -> None:
        with self.assertRaises(ConnectionLost) as caught:
            Farm.connect(str(self.daemon.socket))
        self.assertIn(str(self.daemon.socket), caught.exception.message)
        with self.assertRaises(ConnectionLost):
            asyncio.run(AsyncFarm.connect(str(self.daemon.socket)))
        with self.assertRaises(ConnectionLost):
            Farm("http://127.0.0.1:9").status()
        with self.assertRaises(FarmError):
            Farm("ftp://127.0.0.1")
        with self.assertRaises(FarmError):
            Farm(str(self.daemon.socket)).picture(1, 1)


class Restarts(FarmCase):
    def restart(self, mode: str) -> None:
        self.daemon.kill()
        self.daemon.start(mode)

    def test_wait_goes_on_when_the_daemon_is_killed(self) -> None:
        self.daemon.start("write:50000")
        farm = self.connect()
        number = farm.submit(document("long", "1-3"))
        with farm.events(number) as events:
            first = next(events)
            assert isinstance(first, marchd.JobEvent)
            waited: list[marchd.Job] = []
            thread = threading.Thread(target=lambda: waited.append(farm.wait(number)), daemon=True)
            thread.start()
            self.restart("write:0")
            kinds = []
            for event in events:
                kinds.append(event.type)
                if isinstance(event, marchd.JobEvent) and event.job.state == "succeeded":
                    break
        self.assertLess(kinds.index("disconnected"), kinds.index("reconnected"))
        self.assertEqual(kinds[kinds.index("reconnected") + 1], "job")
        thread.join(PATIENCE_S)
        self.assertEqual([job.state for job in waited], ["succeeded"])
        self.assertEqual(farm.job(number).succeeded, 3)  # its own connection was lost, too

    def test_async_wait_goes_on_when_the_daemon_is_killed(self) -> None:
        self.daemon.start("write:50000")

        async def run() -> None:
            async with await AsyncFarm.connect(str(self.daemon.socket), patience_s=PATIENCE_S) as farm:
                numbers = [await farm.submit(document(name, "1-3")) for name in ("a", "b")]
                waiting = asyncio.create_task(farm.wait_all(numbers))
                async with farm.events() as events:
                    await anext(events)
                    await asyncio.to_thread(self.restart, "write:0")
                    kinds = []
                    async for event in events:
                        kinds.append(event.type)
                        if event.type == "reconnected":
                            break
                self.assertIn("disconnected", kinds)
                self.assertEqual([job.state for job in await waiting], ["succeeded", "succeeded"])
                self.assertEqual([frame.frame async for frame in farm.frames(numbers[0])], [1, 2, 3])
                self.assertEqual([job.id async for job in farm.jobs("succeeded")], numbers)
                with self.assertRaises(TimeoutError):
                    await farm.wait(await farm.submit(document("c", "1"), paused=True), 0.2)
                with self.assertRaises(NotFound):
                    await farm.wait(4711)

        asyncio.run(run())

    def test_job_that_is_deleted_while_nobody_listens_ends_the_wait(self) -> None:
        self.daemon.start("write:50000")
        farm = self.connect()
        number = farm.submit(document("gone", "1-3"), paused=True)
        failure: list[Exception] = []

        def wait() -> None:
            try:
                farm.wait(number)
            except NotFound as error:
                failure.append(error)

        with farm.events(number) as events:
            next(events)
        thread = threading.Thread(target=wait, daemon=True)
        thread.start()
        self.daemon.kill()
        hidden = self.daemon.socket
        self.daemon.socket = self.daemon.folder / "other"
        self.daemon.start("write:0")
        with Farm(str(self.daemon.socket)) as other:
            other.cancel(number)
            other.delete(number)
        self.daemon.stop()
        self.daemon.socket = hidden
        self.daemon.start("write:0")
        thread.join(PATIENCE_S)
        self.assertEqual(len(failure), 1)

    def test_farm_that_stays_away_ends_patience(self) -> None:
        self.daemon.start("write:50000")
        with Farm.connect(str(self.daemon.socket), patience_s=0.5) as farm:
            number = farm.submit(document("left", "1"), paused=True)
            with farm.events(number) as events:
                next(events)
                self.daemon.kill()
                self.assertEqual(next(events).type, "disconnected")
                with self.assertRaises(ConnectionLost):
                    next(events)
            with self.assertRaises(ConnectionLost):
                farm.status()


class Silent(unittest.TestCase):
    """A server that takes requests and hangs up: nobody knows whether they were done."""

    def test_change_is_sent_once_and_a_question_again(self) -> None:
        daemon = PrivateFarm()
        self.addCleanup(daemon.close)
        server = socket.socket(socket.AF_UNIX)
        self.addCleanup(server.close)
        server.bind(str(daemon.socket))
        server.listen()
        asked: list[str] = []

        def serve() -> None:
            answered = False
            while True:
                try:
                    connection = server.accept()[0]
                except OSError:
                    return
                with connection, connection.makefile("rb") as lines:
                    for line in lines:
                        request = json.loads(line)
                        asked.append(request["method"])
                        if answered and asked.count("worker.list") < 3:
                            break
                        answered = True
                        answer = {"id": request["id"], "result": {"workers": []}}
                        connection.sendall(json.dumps(answer).encode() + b"\n")

        threading.Thread(target=serve, daemon=True).start()
        farm = Farm(str(daemon.socket), patience_s=PATIENCE_S)
        self.addCleanup(farm.close)
        self.assertEqual(farm.workers(), [])
        with self.assertRaises(ConnectionLost):
            farm.cancel(1)
        self.assertEqual(asked, ["worker.list", "job.cancel"])
        self.assertEqual(farm.workers(), [])
        self.assertEqual(asked, ["worker.list", "job.cancel", "worker.list", "worker.list"])


if __name__ == "__main__":
    unittest.main()
