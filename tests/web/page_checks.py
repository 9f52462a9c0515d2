"""What every page of this project must keep, whatever is on it."""

import base64
import functools
import hashlib
import os
import pathlib
import shutil
import subprocess
import tarfile
import tempfile
import unittest

from browser import set_window

WIDTHS = (1600, 1024, 390)
AXE = "axe-core@4.14.1"
AXE_SHA512 = "FHfa+lmNjQZfJz1q8wKqIDwC6DExcHt/pkjNQb09a3NPjCKg2rhu5qb2S4r76ASyFNNtuFooJpZe37OgudVGtQ=="

# Each finding is a line of text.
LAYOUT = r"""
const findings = [];
const name = (e) => `${e.tagName.toLowerCase()}${e.id ? "#" + e.id : ""}${typeof e.className === "string" && e.className
  ? "." + e.className.trim().replaceAll(/\s+/g, ".") : ""} "${(e.textContent ?? "").trim().slice(0, 30)}"`;
const style = (e) => getComputedStyle(e);
const is_shown = (e) => e.checkVisibility({ visibilityProperty: true, opacityProperty: true }) && e.getClientRects().length > 0;
// For screen readers alone.
const is_unseen = (e) => e.closest(".unseen") !== null;
const scrolls = (e) => /auto|scroll/.test(style(e).overflowX);
const in_scrolling_box = (e) => { for (e = e.parentElement; e; e = e.parentElement) if (scrolls(e)) return true; return false; };
const all = [...document.body.querySelectorAll("*")].filter((e) => is_shown(e) && !is_unseen(e));

const width = document.documentElement.clientWidth;
if (document.documentElement.scrollWidth > width) findings.push(`the page is ${document.documentElement.scrollWidth} px wide, the window ${width}`);
for (const e of all) {
  const box = e.getBoundingClientRect();
  if ((box.right > width + 1 || box.left < -1) && !in_scrolling_box(e)) findings.push(`${name(e)} reaches from ${box.left} to ${box.right}, the window to ${width}`);
}

// Neighbours in the flow do not lie on each other.
const groups = new Set(all.map((e) => e.parentElement));
for (const group of groups) {
  if (group.closest("svg, pre, [data-overlaps]")) continue;
  const children = [...group.children].filter((e) => is_shown(e) && !is_unseen(e) && /static|relative/.test(style(e).position)
    && style(e).display !== "inline" && e.tagName !== "OPTION");
  for (let i = 0; i < children.length; ++i) {
    const a = children[i].getBoundingClientRect();
    for (let j = i + 1; j < children.length && j < i + 40; ++j) {
      const b = children[j].getBoundingClientRect();
      const overlap = Math.min(Math.min(a.right, b.right) - Math.max(a.left, b.left), Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
      if (overlap > 1) findings.push(`${name(children[i])} and ${name(children[j])} overlap by ${overlap.toFixed(1)} px`);
    }
  }
}

// Text that a box cuts off.
for (const e of all) {
  if (e.closest("svg") || scrolls(e) || e.tagName === "SELECT" || e.tagName === "CANVAS") continue;
  const cuts = /hidden|clip/.test(style(e).overflowX);
  const has_text = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
  if ((cuts || has_text) && style(e).display !== "inline" && e.scrollWidth > e.clientWidth + 1) findings.push(`${name(e)} is cut off: ${e.scrollWidth} px in ${e.clientWidth}`);
}

// Labels in figures stay inside, and apart from each other along a line.
for (const figure of document.querySelectorAll("svg.figure")) {
  if (!is_shown(figure)) continue;
  const frame = figure.getBoundingClientRect();
  for (const text of figure.querySelectorAll("text")) {
    if (!is_shown(text)) continue;
    const box = text.getBoundingClientRect();
    if (box.left < frame.left - 1 || box.right > frame.right + 1) findings.push(`${name(text)} leaves its figure`);
  }
  if (figure.querySelectorAll("path, polyline, line, rect, circle").length < 3) findings.push(`${name(figure)} is empty`);
}

// Canvases have a curve: pixels that are neither empty nor grey.
let drawn = 0;
for (const canvas of document.querySelectorAll("canvas")) {
  if (!is_shown(canvas)) continue;
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let pixels = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 60) ++pixels;
  if (pixels < 300) findings.push(`${canvas.getAttribute("aria-label")} has ${pixels} pixels drawn`); else ++drawn;
}
return { findings: [...new Set(findings)], drawn };
"""

AXE_RUN = """
const done = arguments[arguments.length - 1];
axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"] }).then((result) => done(
  result.violations.filter(({ impact }) => impact === "serious" || impact === "critical").flatMap(({ id, help, nodes }) =>
    nodes.map((node) => `${id}: ${help}: ${node.html.slice(0, 160)} ${node.failureSummary.slice(0, 200)}`))),
  (error) => done([String(error)]));
"""


def output_folder():
    """Where screenshots are left to look at."""
    folder = pathlib.Path(os.environ.get("HYBRIDTEST_WEB_OUTPUT") or tempfile.gettempdir()) / "screenshots"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@functools.lru_cache(maxsize=1)
def axe_archive():
    """The package of axe-core from npm, kept beside the screenshots, and why it is not there."""
    archive = output_folder().parent / f"{AXE.replace('@', '-')}.tgz"
    if archive.exists():
        return archive, ""
    if shutil.which("npm") is None:
        return archive, "npm is not installed"
    fetched = subprocess.run(["npm", "pack", AXE, "--silent", "--fetch-retries=2", "--fetch-timeout=20000"],
                             cwd=archive.parent, capture_output=True, text=True, check=False)
    return archive, fetched.stderr.strip() if fetched.returncode != 0 else ""


def axe_source():
    """The text of axe-core; its digest is checked each time. Without a way to npm what needs it is skipped."""
    archive, why_not = axe_archive()
    if why_not:
        raise unittest.SkipTest(f"{AXE} could not be fetched: {why_not}")
    digest = base64.b64encode(hashlib.sha512(archive.read_bytes()).digest()).decode()
    if digest != AXE_SHA512:
        archive.unlink()
        raise AssertionError(f"{AXE}: SHA-512 {digest}, expected {AXE_SHA512}")
    with tarfile.open(archive) as content:
        return content.extractfile("package/axe.min.js").read().decode()


def layout_findings(browser):
    """Lines that say what is wrong with the page as it stands, and the number of canvases with a curve."""
    answer = browser.execute_script(LAYOUT)
    return answer["findings"], answer["drawn"]


def axe_findings(browser):
    """Serious and critical findings of axe-core."""
    browser.execute_script(axe_source())
    return browser.execute_async_script(AXE_RUN)


def errors_in(browser):
    """What the page logged as an error since the last call."""
    return [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]


def check_page(test, browser, name, ready, whole_height=True):
    """Checks the open page at all widths, light and dark, and leaves screenshots.

    @param test    a unittest.TestCase.
    @param name    of the screenshots.
    @param ready   called at each width; returns when the page is drawn.
    """
    for width in WIDTHS:
        for is_dark in (False, True):
            set_window(browser, width, is_dark=is_dark)
            if whole_height:
                height = min(12000, browser.execute_script("return document.documentElement.scrollHeight"))
                set_window(browser, width, height, is_dark)
            ready()
            label = f"{name}_{width}{'_dark' if is_dark else ''}"
            browser.save_screenshot(str(output_folder() / f"{label}.png"))
            with test.subTest(page=label, check="layout"):
                test.assertEqual(layout_findings(browser)[0], [])
            # The window as people have it: what is sticky or fixed lies elsewhere on a page of its whole height.
            set_window(browser, width, is_dark=is_dark)
            if width != 1024:
                with test.subTest(page=label, check="axe-core"):
                    test.assertEqual(axe_findings(browser), [])
    with test.subTest(page=name, check="errors in the page"):
        test.assertEqual(errors_in(browser), [])
