"""The page of a running test: what it shows, how it looks, and what it does when something ends."""

import os
import re
import signal
import time
import unittest

from browser import close_browser, missing, open_browser, set_window, skip_or_fail, wait_for

if missing():
    skip_or_fail("pages are not tested; install " + " ".join(missing()))

from page_checks import check_page, layout_findings
from watched_test import WatchedTest

# Titles of the charts of the scenario.
TITLES = {
    "Displacement · floor_1 [mm]", "Displacement · floor_2 [mm]", "Drift · storey_1 floor_1 [mm]",
    "Drift · storey_2 floor_2 relative to floor_1 [mm]", "Base shear [kN]", "Energy balance [kJ]", "Energy balance error [J]",
    "Displacement [mm]", "Force [kN]", "Force against displacement [kN]", "Tracking error [mm]",
    "Measured against target [mm]", "Estimated delay [ms]", "Force · floor_2 relative to floor_1 [kN]",
    "Force against displacement · floor_2 relative to floor_1 [kN]",
}

CHARTS = """
return Object.fromEntries([...document.querySelectorAll("figure")].filter((figure) => !figure.hidden).map((figure) => [
  figure.closest("section").querySelector("h2").textContent + ": " + figure.querySelector("h3").textContent,
  { values: Object.fromEntries([...figure.querySelectorAll(".entry")].map((entry) =>
      [entry.childNodes[entry.childNodes.length - 2].textContent.trim(), entry.querySelector("output").textContent])),
    at: figure.querySelector(".at").textContent }]));
"""


def charts(browser):
    return browser.execute_script(CHARTS)


def number(text):
    return float(text.replace("−", "-"))


def shown_time_s(chart):
    found = re.fullmatch(r"at ([\d.]+) s", chart["at"])
    return float(found.group(1)) if found else None


def text_of(browser, element):
    return browser.find_element("id", element).text


def is_drawn(browser):
    """Waits until every canvas has a curve; those out of view are drawn when the window is as high as the page."""
    wait_for(lambda: not [line for line in layout_findings(browser)[0] if "pixels drawn" in line], "curves", 10)


class RunningTest(unittest.TestCase):
    """One test of 40 s, looked at in several ways."""

    @classmethod
    def setUpClass(cls):
        cls.browser = open_browser()
        cls.addClassCleanup(close_browser, cls.browser)
        cls.test = WatchedTest(duration_s=40, allow_control=True)
        cls.addClassCleanup(cls.test.close)
        cls.test.wait_until_it_moves()

    def setUp(self):
        set_window(self.browser, 1600, 4000)
        self.browser.get(self.test.address)
        wait_for(self.has_all_charts, "the charts")

    def has_all_charts(self):
        shown = charts(self.browser)
        return TITLES <= {key.split(": ", 1)[1] for key in shown} and all(chart["at"] for chart in shown.values())

    def test_1_shows_within_a_second_what_is_recorded(self):
        expected = {
            ("Structure: Displacement · floor_1 [mm]", "displacement"): ("coordinator", "steps", "displacement_floor_1_m", 1e3),
            ("Structure: Displacement · floor_2 [mm]", "displacement"): ("coordinator", "steps", "displacement_floor_2_m", 1e3),
            ("Site storey_1: Displacement [mm]", "target"): ("storey_1", "control", "target_displacement_m", 1e3),
            ("Site storey_1: Displacement [mm]", "command"): ("storey_1", "control", "command_displacement_m", 1e3),
            ("Site storey_1: Displacement [mm]", "measured"): ("storey_1", "control", "measured_displacement_m", 1e3),
            ("Site storey_1: Force [kN]", "force"): ("storey_1", "control", "measured_force_n", 1e-3),
        }
        seen = []
        for _ in range(5):
            # Read before the page: what it shows may be newer, not older than a second.
            recorded_s = self.test.rows("coordinator", "steps")["model_time_s"][-1]
            now = charts(self.browser)
            for chart, label in expected:
                self.assertGreaterEqual(shown_time_s(now[chart]), recorded_s - 1.0, chart)
                seen.append((chart, label, shown_time_s(now[chart]), number(now[chart]["values"][label])))
            time.sleep(0.7)
        tables = {where[:2]: self.test.rows(*where[:2]) for where in expected.values()}
        for chart, label, at_s, value in seen:
            participant, table, column, factor = expected[chart, label]
            rows = tables[participant, table]
            # The time has three digits behind the point; every recorded value of that millisecond may be meant.
            near = [row for row, t in zip(rows[column], rows["model_time_s"]) if abs(t - at_s) <= 0.0006]
            self.assertTrue(near, f"{chart}: nothing is recorded at {at_s} s")
            distance = min(abs(row * factor - value) for row in near)
            self.assertLessEqual(distance, max(0.006 * abs(value), 1e-4), f"{chart}, {label} at {at_s} s: {value}")

    def test_2_names_what_runs(self):
        wait_for(lambda: text_of(self.browser, "verdict_text").startswith("Running"), "the verdict")
        self.assertEqual(self.browser.find_element("id", "verdict").get_attribute("data-phase"), "running")
        names = [card.text.split("\n")[0] for card in self.browser.find_elements("css selector", ".participant")]
        self.assertEqual(sorted(names), ["coordinator", "storey_1", "storey_2"])
        site = next(card for card in self.browser.find_elements("css selector", ".participant") if "storey_1" in card.text)
        self.assertRegex(site.text, r"round trip p50 / p99\n\d[\d.]* / \d[\d.]* µs")
        self.assertRegex(site.text, r"resent / bridged / lost\n\d+ / \d+ / \d+")
        meters = {meter.get_attribute("aria-label").split(",")[0]: meter
                  for meter in self.browser.find_elements("css selector", "[role=meter]")}
        self.assertLessEqual({"displacement", "velocity", "force", "tracking error"}, set(meters))
        self.assertRegex(meters["displacement"].get_attribute("aria-valuetext"),
                         r"^\d+ % of the limit; [\d.]+ of 200 mm, at most \d+ % so far$")
        self.assertIn("steps/s", text_of(self.browser, "figures"))
        self.assertTrue(self.browser.find_elements("css selector", "#events li"), "no event")

    def test_3_whole_test_begins_at_zero(self):
        self.browser.execute_script("document.querySelector('input[value=whole]').click()")
        is_drawn(self.browser)
        first_s = self.browser.execute_async_script(
            "const done = arguments[0]; fetch(`api/tests/${document.getElementById('test_choice').value}/whole`)"
            ".then((answer) => answer.json()).then(({ signals }) => done(Math.max(...signals.map(({ t }) => t[0]))));")
        self.assertLess(first_s, 2.0)

    def test_4_looks_right_at_every_width(self):
        check_page(self, self.browser, "live", lambda: is_drawn(self.browser))
        self.browser.find_element("id", "large_mode").click()
        check_page(self, self.browser, "live_large", lambda: is_drawn(self.browser))

    def test_5_emergency_stop_stays_in_view(self):
        for width, height in ((1600, 1000), (390, 844), (844, 390)):
            set_window(self.browser, width, height)
            for large in (False, True):
                for place in (0, 100000):
                    self.browser.execute_script("scrollTo(0, arguments[0])", place)
                    on_top = self.browser.execute_script(
                        "const box = document.querySelector('.emergency').getBoundingClientRect();"
                        "const top = document.elementFromPoint((box.left + box.right) / 2, (box.top + box.bottom) / 2);"
                        "return Boolean(top?.closest('.emergency')) && box.top >= 0 && box.bottom <= innerHeight")
                    self.assertTrue(on_top, f"{width} × {height}, large: {large}, scrolled to {place}")
                self.browser.find_element("id", "large_mode").click()

    def test_6_stays_readable_after_the_end(self):
        wait_for(lambda: self.test.phase() == "stopped", "the end of the test", 60)
        self.assertEqual(self.test.run.wait(timeout=30), 0, self.test.printed("run"))
        wait_for(lambda: self.browser.find_element("id", "verdict").get_attribute("data-phase") == "stopped", "the verdict")
        self.assertEqual(text_of(self.browser, "verdict_text"), "Completed.")
        # Also for someone who comes late, and when the server has ended.
        self.browser.refresh()
        wait_for(self.has_all_charts, "the charts")
        is_drawn(self.browser)
        self.test.server.send_signal(signal.SIGTERM)
        wait_for(lambda: "has not answered" in text_of(self.browser, "server_lost"), "the notice that the server is gone")
        is_drawn(self.browser)
        rows = self.test.rows("coordinator", "steps")
        shown = charts(self.browser)["Structure: Displacement · floor_1 [mm]"]
        self.assertAlmostEqual(shown_time_s(shown), rows["model_time_s"][-1], places=2)


class LostParticipant(unittest.TestCase):
    def test_is_seen_within_its_lease(self):
        browser = open_browser()
        self.addCleanup(close_browser, browser)
        test = WatchedTest(duration_s=60)
        self.addCleanup(test.close)
        test.wait_until_it_moves()
        browser.get(test.address)
        wait_for(lambda: "storey_2" in text_of(browser, "participants"), "the participants")
        self.assertEqual(text_of(browser, "controls"), "Watching only")
        os.kill(test.process_id_of("storey_2"), signal.SIGKILL)
        killed_s = time.monotonic()
        wait_for(lambda: re.search(r"storey_2\n.*(lost|not heard)", text_of(browser, "participants")), "the lost participant")
        # The lease is 2 s at most since the last status; text of the page is renewed five times a second.
        self.assertLess(time.monotonic() - killed_s, 3.0)
        wait_for(lambda: "storey_2" in text_of(browser, "verdict_text"), "the verdict that names it")
        self.assertEqual(test.summary()["stop_reason"], "participant_lost")


class ManyPages(unittest.TestCase):
    """Eight pages for 20 s; HYBRIDTEST_WATCH_SECONDS sets a longer time."""

    def test_leave_the_memory_of_the_server_flat(self):
        seconds = float(os.environ.get("HYBRIDTEST_WATCH_SECONDS", "20"))
        browser = open_browser()
        self.addCleanup(close_browser, browser)
        test = WatchedTest(duration_s=seconds + 60)
        self.addCleanup(test.close)
        test.wait_until_it_moves()
        for i in range(8):
            if i > 0:
                browser.switch_to.new_window("window")
            set_window(browser, 390)  # few charts in view: it is the server that is looked at
            browser.get(test.address)
        wait_for(lambda: charts(browser), "the charts")
        time.sleep(5.0)
        before_kb = resident_kb(test.server.pid)
        time.sleep(seconds)
        after_kb = resident_kb(test.server.pid)
        print(f"\n8 pages for {seconds:.0f} s: memory of the server {before_kb} kB, then {after_kb} kB")
        for handle in browser.window_handles:
            browser.switch_to.window(handle)
            self.assertEqual(browser.find_element("id", "verdict").get_attribute("data-phase"), "running")
        # The history of the test itself grows until it is full: 30 s of each signal and 2000 points of the whole.
        self.assertLess(after_kb - before_kb, 12000)


def resident_kb(process):
    with open(f"/proc/{process}/status", encoding="utf-8") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS:"))


if __name__ == "__main__":
    unittest.main()
