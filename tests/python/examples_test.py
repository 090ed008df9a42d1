"""Each example of docs/python.md runs, and its types are right."""

from __future__ import annotations

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from marchd import Farm
from private_farm import ROOT, PrivateFarm, document

EXAMPLES = re.findall(r"^```python\n(.*?)^```$", (ROOT / "docs/python.md").read_text(encoding="utf-8"), re.M | re.S)


def reach(daemon: PrivateFarm) -> dict[str, str]:
    """The variables that name a march-web and a token to an example."""
    with Farm(str(daemon.socket)) as farm:
        token = farm.call("token.create", {"scope": "submit", "name": "example"})["token"]
    return {"MARCH_WEB": daemon.start_web(), "MARCH_TOKEN": token}


class Examples(unittest.TestCase):
    def test_each_runs(self) -> None:
        self.assertGreaterEqual(len(EXAMPLES), 5)
        for example in EXAMPLES:
            daemon = PrivateFarm()
            self.addCleanup(daemon.close)
            is_web = "MARCH_WEB" in example
            daemon.start(None if is_web else "write:0")
            (daemon.folder / "first.json").write_text(json.dumps(document("first", "0-9")))
            environment = {**os.environ, "MARCHD_SOCKET": str(daemon.socket), **(reach(daemon) if is_web else {})}
            command = [sys.executable, "-c", example]
            ended = subprocess.run(command, cwd=daemon.folder, env=environment, capture_output=True)
            self.assertEqual((ended.returncode, ended.stderr), (0, b""), f"{example}\n{ended.stderr.decode()}")
            self.assertTrue(ended.stdout, example)
            self.assertNotIn(b"failed", ended.stdout)

    def test_types_are_right(self) -> None:
        if not shutil.which("mypy"):
            self.skipTest("there is no mypy")
        with tempfile.TemporaryDirectory() as folder:
            names = [f"{folder}/example{i}.py" for i in range(len(EXAMPLES))]
            for name, example in zip(names, EXAMPLES):
                pathlib.Path(name).write_text(example, encoding="utf-8")
            environment = {**os.environ, "MYPYPATH": str(ROOT / "python")}
            told = subprocess.run(["mypy", "--strict", *names], env=environment, capture_output=True, text=True)
        self.assertEqual(told.returncode, 0, told.stdout)


if __name__ == "__main__":
    unittest.main()
