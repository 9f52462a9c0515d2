"""How pages look that programs write: reports of all kinds of runs, the list of runs, a diagnosis, a sweep."""

import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

from browser import close_browser, missing, open_browser, skip_or_fail, wait_for

if missing():
    skip_or_fail("pages are not tested; install " + " ".join(missing()))

from page_checks import check_page
from watched_test import PROGRAMS, SCENARIO, WatchedTest

SHIPPED = ("two_storey_one_site", "two_storey_two_sites", "three_storey_base_isolated", "isolated_with_dampers")


class WrittenPages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = open_browser()
        cls.addClassCleanup(close_browser, cls.browser)
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="hybridtest_web_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    def simulate(self, name, exit_code, *settings):
        """The report of a simulated run of a shipped scenario."""
        run = self.folder / self.id().rpartition(".")[2] / name
        self.hybridtest(exit_code, "simulate", SCENARIO.with_stem(name), "--seed", "1", "--out", run,
                        *(word for value in settings for word in ("--set", value)))
        return run / "report.html"

    def hybridtest(self, exit_code, *words):
        done = subprocess.run([PROGRAMS / "hybridtest", *words], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, exit_code, done.stderr)

    def check(self, file, name):
        self.browser.get(file.as_uri())
        check_page(self, self.browser, name, lambda: None)

    def test_reports_of_shipped_scenarios(self):
        for name in SHIPPED:
            with self.subTest(scenario=name):
                self.check(self.simulate(name, 0, "time.duration_s=5"), f"report_{name}")

    def test_report_of_an_interlocked_test(self):
        report = self.simulate("two_storey_one_site", 3, "time.duration_s=8", "substructures[storey_1].limits.displacement_m=0.03")
        self.check(report, "report_interlocked")

    def test_comparison_and_diagnosis(self):
        run = self.simulate("two_storey_one_site", 0, "time.duration_s=8").parent
        other = self.simulate("two_storey_two_sites", 0, "time.duration_s=8").parent
        self.hybridtest(0, "report", run, "--compare", other, "--out", self.folder / "compared.html")
        self.check(self.folder / "compared.html", "report_compared")
        self.hybridtest(0, "diagnose", "--model", SCENARIO, "--recording", run, "--out", self.folder / "diagnosis")
        self.check(self.folder / "diagnosis" / "diagnosis.html", "diagnosis")

    def test_index_of_runs(self):
        runs = self.simulate("two_storey_one_site", 0, "time.duration_s=2").parent.parent
        self.simulate("two_storey_two_sites", 3, "time.duration_s=8",
                      "substructures[first_storey_columns].limits.displacement_m=0.03")
        broken = runs / "broken"
        broken.mkdir()
        (broken / "summary.json").write_text("{")
        self.hybridtest(0, "runs", runs, "--page")
        self.check(runs / "index.html", "runs")
        links = [link.get_attribute("href") for link in self.browser.find_elements("tag name", "a")]
        self.assertEqual(len([link for link in links if link.endswith("/report.html")]), 2, links)

    def test_sweep(self):
        folder = self.folder / "sweep"
        self.hybridtest(0, "sweep", SCENARIO, "--vary", "excitation.scale=0.5,1", "--seeds", "1..2", "--set", "time.duration_s=4",
                        "--out", folder)
        self.check(folder / "index.html", "sweep")

    def test_lost_participant_and_link_from_the_live_page(self):
        test = WatchedTest(duration_s=60, watch_run=True)
        self.addCleanup(test.close)
        test.wait_until_it_moves()
        os.kill(test.process_id_of("storey_1"), signal.SIGKILL)
        self.assertFalse(test.summary()["data_valid"])
        self.browser.get(test.address)
        link = wait_for(lambda: [link for link in self.browser.find_elements("id", "report_link") if link.is_displayed()],
                        "the link to the report")[0]
        link.click()
        wait_for(lambda: "participant was lost" in self.browser.page_source, "the report")
        self.assertEqual(self.browser.current_url, f"{test.origin}/report")
        self.check(test.run_folder / "report.html", "report_data_invalid")


if __name__ == "__main__":
    unittest.main()
