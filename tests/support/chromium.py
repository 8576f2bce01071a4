# SPDX-License-Identifier: MIT
"""A headless Chromium, driven by its DevTools protocol through two pipes; Python's own library is
enough."""

import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import time

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--allow-file-access-from-files", "--remote-debugging-pipe", "--window-size=1280,900"]


def program():
    """The browser of this machine, or None."""
    names = ("chromium", "chromium-browser", "google-chrome")
    return next((path for path in map(shutil.which, names) if path), None)


class Failed(Exception):
    """The page or the browser has not done what was asked."""


class Browser:
    """One page of a browser with a fresh profile in `folder`."""

    def __init__(self, folder):
        to_read, self.to = os.pipe()
        self.of, to_write = os.pipe()
        # The protocol is spoken on the descriptors 3 and 4, which the pipes may have themselves.
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_read, to_write)]

        def place():
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.log = open(folder / "chromium.log", "wb")
        profile = f"--user-data-dir={folder / 'profile'}"
        self.process = subprocess.Popen([program(), *FLAGS, profile, "about:blank"],
                                        stdin=subprocess.DEVNULL,
                                        stdout=self.log, stderr=self.log, preexec_fn=place,
                                        pass_fds=(3, 4))
        for end in (to_read, to_write, *ends):
            os.close(end)
        self.number, self.rest, self.session, self.said = 0, b"", None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target,
                                 flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.to)
        os.close(self.of)
        self.log.close()

    def _message(self, until):
        while b"\0" not in self.rest:
            if not select.select([self.of], [], [], max(0, until - time.monotonic()))[0]:
                raise Failed("the browser does not answer")
            more = os.read(self.of, 1 << 20)
            if not more:
                raise Failed("the browser has ended; its output is in chromium.log")
            self.rest += more
        text, self.rest = self.rest.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, seconds=120, **params):
        """The result of a command of the protocol. Errors of the page gather in `said`."""
        self.number += 1
        command = {"id": self.number, "method": method, "params": params}
        if self.session:
            command["sessionId"] = self.session
        os.write(self.to, json.dumps(command).encode() + b"\0")
        until = time.monotonic() + seconds
        while True:
            answer = self._message(until)
            if answer.get("method") == "Runtime.exceptionThrown":
                self.said.append(answer["params"]["exceptionDetails"])
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise Failed(f"{method}: {answer['error']['message']}")
                return answer["result"]

    def run(self, script):
        """The value of an expression in the page."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True,
                           awaitPromise=True)
        if "exceptionDetails" in answer:
            raise Failed(f"{script}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def wait(self, script, seconds=120):
        """Waits until an expression is true."""
        until = time.monotonic() + seconds
        while not self.run(script):
            if time.monotonic() > until:
                raise Failed(f"{seconds} s have passed and not: {script}; {self.said}")
            time.sleep(0.1)

    def open(self, address):
        self.call("Page.navigate", url=address)
        self.wait("document.readyState === 'complete'")

    def screenshot(self, path):
        """Writes a PNG of what the window shows."""
        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot")["data"]))

    def mouse(self, what, x, y, **more):
        """`what`: mousePressed, mouseReleased, mouseMoved or mouseWheel, at pixels of the
        window."""
        self.call("Input.dispatchMouseEvent", type=what, x=x, y=y,
                  **{"button": "left", "clickCount": 1, "buttons": 1, **more})

    def drag(self, start, end):
        self.mouse("mousePressed", *start)
        for k in (1, 2, 3):
            self.mouse("mouseMoved", *(a + (b - a) * k / 3 for a, b in zip(start, end)))
        self.mouse("mouseReleased", *end)
