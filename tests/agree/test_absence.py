#!/usr/bin/env python3
"""An effect that a scene does not name costs nothing: instructions and bytes of scenes without it are
those of a program that it is compiled out of, to 1 %; the state is the same to the bit.

Instructions are counted by valgrind, those of LONG steps less those of SHORT ones, so that reading the
case and opening files do not hide anything; bytes are those of the run's arena.

  test_absence.py --quick   all effects that no scene here uses, left out together: two programs
  test_absence.py           each effect by itself: a program for each (make absence)

Among the other tests it is skipped, since it builds programs: make absence runs it."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / "build/absence"
ALLOWED = 0.01
SHORT, LONG = 4, 24  # steps
STEP = 1e-4  # s: fixed, so that the number of steps does not depend on anything

TOP = f"dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n[numerics]\nfixed_step = {STEP}\n"
FLUID = "[fluid water]\nshape = box 0, 0, 0.2, 0.1\nsound_speed = 20\nsurface = 0.1\n"
WALL = "[wall tank]\nshape = polyline thickness -0.03: 0, 0.2; 0, 0; 0.4, 0; 0.4, 0.2\n"
SOLID = """[solid gate]
shape = box 0.2, 0, 0.23, 0.15
clamp = box 0.2, 0.12, 0.23, 0.15
density = 1100
young = 1 MPa
poisson = 0.4
"""
OUTPUT = ("[output]\nprobe_interval = 1\nledger_interval = 1\nsnapshot_interval = 1\n"
          "checkpoint_minutes = 0\n")
SCENES = {
    "fluid alone": TOP + FLUID + OUTPUT,
    "dam break": TOP + FLUID + "artificial_viscosity = 0.05\ndensity_diffusion = 0.1\n" + WALL + OUTPUT,
    "solid alone": TOP + SOLID + OUTPUT,
    "gate": TOP + FLUID + "artificial_viscosity = 0.05\ndensity_diffusion = 0.1\n" + WALL + SOLID + OUTPUT,
}


def build(name, left_out):
    """The program without some effects. AVX-512 is beyond valgrind, so it is left out everywhere."""
    target = BUILD / name
    flags = f"CPPFLAGS=-DSPHFSI_WITHOUT={'+'.join('OUT_' + e for e in left_out) or '0'}"
    arch = ["ARCH=x86-64-v3"] if os.uname().machine == "x86_64" else []
    place = os.path.relpath(target, ROOT)
    subprocess.run(["make", "-j2", "SETUP=no", f"B={place}", f"PROGRAM={place}/sphfsi", *arch, flags,
                    f"{place}/sphfsi"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return target / "sphfsi"


def run(program, scene, steps):
    with tempfile.TemporaryDirectory() as top:
        case = Path(top) / "scene.cfg"
        case.write_text(scene)
        command = [str(program), str(case), "--quiet", "--threads", "1", "--out", f"{top}/run",
                   "--until", repr(steps * STEP)]
        result = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
                                 *command], capture_output=True, text=True)
        found = re.search(r"Collected : (\d+)", result.stderr)
        assert result.returncode == 0 and found, result.stderr + result.stdout
        summary = json.loads(Path(top, "run/summary.json").read_text())
        return int(found.group(1)), summary


def measure(program, scene):
    """Instructions a step, bytes, state and effects."""
    few, _ = run(program, scene, SHORT)
    many, summary = run(program, scene, LONG)
    per_step = (many - few) / (LONG - SHORT)
    return per_step, summary["memory_bytes"], summary["state_hash"], set(summary["effects"])


def compare(left_out, program, scene, whole):
    """Number of failures; says what was found."""
    steps, size, state, _ = measure(program, SCENES[scene])
    excess = [whole[scene][0] / steps - 1, whole[scene][1] / size - 1]
    good = max(excess) <= ALLOWED and state == whole[scene][2]
    print(f"{'ok' if good else 'FAILED':6s} {scene:12s} without {' '.join(left_out)}: {steps:.0f} "
          f"instructions a step, {100 * excess[0]:+.2f} % with it; {size} bytes, "
          f"{100 * excess[1]:+.2f} %{'' if state == whole[scene][2] else '; OTHER BITS'}", flush=True)
    return not good


def main():
    if not shutil.which("valgrind"):
        print("valgrind is not installed")
        return 77
    if "ABSENCE" not in os.environ:
        print("builds a program for each effect: make absence")
        return 77
    subprocess.run(["make", "-s", "info"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    effects = re.findall(r"^EFFECT\((\w+)", (ROOT / "src/effects.def").read_text(), re.M)
    reference = build("whole", [])
    whole = {name: measure(reference, text) for name, text in SCENES.items()}
    failures = 0
    if "--quick" not in sys.argv:
        for effect in effects:
            scenes = [name for name in SCENES if effect not in whole[name][3]]
            program = build("without", [effect])
            failures += sum(compare([effect], program, name, whole) for name in scenes)
    else:
        used = set.union(*(row[3] for row in whole.values()))
        unused = [e for e in effects if e not in used and e != "MULTIRATE"]
        program = build("without", unused)
        failures += sum(compare(unused, program, name, whole) for name in ("dam break", "gate"))
    return failures > 0


if __name__ == "__main__":
    sys.exit(main())
