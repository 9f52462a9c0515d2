#!/usr/bin/env python3
"""Cost of drawing 16 live signals with a chart library, in a headless Chromium, at 20 updates a second.

Prints for each library the time of one update in the script (median, 99th percentile), the processor time of the whole
browser for one update (rasterisation included) and the updates a second that were reached; then the ratio of the processor
time to that of `canvas`, which draws every point on bare canvases. `idle` makes the data and draws nothing; its time is taken
off in the ratios. `painter` is that of the live page.

Needs chromium, chromium-driver, python3-selenium, libjs-dygraphs, libjs-chart.js; npm fetches uPlot.
"""

import argparse
import functools
import http.server
import pathlib
import shutil
import statistics
import subprocess
import tempfile
import threading

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

HERE = pathlib.Path(__file__).parent
LIVE_PAGE = HERE.parent.parent / "report" / "live" / "page"
DEBIAN = pathlib.Path("/usr/share/javascript")
UPLOT = "uplot@1.6.32"


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *arguments):
        pass


def fetch_uplot(folder):
    subprocess.run(["npm", "pack", UPLOT, "--silent"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["tar", "xzf", next(folder.glob("uplot-*.tgz")).name], cwd=folder, check=True)
    return folder / "package" / "dist"


def children(pid):
    found = [pid]
    for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            found += children(int(child))
    return found


def processor_s(pid):
    """Processor time that a process and its descendants have used, s."""
    ticks = 0
    for process in children(pid):
        try:
            fields = pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
            ticks += int(fields[11]) + int(fields[12])
        except (FileNotFoundError, ProcessLookupError):  # ended meanwhile
            pass
    return ticks / 100.0


def measure(library, script, style, updates):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for file in (HERE / "page.html", HERE / "draw.js", *LIVE_PAGE.glob("*.js")):
            shutil.copy(file, folder)
        (folder / "library.js").write_text(script.read_text() if script else "")
        (folder / "library.css").write_text(style.read_text() if style else "")
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for flag in ("--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--window-size=1600,1000",
                     "--disable-background-networking", f"--user-data-dir={folder / 'profile'}"):
            options.add_argument(flag)
        # Modules are not loaded from files.
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        service = Service("/usr/bin/chromedriver")
        browser = webdriver.Chrome(options=options, service=service)
        try:
            browser.set_script_timeout(600)
            browser.get(f"http://127.0.0.1:{server.server_port}/page.html")
            before_s = processor_s(service.process.pid)
            times = browser.execute_async_script("measure(arguments[0], arguments[1], arguments[2])", library, updates)
            return times, processor_s(service.process.pid) - before_s
        finally:
            browser.quit()
            server.shutdown()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--updates", type=int, default=300)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        uplot = fetch_uplot(pathlib.Path(name))
        dygraphs = DEBIAN / "dygraphs"
        libraries = {
            "idle": (None, None),
            "canvas": (None, None),
            "painter": (None, None),
            "dygraphs": (dygraphs / "dygraph.min.js", dygraphs / "dygraph.min.css"),
            "chart_js": (DEBIAN / "chart.js" / "chart.min.js", None),
            "uplot": (uplot / "uPlot.iife.min.js", uplot / "uPlot.min.css"),
        }
        print(f"{'library':10} {'script p50':>10} {'p99':>8} {'processor':>10} {'updates/s':>10} {'over canvas':>12}")
        canvas_s = None
        idle_s = None
        for library, (script, style) in libraries.items():
            times, used_s = measure(library, script, style, arguments.updates)
            per_update_s = used_s / arguments.updates
            if idle_s is None:
                idle_s = per_update_s
            elif canvas_s is None:
                canvas_s = per_update_s
            drawing_s = per_update_s - idle_s
            ratio = "" if canvas_s is None else f"{drawing_s / (canvas_s - idle_s):12.2f}"
            script_ms = sorted(times["script_ms"])
            rate = 1000.0 / statistics.mean(times["between_ms"])
            print(f"{library:10} {script_ms[len(script_ms) // 2]:7.2f} ms {script_ms[len(script_ms) * 99 // 100]:5.1f} ms "
                  f"{per_update_s * 1e3:7.1f} ms {rate:10.1f} {ratio}", flush=True)


if __name__ == "__main__":
    main()
