#!/usr/bin/python3
"""What a screen reader has of the page, by the browser's accessibility tree: names of controls, live regions, the grids."""

import getpass
import sys
import unittest

from browser import Farm, Page, wait_until
from selenium.webdriver.common.keys import Keys

CONTROLS = {"button", "link", "textbox", "searchbox", "combobox", "checkbox", "radio", "slider", "spinbutton", "grid",
            "application", "image", "progressbar", "columnheader", "dialog", "radiogroup", "region", "navigation"}


class Node:
    """What is told of one part: its role, name and description, and the text of all parts within."""

    def __init__(self, node, nodes):
        def value(key):
            return str(node.get(key, {}).get("value", ""))
        self.role, self.name, self.description = value("role"), value("name").strip(), value("description")
        self.properties = {one["name"]: one["value"] for one in node.get("properties", [])}
        self.text = self.name or " ".join(filter(None, (Node(nodes[child], nodes).text for child in
                                                        node.get("childIds", []) if child in nodes)))

    def is_(self, name):
        return bool(self.properties.get(name, {}).get("value"))

    @property
    def live(self):
        return self.properties.get("live", {}).get("value", "off")


class SpokenPageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.farm = Farm()
        cls.addClassCleanup(cls.farm.close)
        cls.page = Page(cls.farm)
        cls.addClassCleanup(cls.page.close)
        cls.over = cls.farm.submit("over", "1-5")
        wait_until("the job is over", lambda: cls.farm.job(cls.over)["state"] == "succeeded")
        cls.held = cls.farm.submit("held", "0-99", paused=True)
        cls.page.open(cls.farm.link())
        wait_until("the page is live", cls.page.is_live)

    def tree(self):
        nodes = {node["nodeId"]: node for node in
                 self.page.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]}
        return [Node(node, nodes) for node in nodes.values() if not node.get("ignored")]

    def heard(self, text):
        """Waits until a live region says it, which is what a screen reader reads out by itself."""
        wait_until(f'"{text}" is said', lambda: any(text in node.text for node in self.tree() if node.live != "off"))

    def focused(self):
        return next((node for node in self.tree() if node.is_("focused") and node.role != "RootWebArea"), None)

    def test_each_control_has_a_name_in_each_view(self):
        shown = {"#/jobs": "held", f"#/jobs/{self.held}": "queued 100", f"#/jobs/{self.over}/frames/3": "Header of the file",
                 f"#/jobs/{self.over}/flipbook": "that are done", f"#/jobs/{self.over}/plots": "Median",
                 f"#/jobs/{self.over}/plan": "Plan", f"#/jobs/{self.over}/document": "submit", "#/workers": "Pool local",
                 "#/submit": "Submit a job", "#/help": "pause or resume"}
        for place, text in shown.items():
            with self.subTest(place):
                self.page.go(place)
                if not place.endswith("document"):
                    self.page.has(text)
                tree = self.tree()
                nameless = [node.role for node in tree if node.role in CONTROLS and not node.name]
                self.assertEqual(nameless, [])
                self.assertTrue({"banner", "main", "navigation"} <= {node.role for node in tree})
                titles = [node.name for node in tree if node.role == "heading"
                          and node.properties["level"]["value"] == 1]
                self.assertEqual(len(titles), 1, titles)
                controls = [(node.role, node.name) for node in tree if node.role in ("button", "combobox", "slider")]
                self.assertEqual(len(controls), len(set(controls)), controls)

    def test_dialog_has_a_name_and_takes_the_focus(self):
        self.page.go(f"#/jobs/{self.held}")
        self.page.has("queued 100", ".legend")
        self.page.keys("c")
        self.page.has("Cancel job", "dialog")
        dialog = next(node for node in self.tree() if node.role == "dialog")
        self.assertEqual(dialog.name, f"Cancel job {self.held}, held")
        self.assertEqual(self.focused().name, "Leave it")
        self.page.keys(Keys.ESCAPE)

    def test_list_tells_the_row_at_which_one_is(self):
        page = self.page
        listed = self.farm.submit("listed", "0-99", paused=True)
        page.go("#/workers")
        page.has("Pool local")
        page.go("#/jobs")
        page.has("listed", ".rows")
        page.keys(Keys.HOME)
        grid = self.focused()
        self.assertEqual((grid.role, grid.name), ("grid", "Jobs"))
        active = grid.properties["activedescendant"]["relatedNodes"][0]["idref"]
        row = next(node for node in self.tree() if node.role == "row" and node.is_("selected"))
        self.assertEqual(active, page.run("return document.querySelector('.row[aria-selected=true]').id"))
        for word in (str(listed), "listed", f"paused by {getpass.getuser()}", "0/100"):
            self.assertIn(word, row.name)
        page.keys("/", "listed")
        self.heard("1 of ")
        page.keys(*[Keys.BACKSPACE] * 6, Keys.ESCAPE)

    def test_frames_are_told_by_keys_alone(self):
        page = self.page
        page.go(f"#/jobs/{self.held}")
        page.has("queued 100", ".legend")
        for _ in range(30):
            page.keys(Keys.TAB)
            if self.focused().role == "application":
                break
        self.assertIn("arrows move", self.focused().name)
        page.keys(Keys.HOME, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        self.heard("Frame 2: queued")
        self.assertEqual(self.focused().description, "Frame 2: queued")
        page.keys("n")
        self.heard("No failed frame after this one.")
        page.keys(Keys.ENTER)
        self.heard(f"Frame 2 of job {self.held}")

    def test_changes_of_state_are_said(self):
        page = self.page
        job = self.farm.submit("changes", "0-4", paused=True)
        page.go(f"#/jobs/{job}")
        self.heard(f"Job {job}, changes")
        page.keys("p")
        self.heard(f"Job {job}, changes: goes on.")
        self.heard(f"Job {job}, changes: succeeded")
        self.farm.stop_daemon()
        self.heard("not live: the daemon is away")
        self.farm.start_daemon()
        self.heard("● live")
        page.complaints()  # it complained about the connection


if __name__ == "__main__":
    sys.exit(not unittest.main(exit=False, verbosity=2).result.wasSuccessful())
