#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The line that tells how far a run is: on a terminal it is written over, in a file there is one
for each tenth of the run, and its numbers agree with each other."""
import os
import pty
import re
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

SPHFSI = os.environ.get("SPHFSI", "./sphfsi")
STILL = "tests/fault/still.cfg"
LINE = re.compile(r"([ \d.]{5}) %  t (\S+) s  dt (\S+) s \((\w+)\)  (\S+) M particle steps/s  "
                  r"(\?|\d+:\d\d|[\d.]+ h) left")
ENV = {**os.environ, "OMP_NUM_THREADS": "1"}


def on_a_terminal(out, until, lines):
    """What a terminal gets of a run that is interrupted after so many lines."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen([SPHFSI, STILL, "--out", out, "--until", until, "--set",
                                "dp=2.5 mm"], stderr=theirs, env=ENV,
                               stdout=subprocess.DEVNULL)
    os.close(theirs)
    said = b""
    try:
        while piece := os.read(ours, 4096):
            if said.count(b"\r") < lines <= (said + piece).count(b"\r"):
                process.send_signal(signal.SIGINT)
            said += piece
    except OSError:  # the other end is closed
        pass
    assert process.wait() == 130, process.returncode
    return said.decode().replace("\r\n", "\n")


def check_terminal(folder):
    end = 1e4
    said = on_a_terminal(str(folder / "long"), f"{end:g}", 6)
    parts = said.split("\r")
    # The last of these clears the line for what the program says at the end.
    assert parts[-1].startswith("\033[K") and "stopped by signal 2" in parts[-1], parts[-1]
    rows = [LINE.fullmatch(part.removesuffix("\033[K")) for part in parts[1:-1]]
    assert len(rows) > 3 and all(rows), said
    assert all(part.endswith("\033[K") for part in parts[1:-1]), said
    times = [float(row[2]) for row in rows]
    assert times == sorted(times) and times[-1] > times[0]
    last = rows[-1]
    assert abs(float(last[1]) - 100 * times[-1] / end) < 0.0501, last[0]
    assert last[4] == "acoustic", last[4]
    # 1600 particles; so many steps to come at this rate.
    hours = (end - times[-1]) / float(last[3]) * 1600 / (1e6 * float(last[5])) / 3600
    assert last[6].endswith(" h"), last[0]
    assert 0.5 * hours < float(last[6].removesuffix(" h")) < 2 * hours, (last[0], hours)
    assert "\n" not in said[:said.rindex("\r")], "the line is not written over"


def check_file(folder):
    """A run that lasts some seconds, to a file: a line when a tenth is over, no more."""
    until = 6.0
    with open(folder / "said", "w+") as file:
        subprocess.run([SPHFSI, STILL, "--out", str(folder / "short"), "--until", f"{until:g}"],
                       stderr=file,
                       stdout=subprocess.DEVNULL, env=ENV, check=True)
        file.seek(0)
        said = file.read()
    assert "\r" not in said and "\033" not in said, said
    rows = [LINE.fullmatch(line) for line in said.splitlines()]
    assert all(rows), said
    tenths = [int(10 * float(row[2]) / until) for row in rows]
    assert tenths == sorted(set(tenths)) and 0 not in tenths and 10 not in tenths, said
    for row in rows:
        assert abs(float(row[1]) - 100 * float(row[2]) / until) < 0.0501, row[0]
        assert row[6] == "?" or ":" in row[6], row[0]
    return len(rows)


def main():
    with tempfile.TemporaryDirectory() as top:
        check_terminal(Path(top))
        rows = check_file(Path(top))
        print(f"{rows} lines in a file")
    return 0


if __name__ == "__main__":
    sys.exit(main())
