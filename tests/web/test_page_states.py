"""The page with answers that the test makes up: states that are hard to bring about, and names that are made to harm."""

import json
import time
import unittest

from browser import close_browser, missing, open_browser, set_window, skip_or_fail, wait_for

if missing():
    skip_or_fail("pages are not tested; install " + " ".join(missing()))

from page_checks import axe_findings, errors_in, layout_findings
from watched_test import WatchedTest

HOSTILE = "<img src=x onerror=\"window.harmed = true\"><script>window.harmed = true</script>"

# Answers in place of the server's; the page's own requests are counted.
FETCH = """
window.answers = %s;
window.requests = 0;
window.fetch = async (path) => {
  ++window.requests;
  if (window.answers === null) throw new TypeError("no answer");
  const whole = String(path).endsWith("/whole");
  const body = path === "api/tests" ? window.answers.tests : whole ? { cursor: 1, signals: [] } : window.answers.news;
  const text = JSON.stringify(body);
  if (path !== "api/tests" && !whole) { window.answers.news.reset = false; window.answers.news.events = []; }
  return new Response(text, { status: 200 });
};
"""


# As in status.js.
SPOKEN_PERIOD_S = 5.0

# Of the first chart, in a colour of its own.
DRAWN_PIXELS = """
const canvas = document.querySelector("figure canvas");
const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
let drawn = 0;
for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 60 && data[i] > data[i + 2] + 60) ++drawn;
return drawn;"""


def news(phase="running", verdict="Running.", name="made_up", **more):
    test = {"name": name, "phase": phase, "why": "", "mode": "paced", "step": 500, "last_step": 1000, "model_time_s": 5.0,
            "duration_s": 10.0, "step_s": 0.01, "time_scale": 1.0, "steps_per_second": 100.0, "left_s": 5.0, "stop_reason": "",
            "verdict": verdict, "has_report": False}
    signal = {"participant": "site", "group": "control", "name": "measured_displacement", "subject": "floor_1", "unit": "m",
              "limit": None, "t": [1.0, 2.0, 3.0], "least": [0.0, -0.02, 0.0], "most": [0.0, 0.03, 0.01],
              "last": [0.0, 0.01, 0.0123]}
    site = {"id": "site", "role": "experimental_site", "state": "running", "heard_s_ago": 0.1, "last_step": 500, "faults": [],
            "exchange": None}
    answer = {"cursor": 7, "reset": True, "test": test, "participants": [site], "interlocks": [], "events": [],
              "signals": [signal]}
    return {**answer, **more}


def listed(*names):
    return {"tests": [{"name": name, "phase": "running", "heard_s_ago": 0.1} for name in names], "control": True}


class PageStates(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = open_browser()
        cls.addClassCleanup(close_browser, cls.browser)
        cls.server = WatchedTest(None, allow_control=True)
        cls.addClassCleanup(cls.server.close)

    def open(self, answer, tests=None):
        answers = json.dumps({"tests": tests or listed("made_up"), "news": answer})
        script = self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": FETCH % answers})
        self.addCleanup(self.browser.execute_cdp_cmd, "Page.removeScriptToEvaluateOnNewDocument", script)
        set_window(self.browser, 1024, 2000)
        self.browser.get(self.server.origin)
        wait_for(lambda: self.text("figures"), "the first answer")

    def answer(self, answer):
        self.browser.execute_script("window.answers.news = arguments[0];", answer)

    def text(self, element):
        return self.browser.find_element("id", element).text

    def test_each_state_has_a_shape_and_a_sentence(self):
        self.open(news())
        marks = {}
        for phase in ("waiting", "assembling", "armed", "running", "paused", "held", "stopping", "stopped", "lost"):
            self.answer(news(phase, f"The sentence of {phase}."))
            wait_for(lambda p=phase: self.text("verdict_text") == f"The sentence of {p}.", phase)
            marks[phase] = self.text("phase_mark")
            self.assertEqual(axe_findings(self.browser), [], phase)
        self.assertEqual(len(set(marks.values())), len(marks), marks)

    def test_hostile_names_stay_text(self):
        site = {"id": HOSTILE, "role": HOSTILE, "state": HOSTILE, "heard_s_ago": 9.0, "last_step": 1, "faults": [HOSTILE],
                "exchange": None}
        interlock = {"participant": HOSTILE, "name": HOSTILE, "unit": HOSTILE, "observed": 1.0, "limit": 2.0, "share": 0.5,
                     "peak_share": 0.6}
        event = {"cursor": 1, "time_utc": HOSTILE, "source": HOSTILE, "severity": HOSTILE, "text": HOSTILE, "model_time_s": 1.0,
                 "step": 1}
        signals = [{"participant": HOSTILE, "group": group, "name": "displacement" if group != "control" else "force",
                    "subject": HOSTILE, "unit": HOSTILE, "limit": None, "t": [1.0], "least": [0.0], "most": [1.0], "last": [1.0]}
                   for group in ("structure", "control", "steps")]
        self.open(news(HOSTILE, HOSTILE, HOSTILE, participants=[site], interlocks=[interlock], events=[event], signals=signals),
                  listed(HOSTILE))
        wait_for(lambda: len(self.browser.find_elements("css selector", "figure")) == 3, "the charts")
        time.sleep(0.5)  # for an image to fail
        self.assertIsNone(self.browser.execute_script("return window.harmed ?? null"))
        self.assertEqual(self.browser.find_elements("css selector", "body img, body script"), [])
        self.assertEqual(self.text("verdict_text"), HOSTILE)
        self.assertEqual(layout_findings(self.browser)[0], [])
        self.assertEqual(errors_in(self.browser), [])

    def test_missing_numbers_are_dashes(self):
        answer = news()
        for key in ("step", "last_step", "model_time_s", "duration_s", "step_s", "time_scale", "steps_per_second", "left_s", "mode"):
            answer["test"][key] = None
        answer["participants"][0].update(heard_s_ago=None, last_step=None)
        answer["interlocks"] = [{"participant": "site", "name": "force", "unit": "N", "observed": None, "limit": 1.0,
                                 "share": None, "peak_share": None}]
        answer["signals"][0].update(least=[None, None, None], most=[None, None, None], last=[None, None, None])
        self.open(answer)
        self.assertNotIn("NaN", self.browser.find_element("tag name", "body").text)
        self.assertNotIn("null", self.browser.find_element("tag name", "body").text)
        self.assertIn("– of – s", self.text("figures"))
        self.assertIn("not heard yet", self.text("participants"))
        self.assertEqual(errors_in(self.browser), [])

    def test_silent_participant_is_marked_after_three_seconds(self):
        self.open(news())
        self.assertNotIn("not heard", self.text("participants"))
        answer = news()
        answer["participants"][0]["heard_s_ago"] = 4.2
        self.answer(answer)
        wait_for(lambda: "⚠ not heard for 4.2 s" in self.text("participants"), "the mark")

    def test_silent_server_is_told_and_values_stay(self):
        self.open(news())
        wait_for(lambda: "12.3" in self.text("charts"), "the newest value")
        self.browser.execute_script("window.answers = null")
        wait_for(lambda: "has not answered for 3 s" in self.text("server_lost"), "the notice", 10)
        self.assertIn("12.3", self.text("charts"))

    def test_emergency_stop_is_there_before_the_first_answer(self):
        script = self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": FETCH % "null"})
        self.addCleanup(self.browser.execute_cdp_cmd, "Page.removeScriptToEvaluateOnNewDocument", script)
        set_window(self.browser, 1024, 2000)
        self.browser.get(self.server.origin)
        wait_for(lambda: self.text("server_lost"), "the notice that nobody answers")
        self.assertTrue(self.browser.find_element("css selector", ".emergency").is_displayed())
        # Once the server answers that it passes nothing on, there is none.
        answers = {"tests": {**listed("made_up"), "control": False}, "news": news()}
        self.browser.execute_script("window.answers = arguments[0];", answers)
        wait_for(lambda: not self.browser.find_element("css selector", ".emergency").is_displayed(), "the end of the controls")

    def test_another_test_can_be_chosen(self):
        self.open(news(), listed("made_up", "another"))
        self.answer(news(verdict="Another runs.", name="another"))
        choice = self.browser.find_element("id", "test_choice")
        choice.find_element("css selector", "option[value=another]").click()
        wait_for(lambda: self.text("verdict_text") == "Another runs.", "the other test")
        self.assertIn("test=another", self.browser.current_url)
        self.browser.refresh()
        wait_for(lambda: self.browser.find_element("id", "test_choice").get_attribute("value") == "another", "the choice again")

    def test_peak_between_points_is_drawn(self):
        """A band reaches the least and the most, although no line does."""
        self.open(news())
        wait_for(lambda: "12.3" in self.text("charts"), "the newest value")
        wait_for(lambda: self.browser.execute_script(DRAWN_PIXELS) > 0, "the curve")
        rows = self.browser.execute_script("""
          const canvas = document.querySelector("figure canvas");
          const { data, width, height } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          const rows = [];
          for (let y = 0; y < height; ++y) for (let x = 62; x < 85; ++x) {
            const i = 4 * (y * width + x);
            if (data[i + 3] > 60 && data[i] > data[i + 2] + 60) rows.push(y);
          }
          return [Math.min(...rows), Math.max(...rows), height];""")
        # From -20 to 30 mm on an axis with 8 % of room: the band fills 86 % of the height between the axes.
        self.assertGreater(rows[1] - rows[0], 0.80 * (rows[2] - 30))

    def test_screen_reader_is_not_flooded(self):
        self.open(news())
        self.browser.execute_script("""
          window.spoken = [];
          new MutationObserver(() => spoken.push(document.getElementById("spoken").textContent))
            .observe(document.getElementById("spoken"), { childList: true, characterData: true, subtree: true });""")
        begin_s = time.monotonic()
        for i in range(25):
            answer = news("held" if i % 2 else "running")
            answer["test"].update(why=f"reason {i}", step=500 + i)
            self.answer(answer)
            time.sleep(0.2)
        spoken = self.browser.execute_script("return window.spoken")
        # Once in the longest silence that the page keeps, however long a busy machine took for the 25 changes.
        self.assertLessEqual(len(spoken), 1 + (time.monotonic() - begin_s) / SPOKEN_PERIOD_S, spoken)
        for live in self.browser.find_elements("css selector", "[aria-live], [role=status], [role=alert], [role=log]"):
            self.assertIn(live.get_attribute("id"), ("spoken", "control_answer"))

    def test_keyboard_reaches_every_control(self):
        self.open(news())
        reached = set()
        for _ in range(20):
            self.browser.switch_to.active_element.send_keys("\ue004")  # Tab
            active = self.browser.switch_to.active_element
            reached.add(active.get_attribute("data-verb") or active.get_attribute("id") or active.get_attribute("value"))
        self.assertLessEqual({"test_choice", "recent", "large_mode", "pause", "stop", "emergency_stop"}, reached)

    def test_asks_about_twenty_times_a_second(self):
        self.open(news())
        before = self.browser.execute_script("return window.requests")
        time.sleep(3.0)
        rate = (self.browser.execute_script("return window.requests") - before) / 3.0
        self.assertLessEqual(rate, 23.0)
        self.assertGreater(rate, 5.0)  # on a busy machine


if __name__ == "__main__":
    unittest.main()
