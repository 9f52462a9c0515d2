"""What the buttons of the page do, and whom the server refuses."""

import time
import unittest

from browser import close_browser, missing, open_browser, set_window, skip_or_fail, wait_for

if missing():
    skip_or_fail("pages are not tested; install " + " ".join(missing()))

from watched_test import WatchedTest


def press(browser, verb):
    wait_for(lambda: browser.find_element("css selector", f"[data-verb={verb}]").is_enabled(), f"the button {verb}")
    browser.find_element("css selector", f"[data-verb={verb}]").click()


def confirm(browser, answer):
    wait_for(lambda: browser.find_element("id", "confirmation").is_displayed(), "the question")
    browser.find_element("css selector", f"#confirmation button[value={answer}]").click()


class Buttons(unittest.TestCase):
    def setUp(self):
        self.browser = open_browser()
        self.addCleanup(close_browser, self.browser)
        self.test = WatchedTest(duration_s=60, allow_control=True)
        self.addCleanup(self.test.close)
        self.test.wait_until_it_moves()
        set_window(self.browser, 1024)
        self.browser.get(self.test.address)

    def phase_on_page(self):
        return self.browser.find_element("id", "verdict").get_attribute("data-phase")

    def wait_for_phase(self, phase):
        wait_for(lambda: self.phase_on_page() == phase, f"the phase {phase}")

    def test_pause_resume_and_stop(self):
        press(self.browser, "pause")
        self.wait_for_phase("paused")
        first = self.test.rows("coordinator", "steps")["model_time_s"][-1]
        time.sleep(0.5)
        self.assertLessEqual(self.test.rows("coordinator", "steps")["model_time_s"][-1], first + 0.2)

        press(self.browser, "resume")
        confirm(self.browser, "no")
        self.assertEqual(self.test.phase(), "paused")
        press(self.browser, "resume")
        confirm(self.browser, "yes")
        self.wait_for_phase("running")
        moved = wait_for(lambda: self.test.rows("coordinator", "steps")["model_time_s"][-1] > first + 0.3, "the next steps")
        self.assertTrue(moved)

        press(self.browser, "stop")
        confirm(self.browser, "yes")
        self.wait_for_phase("stopped")
        self.assertEqual(self.test.summary()["stop_reason"], "interrupted")

    def test_emergency_stop_is_one_click_beside_a_question(self):
        press(self.browser, "stop")
        wait_for(lambda: self.browser.find_element("id", "confirmation").is_displayed(), "the question")
        self.browser.find_element("css selector", ".emergency").click()
        self.wait_for_phase("stopped")
        self.assertEqual(self.test.summary()["stop_reason"], "emergency_stop")

    def test_page_without_token_asks_for_it(self):
        self.browser.get("about:blank")
        self.browser.get(self.test.origin)
        press(self.browser, "pause")
        wait_for(lambda: self.browser.find_element("id", "token_entry").is_displayed(), "the question for the token")
        self.browser.find_element("id", "token").send_keys("wrong\n")
        wait_for(lambda: "NOT SENT" in self.browser.find_element("id", "control_answer").text, "the refusal")
        self.assertEqual(self.test.phase(), "running")
        press(self.browser, "pause")
        self.browser.find_element("id", "token").send_keys(self.test.token + "\n")
        self.wait_for_phase("paused")


class Refusals(unittest.TestCase):
    def test_nobody_else_changes_anything(self):
        test = WatchedTest(duration_s=40, allow_control=True)
        self.addCleanup(test.close)
        test.wait_until_it_moves()
        good = {"Authorization": f"Bearer {test.token}"}
        self.assertGreaterEqual(len(test.token), 32)
        for verb in ("pause", "stop", "emergency_stop"):
            self.assertEqual(test.control(verb, {}), 401)
            self.assertEqual(test.control(verb, {"Authorization": "Bearer " + "0" * len(test.token)}), 401)
            self.assertEqual(test.control(verb, {**good, "Origin": "http://example.org"}), 403)
            self.assertEqual(test.control(verb, {**good, "Host": "example.org"}), 403)
        self.assertEqual(test.control("explode", good), 400)
        self.assertEqual(test.phase(), "running")
        self.assertFalse([event for event in test.news()["events"] if "paus" in event["text"]])
        # The control: the same request with the token does change something.
        self.assertEqual(test.control("pause", {**good, "Origin": test.origin}), 202)
        wait_for(lambda: test.phase() == "paused", "the pause")

    def test_server_without_control_sends_nothing(self):
        test = WatchedTest(duration_s=40)
        self.addCleanup(test.close)
        test.wait_until_it_moves()
        self.assertEqual(test.token, "")
        for headers in ({}, {"Authorization": "Bearer "}, {"Authorization": "Bearer 0"}):
            self.assertEqual(test.control("emergency_stop", headers), 403)
        self.assertFalse(test.get("api/tests")["control"])
        self.assertEqual(test.phase(), "running")


if __name__ == "__main__":
    unittest.main()
