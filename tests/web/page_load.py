#!/usr/bin/python3
"""The page with much: 10,000 jobs, a job of 100,000 frames, a thousand events a second. Prints what it measures.

What takes how long is printed, not judged: docs/measured.md has the figures of a quiet machine.
"""

import json
import sys
import time
import unittest

from browser import Farm, Page, wait_until
from selenium.webdriver.common.keys import Keys

JOBS = 10000
FRAMES = 100000
KEYS = 60

# Longest time between two pictures while the list is scrolled from end to end.
SCROLL = """
const done = arguments[0], rows = document.querySelector('.rows'), steps = 120;
let step = 0, last = performance.now(), gaps = [];
requestAnimationFrame(function move(now) {
  gaps.push(now - last);
  last = now;
  rows.scrollTop = (rows.scrollHeight - rows.clientHeight) * Math.min(1, ++step / steps);
  if (step < steps + 3) requestAnimationFrame(move);
  else done(gaps.slice(2).sort((a, b) => a - b));
});
"""

# Counts events, and how long inputs wait for their picture.
WATCH = """
const { farm } = window.marchdPage, hear = farm.hearEvent.bind(farm);
window.heard = { events: 0, begin: performance.now(), inputs: [], tasks: [] };
farm.hearEvent = (event) => { window.heard.events++; hear(event); };
new PerformanceObserver((list) => window.heard.inputs.push(...list.getEntries().filter((one) => one.name === 'keydown')
  .map((one) => one.duration))).observe({ type: 'event', durationThreshold: 16 });
new PerformanceObserver((list) => window.heard.tasks.push(...list.getEntries().map((one) => one.duration)))
  .observe({ type: 'longtask' });
"""


def told(name, value, unit):
    print(f"  {name}: {value:.0f} {unit}", flush=True)


class LoadTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.farm = Farm("skip")
        cls.addClassCleanup(cls.farm.close)
        cls.page = Page(cls.farm)
        cls.addClassCleanup(cls.page.close)

    def test_1_ten_thousand_jobs(self):
        begin = time.monotonic()
        answers = self.farm.call(*[("job.submit", {"document": self.farm.document(f"job{i}", "0-9"), "paused": True})
                                   for i in range(JOBS)])
        self.assertEqual([one for one in answers if "error" in one], [])
        told("submitting 10,000 jobs", time.monotonic() - begin, "s")
        # Jobs that are submitted in one breath get their ids in any order.
        oldest, newest = (self.farm.ask("job.list", {"order": order, "limit": 1})["jobs"][0]["name"]
                          for order in ("id", "-id"))
        page = self.page
        page.open(self.farm.link())
        page.has(f"{JOBS:,} of {JOBS:,} jobs, ", ".sum")
        page.open(self.farm.url)  # once more, with its files in the browser's cache
        wait_until("all jobs are known", lambda: page.run("return window.marchdPage?.farm.isLoaded"))
        page.has(newest, ".row[aria-rowindex='1']")
        told("the first jobs are shown after", page.run("return performance.getEntriesByName('jobs shown')[0].startTime"), "ms")
        self.assertLess(len(page.all(".row")), 100)
        gaps = page.driver.execute_async_script(SCROLL.replace("arguments[0]", "arguments[arguments.length - 1]"))
        told("between two pictures while scrolling, median", gaps[len(gaps) // 2], "ms")
        told("the longest", gaps[-1], "ms")
        page.has(oldest, f".row[aria-rowindex='{JOBS}']")
        page.keys("/", "job77")
        page.has(f"111 of {JOBS:,}", ".sum")
        page.keys(*[Keys.BACKSPACE] * 5, Keys.ESCAPE, Keys.END)
        page.has(oldest, ".row[aria-selected=true]")
        page.keys(Keys.ENTER)
        page.has(oldest, ".job h1")

    def test_2_a_hundred_thousand_frames_at_a_thousand_events_a_second(self):
        job = self.farm.submit("many", f"1-{FRAMES}", paused=True)
        page = self.page
        page.go(f"#/jobs/{job}")
        page.has(f"queued {FRAMES:,}", ".legend")
        page.run("performance.clearMeasures('grid')")
        page.run(WATCH)
        page.run("document.querySelector('.job canvas').focus()")
        page.keys(Keys.HOME)
        self.farm.ask("job.resume", {"id": job})
        wait_until("frames are told", lambda: page.run("return window.heard.events") > 100)
        page.run("window.heard.begin = performance.now(); window.heard.events = 0")
        for _ in range(KEYS):
            page.keys(Keys.ARROW_RIGHT)
            time.sleep(0.05)
        page.has(f"Frame {KEYS + 1}:", ".tell")
        heard = page.run("return { ...window.heard, seconds: (performance.now() - window.heard.begin) / 1000 }")
        told("events heard", heard["events"] / heard["seconds"], "a second")
        told("keys pressed and answered", KEYS, "")
        told("of these over 16 ms until the picture", len(heard["inputs"]), "")
        told("the longest", max(heard["inputs"], default=0), "ms")
        told("tasks over 50 ms", len(heard["tasks"]), "")
        wait_until("the job is over", lambda: self.farm.job(job)["state"] == "succeeded")
        page.has(f"skipped {FRAMES:,}", ".legend")
        drawn = page.run("return performance.getEntriesByName('grid', 'measure').map((one) => one.duration)")
        told("the grid was drawn", len(drawn), "times")
        told("median", sorted(drawn)[len(drawn) // 2], "ms")
        told("the longest", max(drawn), "ms")
        self.assertEqual(self.page.complaints(), [])

    def test_3_plots_and_flipbook_of_many_frames_are_shown(self):
        page = self.page
        job = self.farm.ask("job.list", {"order": "-id", "limit": 1})["jobs"][0]["id"]
        page.go(f"#/jobs/{job}/plots")
        page.has("No frame has a time yet")
        page.go(f"#/jobs/{job}/document")
        self.assertEqual(json.loads(wait_until("the document", lambda: page.find("pre.code").text))["name"], "many")


class RenderedTest(unittest.TestCase):
    """With a worker that renders, in software."""

    @classmethod
    def setUpClass(cls):
        cls.farm = Farm(None, workers=1)
        cls.addClassCleanup(cls.farm.close)
        cls.page = Page(cls.farm)
        cls.addClassCleanup(cls.page.close)
        cls.page.open(cls.farm.link())
        cls.job = cls.farm.submit("seen", "1-12", resolution=[160, 90], quality={"tolerance": 0.1})
        wait_until("the job is over", lambda: cls.farm.job(cls.job)["state"] == "succeeded")

    def test_plots_show_error_and_bound(self):
        page = self.page
        page.go(f"#/jobs/{self.job}/plots")
        page.has("tolerance 10 %, 0 frames over it")
        shown = page.run("return globalThis.Chart.getChart(document.querySelectorAll('.chart canvas')[1])"
                         ".data.datasets.map((one) => [one.label, one.data.length])")
        self.assertEqual(shown, [["error", 12], ["95 % bound", 12], ["tolerance", 2]])
        self.assertEqual(page.complaints(), [])


    def test_plan_says_what_was_planned_and_why(self):
        page = self.page
        page.go(f"#/jobs/{self.job}/plan")
        page.has("Foreseen error")
        planned = self.farm.ask("job.plans", {"id": self.job})["plans"][0]
        page.has(planned["why"])
        page.has(planned["quality"]["method"], "tbody")
        page.has("Light left out")
        page.has(planned["beyond"].get("why", "% of it, below"), "tbody")
        self.assertEqual(page.complaints(), [])


if __name__ == "__main__":
    sys.exit(not unittest.main(exit=False, verbosity=2).result.wasSuccessful())
