"""A test in real processes, `hybridtest watch` beside it, and its recordings."""

import itertools
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import urllib.error
import urllib.request

import h5py
from browser import wait_for

PROGRAMS = pathlib.Path(os.environ["HYBRIDTEST_PROGRAM_DIR"])
SOURCES = pathlib.Path(os.environ["HYBRIDTEST_SOURCE_DIR"])
SCENARIO = SOURCES / "launch" / "scenarios" / "two_storey_one_site.yaml"

# At the pace of real time, in steps that a busy machine keeps.
PACED = ("time.mode=paced", "time.time_scale=1", "time.step_s=0.01")

_drawn = itertools.count()


class WatchedTest:
    """Starts a test and a server that watches it; close() ends both and removes their files.

    Without a duration there is a server alone.
    """

    def __init__(self, duration_s, allow_control=False, watch_run=False, settings=()):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="hybridtest_web_"))
        self.name = f"web.{os.getpid()}.{next(_drawn)}"
        # Domains whose ports lie below those that Linux hands out, other ones than those of the tests in C++.
        self.network = ["--domain", str(101 + os.getpid() % 20)]
        self.run_folder = self.folder / "run"
        self.processes = []
        control = ["--allow-control"] if allow_control else []
        # A server that knows the run directory links the report.
        known = ["--out", str(self.run_folder)] if watch_run else []
        self.server = self.start("watch", ["watch", self.name, *control, *known, *self.network])
        self.address = wait_for(self.printed_address, "the address that hybridtest watch prints")
        if duration_s is None:
            return
        values = (f"name={self.name}", f"time.duration_s={duration_s}", *PACED, *settings)
        self.run = self.start("run", ["run", str(SCENARIO), "--out", str(self.run_folder), *self.network,
                                      *(word for value in values for word in ("--set", value))])

    def start(self, name, arguments):
        with open(self.folder / f"{name}.out", "w", encoding="utf-8") as output:
            process = subprocess.Popen([PROGRAMS / "hybridtest", *arguments], stdout=output, stderr=subprocess.STDOUT,
                                       cwd=self.folder)
        self.processes.append(process)
        return process

    def printed(self, name):
        return (self.folder / f"{name}.out").read_text(encoding="utf-8")

    def printed_address(self):
        found = re.search(r"http://\S+", self.printed("watch"))
        return found.group(0) if found else None

    @property
    def origin(self):
        return self.address.split("/#")[0].rstrip("/")

    @property
    def token(self):
        return self.address.partition("#token=")[2]

    def get(self, path):
        with urllib.request.urlopen(f"{self.origin}/{path}", timeout=10) as answer:
            return json.load(answer)

    def news(self):
        return self.get(f"api/tests/{self.name}?since=0")

    def phase(self):
        return self.news()["test"]["phase"]

    def control(self, verb, headers):
        """Status of a control request with these headers."""
        request = urllib.request.Request(f"{self.origin}/api/tests/{self.name}/control", method="POST",
                                         data=json.dumps({"verb": verb}).encode(),
                                         headers={"Content-Type": "application/json", **headers})
        try:
            with urllib.request.urlopen(request, timeout=10) as answer:
                return answer.status
        except urllib.error.HTTPError as error:
            return error.code

    def wait_until_it_moves(self):
        wait_for(lambda: (self.news()["test"]["model_time_s"] or 0.0) > 1.0, "the first second of the test")

    def summary(self):
        """Waits for the end of the run."""
        self.run.wait(timeout=60)
        return json.loads((self.run_folder / "summary.json").read_text(encoding="utf-8"))

    def rows(self, participant, table):
        """The columns of a recorded table by their names, also while it is being written."""
        with h5py.File(self.run_folder / f"{participant}.h5", "r", libver="latest", swmr=True) as file:
            rows = file[table][:]
            return {name: rows[name] for name in rows.dtype.names}

    def process_id_of(self, participant):
        """Of a process that the run started."""
        found = subprocess.run(["ps", "-o", "pid=,args=", "--ppid", str(self.run.pid)], capture_output=True, text=True,
                               check=True).stdout
        return next(int(line.split()[0]) for line in found.splitlines() if f"--id {participant}" in line)

    def close(self):
        for process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for process in self.processes:
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)
