"""Firefox for selenium without geckodriver, which Debian does not have: commands go to Firefox's own Marionette.

Marionette takes the commands of W3C's WebDriver over a socket, as JSON that its length stands before
(firefox-source-docs.mozilla.org, "Marionette protocol").
"""

import json
import os
import pathlib
import socket
import subprocess
import tempfile
import time

from selenium.common import exceptions
from selenium.webdriver.common.options import ArgOptions
from selenium.webdriver.remote.webdriver import WebDriver

FIREFOX = "/usr/bin/firefox-esr"
START_S = 300  # a guard, not a measure
SETTINGS = {"marionette.port": 0, "app.update.enabled": False, "browser.shell.checkDefaultBrowser": False,
            "datareporting.policy.dataSubmissionEnabled": False, "network.captive-portal-service.enabled": False,
            "network.connectivity-service.enabled": False, "network.proxy.type": 1, "network.proxy.socks": "127.0.0.1",
            "network.proxy.socks_port": 9, "network.proxy.no_proxies_on": "127.0.0.1",
            "network.proxy.allow_hijacking_localhost": False}  # no host but this one is reached
COMMANDS = {"newSession": "WebDriver:NewSession", "get": "WebDriver:Navigate", "refresh": "WebDriver:Refresh",
            "getCurrentUrl": "WebDriver:GetCurrentURL", "findElement": "WebDriver:FindElement",
            "findElements": "WebDriver:FindElements", "w3cExecuteScript": "WebDriver:ExecuteScript",
            "w3cExecuteScriptAsync": "WebDriver:ExecuteAsyncScript", "clickElement": "WebDriver:ElementClick",
            "getElementText": "WebDriver:GetElementText", "sendKeysToElement": "WebDriver:ElementSendKeys", "clearElement": "WebDriver:ElementClear",
            "getElementRect": "WebDriver:GetElementRect", "actions": "WebDriver:PerformActions",
            "getCookies": "WebDriver:GetCookies", "deleteAllCookies": "WebDriver:DeleteAllCookies",
            "screenshot": "WebDriver:TakeScreenshot", "setContext": "Marionette:SetContext",
            "quit": "Marionette:Quit"}
ERRORS = {"no such element": exceptions.NoSuchElementException,
          "stale element reference": exceptions.StaleElementReferenceException,
          "javascript error": exceptions.JavascriptException}


class Marionette:
    """What selenium hands its commands to: a Firefox of its own, with a profile that goes away with it."""

    def __init__(self, arguments):
        self.profile = tempfile.TemporaryDirectory(prefix="firefox_test_")
        folder = pathlib.Path(self.profile.name)
        lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in SETTINGS.items()]
        (folder / "user.js").write_text("".join(lines), encoding="utf-8")
        with open(folder / "log", "wb") as log:
            self.process = subprocess.Popen([FIREFOX, "--marionette", "--remote-allow-system-access", "--no-remote",
                                             "--profile", folder, *arguments], stdout=log, stderr=log,
                                            env={**os.environ, "HOME": str(folder)})
        self.socket = self.connect(folder / "MarionetteActivePort")
        self.stream = self.socket.makefile("rb")
        self.number = 0
        self.receive()  # it says who it is

    def connect(self, file):
        end = time.monotonic() + START_S
        while True:
            try:
                return socket.create_connection(("127.0.0.1", int(file.read_text(encoding="ascii"))))
            except (OSError, ValueError):
                assert time.monotonic() < end and self.process.poll() is None, (file.parent / "log").read_text()
                time.sleep(0.1)

    def receive(self):
        length = b""
        while not length.endswith(b":"):
            byte = self.stream.read(1)
            if not byte:
                raise exceptions.WebDriverException("Firefox has ended")
            length += byte
        return json.loads(self.stream.read(int(length[:-1])))

    def execute(self, command, params):
        self.number += 1
        body = json.dumps([0, self.number, COMMANDS[command], params]).encode()
        self.socket.sendall(f"{len(body)}:".encode() + body)
        _, _, error, result = self.receive()
        if error:
            raise ERRORS.get(error["error"], exceptions.WebDriverException)(f"{error['error']}: {error['message']}")
        return {"value": result["value"] if isinstance(result, dict) and list(result) == ["value"] else result}

    def close(self):
        self.stream.close()
        self.socket.close()
        self.process.kill()
        self.process.wait()
        self.profile.cleanup()


class Firefox(WebDriver):
    def __init__(self):
        self.marionette = Marionette(["--headless"])
        try:
            super().__init__(command_executor=self.marionette, options=FirefoxOptions())
        except BaseException:
            self.marionette.close()
            raise

    def quit(self):
        self.marionette.close()

    def run_as_browser(self, script, *arguments):
        """With the rights of Firefox's own windows."""
        self.execute("setContext", {"value": "chrome"})
        try:
            return self.execute_script(script, *arguments)
        finally:
            self.execute("setContext", {"value": "content"})

    def size(self, width, height):
        """Of the page; windows have a least width, so it is the part that shows the page that changes."""
        self.run_as_browser("window.resizeTo(Math.max(600, arguments[0]), arguments[1] + 200);"
                            "const box = gBrowser.selectedBrowser; box.style.flex = 'none';"
                            "box.style.width = arguments[0] + 'px'; box.style.height = arguments[1] + 'px';", width, height)

    def take_errors(self):
        """What Firefox's console has of pages since it was last asked."""
        return self.run_as_browser("""
            const told = Services.console.getMessageArray().filter((one) => one instanceof Ci.nsIScriptError
              && !(one.flags & Ci.nsIScriptError.warningFlag) && one.sourceName.startsWith('http://127.0.0.1'));
            Services.console.reset();
            return told.map((one) => `${one.sourceName}:${one.lineNumber}: ${one.errorMessage}`);""")


class FirefoxOptions(ArgOptions):
    @property
    def default_capabilities(self):
        return {}

    def to_capabilities(self):
        return {}
