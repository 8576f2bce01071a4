#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The page that `make web` writes, in a headless Chromium. Cases run in it and end with the native
hash. The picture has colours. A wrong case is refused with the program's sentence, and its line is
marked. Exit 77: not by `make test-web`, or no browser or no page."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, ROOT, packages
import chromium
with packages():
    import numpy as np
    from PIL import Image

PAGE = ROOT / "build" / "web" / "index.html"
CASES = ("channel", "ringing_bar", "vortices", "rotating_patch", "templates/thin_plate",
         "templates/flap")
DONE = "['finished', 'refused', 'stopped'].includes(document.body.dataset.state)"
WRONG = """dp = 1 cm
end_time = 1
[fluid water]
shape = box 0, 0, 0.1, 0.1
sound_sped = 20
"""


def state(page):
    return page.run("document.body.dataset.state")


def click(page, name):
    page.run(f"document.getElementById('{name}').click()")


def choose(page, case):
    page.run(f"choose('{case}')")
    page.wait("document.body.dataset.state === 'built'")


def native_of(page):
    return page.run("state.chosen.hash")


def check_case(page, case):
    choose(page, case)
    click(page, "run")
    page.wait(DONE, 300)
    assert state(page) == "finished", page.run("document.getElementById('problems').textContent")
    here, native = page.run("document.body.dataset.hash"), native_of(page)
    assert here == native and len(here) == 16, \
        f"{case}: {here} in the page, {native} of the native program"
    assert "the same bits" in page.run("document.getElementById('verdict').textContent")
    print(f"{case}: {here}, {page.run('document.body.dataset.seconds')} s")


def check_software_build(page):
    """The build that computes multiply-add in software, forced on the page, has the bits as
    well."""
    page.run("worker.postMessage({what: 'load', fused: DATA.programs.exact, exact: "
             "DATA.programs.exact})")
    page.wait("document.querySelectorAll('footer')[0].textContent.split('Multiply-add').length === "
              "3")
    check_case(page, "channel")


def check_beam(page):
    """A plate 4 mm thick from (1.1, 0) to (1.1, 0.3) m is as thick in the picture."""
    choose(page, "templates/thin_plate")
    page.wait("state.spacing.fluid")
    box = page.run("""(() => {
        const corners = split_beams(state.frame.wall, 1e-3, 4 * state.spacing.fluid)[1].flat();
        const ends = c => [Math.min, Math.max].map(end => end(...corners.map(at => at[c])));
        return [...ends(0), ...ends(1)];
    })()""")
    assert np.allclose(box, [1.098, 1.102, 0, 0.3], atol=1e-4), box


def check_moving_view(page):
    """The picture follows a tank that leaves it: coloured pixels are there at the end."""
    choose(page, "accelerated_tank")
    before = page.run("state.view.x")
    click(page, "run")
    page.wait(DONE, 300)
    page.wait("state.view.x > 2 + %r" % before, 20)  # m; the tank goes 2.76 m


def check_pause_and_step(page):
    choose(page, "vortices")
    click(page, "step")
    page.wait("state.frame && state.frame.steps === 1")
    click(page, "run")
    page.wait("state.frame && state.frame.steps > 3 && state.running")
    click(page, "pause")
    page.wait("document.body.dataset.state === 'paused'")
    time.sleep(0.3)
    steps = page.run("state.frame.steps")
    time.sleep(0.5)
    assert page.run("state.frame.steps") == steps and state(page) == "paused"
    click(page, "pause")
    page.wait(DONE, 300)
    assert page.run("document.body.dataset.hash") == native_of(page), "the bits after a pause"


def check_slider(page):
    choose(page, "channel")
    before = page.run("state.frame.end")
    page.run("""(() => {
        const slider = document.querySelector("#sliders input");
        slider.value = -1;
        slider.dispatchEvent(new Event("input"));
        slider.dispatchEvent(new Event("change", { bubbles: true }));
    })()""")
    page.wait("sets().length === 1 && document.body.dataset.state === 'built' && state.frame")
    name = page.run("sets()[0]")
    assert name.startswith("end_time=0.5") and page.run("state.frame.end") == 0.5 * before, name


def check_refusal(page, folder):
    page.run(f"""(() => {{
        const text = document.getElementById("text");
        text.value = {WRONG!r};
        text.dispatchEvent(new Event("change"));
    }})()""")
    page.wait("document.body.dataset.state === 'refused'")
    said = page.run("document.querySelector('#problems li').textContent")
    (folder / "gate.cfg").write_text(WRONG)
    native = subprocess.run([PROGRAM, "gate.cfg"], cwd=folder, capture_output=True,
                            text=True).stderr
    assert said in native and "sound_speed" in said, f"{said} is not in: {native}"
    assert page.run("document.querySelector('#lines .wrong').textContent") == "5"
    # Without a simulation there is nothing to draw in another colour.
    page.run("document.getElementById('fluid').dispatchEvent(new Event('change'))")
    page.screenshot(folder / "refused.png")


def check_picture(page, folder):
    """Red of the stress and blue to yellow of the water, not just grey and white."""
    choose(page, "gate")
    click(page, "run")
    page.wait("state.frame && state.frame.steps > 40", 300)
    click(page, "pause")
    page.wait("document.body.dataset.state === 'paused'")
    time.sleep(0.5)
    page.screenshot(folder / "page.png")
    kept = os.environ.get("PICTURE")
    if kept:
        page.screenshot(Path(kept))
    box = page.run("(r => [r.left, r.top, r.right, r.bottom])(scene.getBoundingClientRect())")
    scene = np.asarray(Image.open(folder / "page.png").convert("RGB").crop(box), float)
    spread = scene.max(axis=2) - scene.min(axis=2)
    coloured = scene[spread > 40]
    assert len(coloured) > 0.05 * spread.size, \
        f"{len(coloured)} of {spread.size} pixels have a colour"
    assert len({tuple(c) for c in (coloured // 32).tolist()}) > 8, "the water has one colour only"


def main():
    if not os.environ.get("WEB"):
        print("`make test-web` builds the page and runs this")
        return 77
    if not PAGE.is_file():
        print(f"there is no {PAGE.relative_to(ROOT)}: no compiler for WebAssembly")
        return 77
    if not chromium.program():
        print("chromium is missing")
        return 77
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = Path(name)
        with chromium.Browser(folder) as page:
            page.open(f"file://{PAGE}")
            page.wait("document.body.dataset.state === 'built'")
            print("multiply-add:", page.run("document.body.dataset.multiply_add"))
            for case in CASES:
                check_case(page, case)
            check_beam(page)
            check_moving_view(page)
            check_pause_and_step(page)
            check_slider(page)
            check_picture(page, folder)
            check_refusal(page, folder)
            check_software_build(page)
            assert not page.said, page.said
    return 0


if __name__ == "__main__":
    sys.exit(main())
