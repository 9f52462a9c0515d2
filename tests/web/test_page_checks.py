"""Controls: each check of page_checks.py finds the defect that it is for, and passes a sound page."""

import unittest
import urllib.parse

from browser import close_browser, missing, open_browser, set_window, skip_or_fail

if missing():
    skip_or_fail("pages are not tested; install " + " ".join(missing()))

from page_checks import axe_findings, errors_in, layout_findings

SOUND = "<h1>Sound</h1><p>Text that breaks where the line ends.</p>"
FIGURE = '<svg class="figure" width="200" height="99"><path d="M0 0"/><line/><line/><text x="{x}" y="20">label</text></svg>'
CURVE = ("<canvas width=200 height=99 aria-label=curve></canvas><script>const pen = document.querySelector('canvas')"
         ".getContext('2d'); {draw}</script>")


class PageChecks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = open_browser()
        cls.addClassCleanup(close_browser, cls.browser)
        set_window(cls.browser, 390)

    def open(self, body):
        page = ('<!DOCTYPE html><html lang="en"><title>t</title><meta name="viewport" content="width=device-width">'
                f'<link rel="icon" href="data:,"><main>{body}</main></html>')
        self.browser.get("data:text/html;charset=utf-8," + urllib.parse.quote(page))

    def layout_of(self, body):
        self.open(body)
        return "\n".join(layout_findings(self.browser)[0])

    def test_sound_pages_pass(self):
        self.assertEqual(self.layout_of(SOUND), "")
        self.assertEqual(self.layout_of(FIGURE.format(x=10)), "")
        self.assertEqual(self.layout_of(CURVE.replace("{draw}", "pen.fillRect(0, 0, 99, 9)")), "")
        self.open(SOUND)
        self.assertEqual(axe_findings(self.browser), [])
        self.assertEqual(errors_in(self.browser), [])

    def test_layout_defects_are_found(self):
        self.assertIn("the window to 390", self.layout_of("<div style='width: 700px'>wide</div>"))
        self.assertIn("overlap by", self.layout_of("<p>one</p><p style='margin-top: -30px'>two</p>"))
        self.assertIn("is cut off", self.layout_of("<p style='width: 40px; overflow: hidden; white-space: nowrap'>long label</p>"))
        self.assertIn("is cut off", self.layout_of("<p style='width: 40px'>Displacement</p>"))

    def test_empty_figures_are_found(self):
        self.assertIn("has 0 pixels drawn", self.layout_of(CURVE.replace("{draw}", "")))
        self.assertIn("is empty", self.layout_of("<svg class='figure' width='99' height='99'></svg>"))
        self.assertIn("leaves its figure", self.layout_of(FIGURE.format(x=190)))

    def test_barriers_and_errors_are_found(self):
        self.open("<h1>t</h1><img src='data:,'><p style='color: #bbb; background: #fff'>pale</p>")
        findings = "\n".join(axe_findings(self.browser))
        self.assertIn("image-alt", findings)
        self.assertIn("color-contrast", findings)
        self.open("<script>throw new Error('broken')</script>")
        self.assertIn("broken", "\n".join(errors_in(self.browser)))


if __name__ == "__main__":
    unittest.main()
