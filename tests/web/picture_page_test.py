#!/usr/bin/python3
"""Real frames in a browser: a frame's picture with channel, exposure and zoom, the flipbook, and what is no picture."""

import pathlib
import sys
import unittest

from browser import Farm, Page, wait_until
from selenium.webdriver.common.keys import Keys


class PicturePageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.farm = Farm(None)
        cls.addClassCleanup(cls.farm.close)
        cls.page = Page(cls.farm)
        cls.addClassCleanup(cls.page.close)
        document = cls.farm.document("film", "0-5")
        document["output"]["aovs"] = ["Z", "transmittance"]
        ball = {"kind": "noise", "frequency": 1.5, "octaves": 2,
                "bounds": {"kind": "sphere", "radius": 0.6, "falloff": 0.2}}
        document["scene"] = {"media": [{"sigma_s": 3, "density": ball}]}
        document["quality"] = {"method": "midpoint", "step": 0.1, "light_step": 0.1}
        cls.job = cls.farm.ask("job.submit", {"document": document})["id"]
        wait_until("the job is over", lambda: cls.farm.job(cls.job)["state"] == "succeeded")
        cls.page.open(cls.farm.link(scope="read"))
        wait_until("the page is live", cls.page.is_live)

    def natural(self):
        """Width and height of the picture that the browser has decoded, and its address."""
        return self.page.run("const p = document.querySelector('img.picture');"
                             "return p && p.complete && p.naturalWidth ? [p.naturalWidth, p.naturalHeight, p.src] : null")

    def open_frame(self, number):
        self.page.go(f"#/jobs/{self.job}/frames/{number}")
        self.page.has(f"{number}", ".frame h1")

    def wait_for(self, words):
        def found():
            picture = self.natural()
            return picture if picture and all(word in picture[2] for word in words) else None
        return wait_until(f"a picture with {words}", found)

    def test_frame_is_shown_by_channel_exposure_and_zoom(self):
        page = self.page
        self.open_frame(2)
        width, height, _ = self.wait_for([f"/frame/{self.job}/2.png?", "channel=color"])
        self.assertEqual((width, height), (32, 18))
        self.assertIn("marchd:jobHash", page.text(".frame"))
        self.assertRegex(page.text(".frame"), r"Light left out\s+[0-9.]+ % of it, below [0-9.]+ % with 95 %")
        options = page.run("return [...document.querySelector('.frame select').options].map(o => o.value)")
        self.assertEqual(options, ["A", "color", "Z", "transmittance"])
        page.run("const s = document.querySelector('.frame select'); s.value = 'Z'; s.dispatchEvent(new Event('change'))")
        self.wait_for(["channel=Z"])
        page.run("const s = document.querySelector('.frame select'); s.value = 'color'; s.dispatchEvent(new Event('change'))")
        page.find(".picturebox").send_keys("]")
        self.wait_for(["exposure=0.5"])
        page.find(".picturebox").send_keys("a")
        page.find(".picturebox").send_keys(Keys.ARROW_RIGHT)
        self.wait_for([f"/frame/{self.job}/3.png?"])
        self.assertEqual(page.complaints(), [])

    def test_flipbook_plays_all_frames_with_the_exposure_of_the_first(self):
        page = self.page
        page.go(f"#/jobs/{self.job}/flipbook")
        page.has("Frame 0, 1 of 6 that are done", ".flipbook")
        stops = wait_until("an exposure", lambda: page.run("return document.querySelector('[aria-label=\"Exposure in stops\"]').value"))
        self.assertNotEqual(float(stops), 0)
        page.click(".flipbook button", "Play")
        seen = set()

        def has_seen_all():
            seen.add(page.text(".flipbook .tell"))
            return len({text for text in seen if "loading" not in text}) >= 6
        wait_until("all frames were shown", has_seen_all)
        page.click(".flipbook button", "Stop")
        lit = page.run("const c = document.querySelector('canvas.flip');"
                       "return [c.width, c.height, c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((v, i) => i % 4 < 3 && v > 64)]")
        self.assertEqual(lit, [32, 18, True])
        addresses = page.run("return performance.getEntriesByType('resource').map(e => e.name).filter(n => n.includes('.png?') && n.includes('size=960'))")
        self.assertEqual(len({address.split("exposure=")[1].split("&")[0] for address in addresses if "exposure=" in address}), 1)
        self.assertEqual(page.complaints(), [])

    def test_plan_says_what_is_modelled_and_why(self):
        page = self.page
        page.go(f"#/jobs/{self.job}/plan")
        page.has("Not modelled", "#panel")
        told = page.run("return [...document.querySelectorAll('#panel table')].map(t => [t.caption.textContent,"
                        "[...t.rows].map(r => [...r.cells].map(c => c.textContent))])")
        tables = dict(told)
        self.assertEqual([row for row in tables["Modelled"] if row[0] == "depth"], [["depth", "output.aovs names Z"]])
        reasons = dict(tables["Not modelled"])
        self.assertRegex(reasons["multiple scattering"], "^light is scattered once at most; single scattering leaves out ")
        methods = dict(tables["Evaluations of densities for one sample, counted"][1:])
        self.assertGreater(int(methods["midpoint"].replace(",", "")), 0)
        spare = page.run("const { scrollHeight, clientHeight } = document.documentElement; return scrollHeight - clientHeight")
        self.assertEqual(spare, 0, "the window scrolls, beside what it shows")
        self.assertEqual(page.complaints(), [])

    def test_what_is_no_picture_says_why(self):
        file = pathlib.Path(self.farm.ask("job.frames", {"id": self.job})["frames"][5]["path"])
        good = file.read_bytes()
        try:
            file.unlink()
            file.symlink_to("/etc/passwd")
            self.open_frame(5)
            self.page.has("expected a regular file, by no link", ".frame")
        finally:
            file.unlink()
            file.write_bytes(good)
        self.page.complaints()  # the browser counts an answer of 422 as one


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
