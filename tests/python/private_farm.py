"""A daemon of a test's own, with stub workers, in a scratch folder."""

from __future__ import annotations

import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import time
from typing import Any

BIN = pathlib.Path(os.environ["PROGRAM_FOLDER"])
ROOT = pathlib.Path(os.environ["PROJECT_ROOT"])
PATIENCE_S = 600.0  # a guard against what never happens, not a measure


class PrivateFarm:
    def __init__(self) -> None:
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.socket = self.folder / "sock"
        self._process: subprocess.Popen[bytes] | None = None
        self._web: subprocess.Popen[bytes] | None = None
        self._starts = 0

    def close(self) -> None:
        if self._web:
            self._web.kill()
            self._web.wait()
        if self._process:
            self.kill()
        shutil.rmtree(self.folder)

    def start(self, mode: str | None) -> None:
        """Begins a daemon whose workers are stubs of that mode, or real ones, and returns when it can be asked."""
        self._starts += 1
        worker = self.folder / f"worker{self._starts}"  # one that still runs cannot be written to
        if mode is not None:
            worker.write_text(f'#!/bin/sh\nexec "{BIN}/stub-worker" --mode {mode} "$@"\n')
            worker.chmod(0o755)
        command: list[str | pathlib.Path] = [BIN / "marchd", "--config", "/dev/null", "--socket", self.socket]
        command += ["--state", self.folder / "state"]
        command += ["--output-root", self.folder / "out", "--input-root", "/", "--workers", "2"]
        command += ["--stop-timeout", "1", "--backend", "software"]
        command += [] if mode is None else ["--worker-program", worker]
        with open(self.folder / "log", "ab") as log:
            environment = {**os.environ, "XDG_CONFIG_HOME": str(self.folder)}
            self._process = subprocess.Popen(command, stderr=log, env=environment)
        end = time.monotonic() + PATIENCE_S
        while not self._answers():
            assert time.monotonic() < end and self._process.poll() is None, self.log()
            time.sleep(0.02)

    def start_web(self, *options: str) -> str:
        """Begins a march-web before the daemon, and returns its address."""
        command: list[str | pathlib.Path] = [BIN / "march-web", "--config", "/dev/null", "--socket", self.socket]
        command += ["--listen", "127.0.0.1:0", "--page-dir", ROOT / "web/page", "--document-dir", ROOT / "jobs"]
        command += ["--cache-dir", self.folder / "pictures", *options]
        log = self.folder / "web.log"
        with open(log, "wb") as file:
            self._web = subprocess.Popen(command, stderr=file, env={**os.environ, "XDG_CONFIG_HOME": str(self.folder)})
        end = time.monotonic() + PATIENCE_S
        while not (found := re.search(r"listens at .* \(port (\d+)\)", log.read_text())):
            assert time.monotonic() < end and self._web.poll() is None, log.read_text()
            time.sleep(0.02)
        return f"http://127.0.0.1:{found.group(1)}"

    def _answers(self) -> bool:
        with socket.socket(socket.AF_UNIX) as connection:
            return connection.connect_ex(str(self.socket)) == 0

    def log(self) -> str:
        return (self.folder / "log").read_text(errors="replace")

    def stop(self) -> None:
        assert self._process
        self._process.terminate()
        status = self._process.wait(PATIENCE_S)
        self._process = None
        assert status == 0, f"the daemon ended with status {status}: {self.log()}"

    def kill(self) -> None:
        """As kill -9; its socket stays behind, and nobody listens there."""
        assert self._process
        self._process.kill()
        self._process.wait()
        self._process = None


def document(name: str, frames: str, **members: Any) -> dict[str, Any]:
    """A small job with a stated method."""
    job: dict[str, Any] = json.loads((ROOT / "jobs/cloud.json").read_text())
    quality = json.loads((ROOT / "tests/support/stated_quality.json").read_text())["cloud"]
    job |= {"name": name, "frames": frames, "resolution": [32, 18], "quality": quality}
    return job | {"output": {"path": f"{name}/f.####.exr"}} | members
