#!/usr/bin/python3
"""The page in a browser, against a daemon with stub workers: it shows what is, and each action does what it says."""

import json
import sys
import unittest

from browser import Farm, Page, wait_until
from selenium.webdriver.common.keys import Keys


class PageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.farm = Farm()
        cls.addClassCleanup(cls.farm.close)
        cls.page = Page(cls.farm)
        cls.addClassCleanup(cls.page.close)
        cls.page.open(cls.farm.link())
        wait_until("the page is live", cls.page.is_live)

    def setUp(self):
        self.page.run("for (const open of document.querySelectorAll('dialog, .toast')) open.remove()")

    def tearDown(self):
        self.assertEqual(self.page.complaints(), [])

    def open_job(self, number):
        self.page.go(f"#/jobs/{number}")
        self.page.has(f"{number} ", ".job h1")
        wait_until("its frames are drawn", lambda: self.page.find(".job canvas").size["height"] > 0)

    def state_of(self, number, state):
        wait_until(f"job {number} is {state}", lambda: self.farm.job(number)["state"] == state)

    def test_list_shows_finds_and_follows_jobs(self):
        first = self.farm.submit("list_ash", "0-9", paused=True, tags=["sq010"])
        second = self.farm.submit("list_fog", "0-4", paused=True, priority=70)
        page = self.page
        page.go("#/jobs")
        page.has("list_fog", ".rows")
        row = page.named(".row", "list_ash").text.split("\n")
        for word in (str(first), "root", "Ⅱ paused", "paused by root", "0/10", "midpoint"):
            self.assertIn(word, " ".join(row))
        page.keys("/", "sq010")
        wait_until("one row is left", lambda: [r.text.split()[0] for r in page.all(".row")] == [str(first)])
        self.assertIn("1 of ", page.text(".sum"))
        page.keys(*[Keys.BACKSPACE] * 5, Keys.ESCAPE)
        self.assertEqual(page.run("return document.activeElement.className"), "rows")
        page.click(".heads button", "Prio")
        page.click(".heads button", "Prio")
        wait_until("the highest priority comes first", lambda: str(second) == page.find(".row[aria-rowindex='1'] .id").text)
        page.click(".heads button", "Job")
        self.farm.ask("job.resume", {"id": first})
        wait_until("the row follows", lambda: "✓ succeeded" in page.named(".row", "list_ash").text)
        self.assertIn("10/10", page.named(".row", "list_ash").text)
        self.assertIn("0.63 %", page.named(".row", "list_ash").text)

    def test_grid_tells_each_frame(self):
        job = self.farm.submit("grid", "0-99x3", paused=True)
        page = self.page
        self.open_job(job)
        page.has("queued 34", ".legend")
        page.run("document.querySelector('.job canvas').scrollIntoView()")
        page.find(".job canvas").click()
        self.assertRegex(page.run("return location.hash"), rf"#/jobs/{job}/frames/\d+")
        page.has("there is no picture yet", ".frame")
        page.keys(Keys.ESCAPE)
        page.has("queued 34", ".legend")
        page.run("document.querySelector('.job canvas').focus()")
        page.keys(Keys.HOME, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        page.has("Frame 6: queued", ".tell")
        self.farm.ask("job.resume", {"id": job})
        page.has("succeeded 34", ".legend")
        page.keys(Keys.END)
        page.has("Frame 99: succeeded", ".tell")
        page.has("error 0.63 %, below 0.75 % with 95 %", ".tell")
        page.click(".choice label", "error")
        page.has("0.63 %", ".legend")

    def test_actions_by_keys(self):
        job = self.farm.submit("acted", "0-4", paused=True)
        page = self.page
        self.open_job(job)
        page.keys("p")
        self.state_of(job, "succeeded")
        page.has("succeeded", ".job h1")
        page.keys("r")
        page.has("Retry frames", "dialog")
        page.run("for (const box of document.querySelectorAll('dialog [name=state]')) box.checked = box.value === 'succeeded'")
        page.run("document.querySelector('dialog [name=force]').checked = true")
        page.click("dialog input[name=range]")
        page.keys("1-2", Keys.ENTER)
        page.has("2 frames are tried again", "#toasts")
        self.state_of(job, "succeeded")
        waits = self.farm.submit("waits", "0-4", paused=True)
        self.open_job(waits)
        page.keys("+")
        page.find("dialog input[name=priority]").clear()
        page.find("dialog input[name=priority]").send_keys("83", Keys.ENTER)
        wait_until("its priority", lambda: self.farm.job(waits)["priority"] == 83)
        page.keys("c")
        page.has("Cancel job", "dialog")
        page.keys(Keys.ESCAPE)
        self.assertEqual(self.farm.job(waits)["state"], "paused")
        page.keys("c")
        page.click("dialog button", "Cancel the job")
        self.state_of(waits, "canceled")
        page.has("canceled", ".job h1")
        page.keys(Keys.DELETE)
        page.has("cannot be undone", "dialog")
        page.click("dialog button", "Delete")
        page.has("The job is deleted", ".job")
        answer = self.farm.call(("job.show", {"id": waits}))[0]
        self.assertEqual(answer["error"]["code"], 1)

    def test_submit_shows_mistakes_at_their_place(self):
        page = self.page
        document = self.farm.document("submitted", "0-4")
        document["scene"]["media"][0]["phase"][0]["g"] = 3
        text = json.dumps(document, indent=1)
        page.go("#/submit")
        page.has("Submit a job")

        def try_text(text):
            page.run("const area = document.querySelector('#document'); area.value = arguments[0];"
                     "area.dispatchEvent(new Event('input'))", text)
            page.find("#document").send_keys(Keys.CONTROL + Keys.ENTER)

        def chosen():
            return page.run("const area = document.querySelector('#document');"
                            "return area.value.slice(area.selectionStart, area.selectionEnd)")
        try_text(text)
        line = next(i for i, each in enumerate(text.split("\n"), 1) if '"g": 3' in each)
        page.has(f"Line {line}, column", "#mistake")
        page.has("scene.media[0].phase[0].g: expected a number in [-0.99999, 0.99999], got 3", "#mistake")
        self.assertEqual(chosen(), '"g": 3')
        self.assertEqual(page.text(".lines .wrong").strip(), f"✗{line}")
        try_text(text.replace('"frames"', '"framse"'))
        page.has('unknown key "framse"', "#mistake")
        self.assertEqual(chosen(), '"framse": "0-4"')
        try_text(text.replace('"frames": "0-4"', '"frames": "0-4'))
        page.has("expected a value", "#mistake")
        try_text(text.replace('"g": 3', '"g": 0.3'))
        wait_until("the job's view", lambda: page.run("return location.hash").startswith("#/jobs/"))
        page.has("submitted", ".job h1")

    def test_page_lives_through_a_restart_of_the_daemon(self):
        job = self.farm.submit("restarted", "0-4", paused=True)
        page = self.page
        self.open_job(job)
        self.farm.stop_daemon()
        page.has("not live", "#link")
        page.has("the daemon is away", "#link")
        self.farm.start_daemon()
        wait_until("the page is live again", page.is_live)
        self.farm.ask("job.resume", {"id": job})
        page.has("succeeded 5", ".legend")
        page.complaints()  # it complained about the connection

    def test_pages_that_lost_the_farm_together_come_back_apart(self):
        """Fifty connections that break in one instant, many times: their waits differ, grow, and end at some length."""
        waits = self.page.driver.execute_async_script("""
            const done = arguments[0];
            import('/page/farm.js').then(({ Farm }) => {
              const farms = Array.from({ length: 50 }, () => new Farm());
              done(Array.from({ length: 12 }, () => farms.map((farm) => {
                const begin = Date.now();
                farm.retry('a test');
                clearTimeout(farm.timer);
                return farm.retryAt - begin;
              })));
            });""")
        for longest, each in zip((1, 2, 4, 8, 15, 15, 15), waits):
            spread = max(each) - min(each)
            self.assertGreater(spread, longest * 1000 / 2, each)
            self.assertTrue(all(200 <= wait <= longest * 1000 + 250 for wait in each), each)
            self.assertGreater(len({round(wait / (longest * 20)) for wait in each}), 20, each)
        self.assertLessEqual(max(max(each) for each in waits), 15250)

    def test_workers_are_told(self):
        page = self.page
        page.go("#/workers")
        page.has("Pool local, 2")
        page.has("stub")
        self.assertEqual(len(page.all("tbody tr")), 2)

    def test_keys_are_told(self):
        self.page.go("#/jobs")
        self.page.keys("?")
        self.page.has("pause or resume")
        self.assertNotIn("[object", self.page.text())
        self.page.keys("2")
        self.page.has("Workers", "h1")

    def test_reading_session_changes_nothing(self):
        job = self.farm.submit("read_only", "0-4", paused=True)
        self.page.open(self.farm.link("read"))
        self.addCleanup(self.page.open, self.farm.link("admin"))
        wait_until("the page is live", self.page.is_live)
        self.page.has("(read)", "#user")
        self.open_job(job)
        self.page.has("This session may only read.")
        self.page.keys("p")
        self.assertEqual([b.text for b in self.page.all(".actions button") if b.is_displayed()], [])
        self.assertEqual(self.farm.job(job)["state"], "paused")


if __name__ == "__main__":
    sys.exit(not unittest.main(exit=False, verbosity=2).result.wasSuccessful())
