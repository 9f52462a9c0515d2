"""A headless Chromium for one test class, and when its tests are skipped."""

import importlib.util
import os
import pathlib
import shutil
import tempfile
import time
import unittest

CHROMIUM = "/usr/bin/chromium"
DRIVER = "/usr/bin/chromedriver"
IS_REQUIRED = os.environ.get("HYBRIDTEST_REQUIRE_DATA") == "1"

# As root, on a machine without a graphics processor, without any request of the browser's own.
FLAGS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         # Containers have little shared memory, and the participants of the tests keep theirs there.
         "--disable-dev-shm-usage",
         # Each window is a person who looks, though they cover each other.
         "--disable-backgrounding-occluded-windows", "--disable-renderer-backgrounding", "--hide-scrollbars")


def missing():
    """What the tests need and this machine lacks, as Debian packages."""
    programs = {"chromium": CHROMIUM, "chromium-driver": DRIVER}
    modules = {"python3-selenium": "selenium", "python3-h5py": "h5py"}
    return ([package for package, path in programs.items() if not pathlib.Path(path).exists()]
            + [package for package, name in modules.items() if importlib.util.find_spec(name) is None])


def skip_or_fail(message):
    """Fails with HYBRIDTEST_REQUIRE_DATA=1, skips otherwise."""
    if IS_REQUIRED:
        raise AssertionError(f"required (HYBRIDTEST_REQUIRE_DATA=1) and absent: {message}")
    raise unittest.SkipTest(message)


def open_browser():
    """A new browser with a profile of its own; close_browser() ends it."""
    absent = missing()
    if absent:
        skip_or_fail("pages are not tested; install " + " ".join(absent))
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    profile = tempfile.mkdtemp(prefix="hybridtest_web_")
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(options=options, service=Service(DRIVER))
    browser.profile_folder = profile
    browser.set_script_timeout(60)
    return browser


def close_browser(browser):
    browser.quit()
    shutil.rmtree(browser.profile_folder, ignore_errors=True)


def set_window(browser, width, height=None, is_dark=False):
    """Sets the size of the page [CSS pixels]; a narrow one is a telephone."""
    is_telephone = width < 500
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": height or (844 if is_telephone else 1000), "deviceScaleFactor": 1,
        "mobile": is_telephone})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
        "features": [{"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}]})


def wait_for(condition, what, patience_s=60.0):
    """What `condition` returns as soon as that is true."""
    end = time.monotonic() + patience_s
    while True:
        answer = condition()
        if answer:
            return answer
        if time.monotonic() > end:
            raise AssertionError(f"waited {patience_s} s in vain for {what}")
        time.sleep(0.05)
