#!/usr/bin/python3
"""march web in a browser: the file that it opens leads to a question, and the answer to the page, once."""

import os
import pathlib
import subprocess
import unittest

from browser import BIN, Farm, Page, wait_until


class SignInPageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.farm = Farm()
        cls.addClassCleanup(cls.farm.close)
        cls.page = Page(cls.farm)
        cls.addClassCleanup(cls.page.close)

    def march_web(self):
        """The file that march web has xdg-open open."""
        tools = self.farm.path / "tools"
        tools.mkdir(exist_ok=True)
        opened = self.farm.path / "opened"
        opened.unlink(missing_ok=True)
        opener = tools / "xdg-open"
        opener.write_text(f'#!/bin/sh\nprintf %s "$1" >"{opened}.new"\nmv "{opened}.new" "{opened}"\n', encoding="utf-8")
        opener.chmod(0o755)
        environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "XDG_RUNTIME_DIR": str(self.farm.path)}
        subprocess.run([BIN / "march", "web", "--socket", self.farm.socket, "--url", self.farm.url],
                       env=environment, check=True, stdout=subprocess.DEVNULL)
        wait_until("the opener is started", opened.exists)
        return pathlib.Path(opened.read_text(encoding="utf-8"))

    def test_a_click_signs_in_and_the_address_forgets_the_token(self):
        self.page.open(self.march_web().as_uri())
        wait_until("the question", lambda: self.page.find("#sign-in"))
        self.assertEqual(self.page.driver.get_cookies(), [])
        asked = self.page.driver.current_url
        self.page.click("#sign-in")
        wait_until("the page is live", self.page.is_live)
        self.assertNotIn("token", self.page.driver.current_url)
        [cookie] = self.page.driver.get_cookies()
        self.assertEqual((cookie["name"], cookie["httpOnly"], cookie["sameSite"]), ("marchd_session", True, "Strict"))
        self.assertEqual(self.page.complaints(), [])
        # Back in the browser's history, or by whoever finds the address later: it has been used.
        self.page.driver.delete_all_cookies()
        self.page.open(asked)
        wait_until("a refusal", lambda: "token" in self.page.text("body"))
        self.assertEqual(self.page.driver.get_cookies(), [])


if __name__ == "__main__":
    unittest.main()
