"""A private farm, march-web and headless Chromium, or Firefox where BROWSER says so, for the page's tests.

Where Chromium or what drives it is not installed (deploy/packages web), the test that imports this is skipped.
"""

import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time

try:
    from selenium import webdriver
    from selenium.common.exceptions import NoSuchElementException, StaleElementReferenceException
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
except ImportError as error:
    print(f"skipped: {error}: deploy/packages web installs it")
    sys.exit(77)
from firefox import FIREFOX, Firefox

CHROMIUM = "/usr/bin/chromium"
DRIVER = "/usr/bin/chromedriver"
IS_FIREFOX = os.environ.get("BROWSER") == "firefox"
for program in (FIREFOX,) if IS_FIREFOX else (CHROMIUM, DRIVER):
    if not os.access(program, os.X_OK):
        print(f"skipped: there is no {program}: deploy/packages web installs it")
        sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("PROGRAM_FOLDER", ROOT / "build/clang/bin"))
PATIENCE_S = float(os.environ.get("PATIENCE_S", 300))  # a guard against what never happens, not a measure: machines are slow and busy


def wait_until(what, found, within_s=None):
    """Until `found()` is true; returns what it gave."""
    within_s = within_s or PATIENCE_S
    ends = time.monotonic() + within_s
    while time.monotonic() < ends:
        try:
            value = found()
            if value:
                return value
        except (NoSuchElementException, StaleElementReferenceException, OSError):
            pass
        time.sleep(0.05)
    raise AssertionError(f"not within {within_s} s: {what}")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Farm:
    """A daemon with stub workers (`mode` None: with real ones that need no GPU), and march-web beside it."""

    def __init__(self, mode="audited:50", workers=2):
        self.folder = tempfile.TemporaryDirectory(prefix="page_test_")
        self.path = pathlib.Path(self.folder.name)
        self.socket = str(self.path / "sock")
        self.workers = workers
        self.worker = BIN / "march-worker"
        if mode:
            self.worker = self.path / "worker"
            self.worker.write_text(f'#!/bin/sh\nexec "{BIN}/stub-worker" --mode {mode} "$@"\n', encoding="utf-8")
            self.worker.chmod(0o755)
        self.log = open(self.path / "log", "ab")
        self.daemon = self.web = None
        self.start_daemon()
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.start_web()

    def start_daemon(self):
        self.daemon = subprocess.Popen(
            [BIN / "marchd", "--config", "/dev/null", "--state", self.path / "state", "--socket", self.socket,
             "--output-root", self.path / "out", "--input-root", "/", "--worker-program", self.worker,
             "--workers", str(self.workers), "--backend", "software"], stderr=self.log)
        wait_until("the daemon answers", lambda: self.ask("daemon.status"))

    def stop_daemon(self):
        self.daemon.send_signal(signal.SIGTERM)
        self.daemon.wait()

    def start_web(self):
        self.web = subprocess.Popen(
            [BIN / "march-web", "--config", "/dev/null", "--socket", self.socket, "--listen", f"127.0.0.1:{self.port}",
             "--page-dir", ROOT / "web/page", "--cache-dir", self.path / "cache"], stderr=self.log)
        wait_until("march-web listens", lambda: socket.create_connection(("127.0.0.1", self.port)).close() or True)

    def close(self):
        for process in (self.web, self.daemon):
            if process and process.poll() is None:
                process.kill()
                process.wait()
        self.log.close()
        self.folder.cleanup()

    def call(self, *requests):
        """Answers to requests (method, params) that are sent in one breath, by their order."""
        with socket.socket(socket.AF_UNIX) as connection:
            connection.connect(self.socket)
            lines = [json.dumps({"jsonrpc": "2.0", "id": i, "method": method, "params": params}) + "\n"
                     for i, (method, params) in enumerate(requests)]
            answers = {}
            with connection.makefile("rw", encoding="utf-8") as stream:
                for begin in range(0, len(lines), 500):
                    part = lines[begin:begin + 500]
                    stream.write("".join(part))
                    stream.flush()
                    for _ in part:
                        answer = json.loads(stream.readline())
                        answers[answer["id"]] = answer
        return [answers[i] for i in range(len(lines))]

    def ask(self, method, params=None):
        answer = self.call((method, params or {}))[0]
        if "error" in answer:
            raise AssertionError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    def document(self, name, frames, **members):
        """A small job, with a stated method."""
        document = json.loads((ROOT / "jobs/cloud.json").read_text(encoding="utf-8"))
        stated = json.loads((ROOT / "tests/support/stated_quality.json").read_text(encoding="utf-8"))
        document.update(name=name, frames=frames, resolution=[32, 18], quality=stated["cloud"])
        document["output"]["path"] = f"{name}/x.######.exr"
        document.update(members)
        return document

    def submit(self, name, frames, paused=False, **members):
        return self.ask("job.submit", {"document": self.document(name, frames, **members), "paused": paused})["id"]

    def job(self, number):
        return self.ask("job.show", {"id": number})

    def link(self, scope="admin"):
        """The address that opens a session, once."""
        token = self.ask("token.create", {"scope": scope, "name": "page test", "once": True})["token"]
        return f"{self.url}/?token={token}"


class Page:
    """The page in a browser."""

    def __init__(self, farm, width=1440, height=900):
        self.farm = farm
        self.driver = Firefox() if IS_FIREFOX else self.start_chromium()
        self.size(width, height)

    @staticmethod
    def start_chromium():
        options = Options()
        options.binary_location = CHROMIUM
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                         "--hide-scrollbars", "--disable-background-networking", "--disable-component-update",
                         "--disable-sync", "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        return webdriver.Chrome(service=Service(DRIVER), options=options)

    def close(self):
        self.driver.quit()

    def size(self, width, height):
        if IS_FIREFOX:
            self.driver.size(width, height)
            return
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})

    def theme(self, name):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                    {"features": [{"name": "prefers-color-scheme", "value": name}]})

    def open(self, address):
        self.driver.get(address)

    def go(self, place):
        self.run("location.hash = arguments[0]", place)

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def keys(self, *keys):
        ActionChains(self.driver).send_keys(*keys).perform()

    def find(self, selector):
        return self.driver.find_element("css selector", selector)

    def all(self, selector):
        return self.driver.find_elements("css selector", selector)

    def text(self, selector="main"):
        return self.find(selector).text

    def has(self, text, selector="main"):
        wait_until(f'"{text}" in {selector}', lambda: text in self.text(selector))

    def click(self, selector, text=""):
        wait_until(f"{selector} {text}", lambda: self.named(selector, text))
        self.named(selector, text).click()

    def named(self, selector, text):
        return next((one for one in self.all(selector) if one.is_displayed() and text in one.text), None)

    def is_live(self):
        return self.run("return document.body.dataset.link") == "live"

    def complaints(self):
        """What the browser's console has: refused scripts and styles, errors. A connection that broke is none."""
        if IS_FIREFOX:
            return [entry for entry in self.driver.take_errors() if "ws://" not in entry]
        return [entry["message"] for entry in self.driver.get_log("browser")
                if entry["level"] == "SEVERE" and "WebSocket" not in entry["message"] and "/session" not in entry["message"]]
