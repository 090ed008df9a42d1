"""The Python client over https: a proxy with a certificate of its own before march-web, trusted or not."""

from __future__ import annotations

import asyncio
import contextlib
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import unittest
from collections.abc import Callable

import farm_test
import marchd
from marchd import AsyncFarm, ConnectionLost, Farm, FarmError, NotTrusted
from private_farm import PATIENCE_S, ROOT, document

if not shutil.which("openssl"):
    print("skipped: there is no openssl to make certificates with")
    sys.exit(0)


def make_certificate(folder: pathlib.Path, host: str) -> tuple[pathlib.Path, pathlib.Path]:
    """A self-signed certificate for the host, and its key."""
    certificate, key = folder / f"{host}.pem", folder / f"{host}.key"
    name = f"IP:{host}" if re.fullmatch(r"[\d.]+", host) else f"DNS:{host}"
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"]
    command += ["-days", "2", "-subj", "/CN=marchd test", "-addext", f"subjectAltName={name}"]
    subprocess.run([*command, "-out", certificate, "-keyout", key], check=True, capture_output=True)
    return certificate, key


class TlsProxy:
    """A process of its own before march-web."""

    def __init__(self, folder: pathlib.Path, certificate: pathlib.Path, key: pathlib.Path) -> None:
        self._noted = folder / "noted"
        program = ROOT / "tests/python/tls_proxy.py"
        command: list[str | pathlib.Path] = [sys.executable, program, certificate, key, self._noted]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout
        self.port = int(self._process.stdout.readline())

    def pass_to(self, address: str) -> None:
        assert self._process.stdin
        print(address.rpartition(":")[2], file=self._process.stdin, flush=True)

    def received(self) -> bytes:
        """What clients have sent."""
        return self._noted.read_bytes()

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()


class TlsCase(farm_test.FarmCase):
    def setUp(self) -> None:
        super().setUp()
        self.daemon.start("write:0")
        with Farm(str(self.daemon.socket)) as farm:
            self.token = str(farm.call("token.create", {"scope": "admin", "name": "test"})["token"])

    def serve(self, host: str) -> TlsProxy:
        self.certificate, key = make_certificate(self.daemon.folder, host)
        proxy = TlsProxy(self.daemon.folder, self.certificate, key)
        self.addCleanup(proxy.close)
        self.address = f"https://127.0.0.1:{proxy.port}"
        proxy.pass_to(self.daemon.start_web("--origin", self.address))
        return proxy

    def assert_not_trusted(self, cafile: pathlib.Path | None, reason: str) -> None:
        """By each way to the farm; nothing is tried again."""

        async def ask() -> None:
            async with AsyncFarm(self.address, self.token, PATIENCE_S, cafile) as farm:
                await farm.status()

        with Farm(self.address, self.token, PATIENCE_S, cafile) as farm:
            ways: list[Callable[[], object]] = [farm.status, lambda: farm.header(1, 1), lambda: next(farm.events())]
            ways.append(lambda: asyncio.run(ask()))
            for way in ways:
                with self.assertRaisesRegex(NotTrusted, f"certificate of {self.address} is not trusted: .*{reason}"):
                    way()


class Trusted(TlsCase):
    def test_farm_is_asked_through_a_proxy(self) -> None:
        proxy = self.serve("127.0.0.1")
        with Farm.connect(self.address, self.token, PATIENCE_S, cafile=self.certificate) as farm:
            number = farm.submit(document("secure", "1-3"))
            self.assertEqual(farm.wait(number, PATIENCE_S).state, "succeeded")
            with self.assertRaises(FarmError) as caught:
                farm.header(number, 99)
            self.assertIsInstance(caught.exception, marchd.NotFound)
        self.assertIn(self.token.encode(), proxy.received())

    def test_async_farm_is_asked_through_a_proxy(self) -> None:
        self.serve("127.0.0.1")

        async def run() -> None:
            async with await AsyncFarm.connect(self.address, self.token, PATIENCE_S, cafile=self.certificate) as farm:
                number = await farm.submit(document("secure", "1-3"))
                self.assertEqual((await farm.wait(number)).state, "succeeded")
                async with farm.events(number) as events:
                    self.assertEqual((await anext(events)).type, "job")

        asyncio.run(run())


class NotTrustedCase(TlsCase):
    def test_self_signed_certificate_needs_its_file(self) -> None:
        proxy = self.serve("127.0.0.1")
        self.assert_not_trusted(None, "self-signed certificate")
        another, _ = make_certificate(self.daemon.folder, "127.0.0.2")
        self.assert_not_trusted(another, "")
        self.assertEqual(proxy.received(), b"")

    def test_certificate_of_another_host_is_refused(self) -> None:
        proxy = self.serve("farm.example.org")
        self.assert_not_trusted(self.certificate, "127.0.0.1")
        self.assertEqual(proxy.received(), b"")

    def test_server_without_tls_is_no_farm(self) -> None:
        address = self.daemon.start_web().replace("http:", "https:")
        with Farm(address, self.token, 0.0) as farm, self.assertRaisesRegex(ConnectionLost, "no farm answers at https"):
            farm.status()

    def test_certificate_file_is_checked(self) -> None:
        missing = self.daemon.folder / "missing.pem"
        wrong = self.daemon.folder / "wrong.pem"
        wrong.write_text("no certificate\n")
        with contextlib.closing(socket.create_server(("127.0.0.1", 0))) as listener:
            address = f"https://127.0.0.1:{listener.getsockname()[1]}"
            for cafile in (missing, wrong):
                with Farm(address, self.token, 0.0, cafile) as farm, self.assertRaisesRegex(FarmError, str(cafile)):
                    farm.status()
        with self.assertRaisesRegex(FarmError, "cafile is for https://"):
            Farm("http://127.0.0.1:1", self.token, cafile=wrong)


if __name__ == "__main__":
    unittest.main()
