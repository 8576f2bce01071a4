#!/usr/bin/env python3
"""An effect that a scene does not use costs nothing: its instructions and bytes are at most 0.05 %
above those of a program compiled without the effect, and its state is the same to the bit. A wall
that no fluid reaches costs at most 1 %. The short form, which any compiler has to pass, allows 1 %
for all effects at once.

Valgrind counts the instructions within simulation_step, which are the same in every run. Those of
the allocator are left out: the threads' library calls it at each parallel region, and they depend
on earlier frees. Bytes are those of the run's arena.

  test_absence.py           all effects that no scene here uses, left out together (two programs),
  and
                            docs/results/absence.md, which must have a row for every effect
  test_absence.py --each    each effect by itself, a program for each: make absence, which writes
                            docs/results/absence.md
  test_absence.py --each NAME ...
                            these effects only: their rows of the report"""
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
REPORT = ROOT / "docs/results/absence.md"
ALLOWED = 0.01
ALLOWED_EACH = 0.0005
STEPS = 24
STEP = 1e-4  # s: fixed, so that the number of steps does not depend on anything

ANY = f"dp = 1 cm\nend_time = 1\n[numerics]\nfixed_step = {STEP}\n"
TOP = "scheme = paper\n" + ANY
FLUID = "[fluid water]\nshape = box 0, 0, 0.2, 0.1\nsound_speed = 20\n"
WATER = FLUID + "surface = 0.1\nartificial_viscosity = 0.05\ndensity_diffusion = 0.1\n"
STANDARD_WATER = FLUID + "surface = 0.1\nartificial_viscosity = 0.05\n"
WALL = "[wall tank]\nshape = polyline thickness -0.03: 0, 0.2; 0, 0; 0.4, 0; 0.4, 0.2\n"
FAR_WALL = "[wall far]\nshape = box 0.5, 0, 0.9, 0.2\n"
DOMAIN = "[domain]\nlower = -0.1, -0.1\nupper = 1, 0.5\n"
SOLID = """[solid gate]
shape = box 0.2, 0, 0.23, 0.15
clamp = box 0.2, 0.12, 0.23, 0.15
density = 1100
young = 1.5 MPa
poisson = 0.4
"""
OUTPUT = ("[output]\nprobe_interval = 1\nledger_interval = 1\nsnapshot_interval = 1\n"
          "checkpoint_minutes = 0\n")
NO_ACCOUNT = "energy_account = off\n"
GRAVITY = "gravity = 0, -9.81\n"
SCENES = {
    "fluid alone": TOP + FLUID + OUTPUT + NO_ACCOUNT,
    "dam break": GRAVITY + TOP + WATER + WALL + OUTPUT,
    "solid alone": TOP + SOLID + OUTPUT,
    "gate": GRAVITY + TOP + WATER + WALL + SOLID + OUTPUT + NO_ACCOUNT,
    "standard gate": GRAVITY + ANY + STANDARD_WATER + WALL + SOLID + OUTPUT,
}


def build(name, left_out):
    """The program without some effects. AVX-512 is beyond valgrind, so it is left out
    everywhere."""
    target = BUILD / name
    flags = f"CPPFLAGS=-DSPHFSI_WITHOUT={'+'.join('OUT_' + e for e in left_out) or '0'}"
    arch = ["ARCH=x86-64-v3"] if os.uname().machine == "x86_64" else []
    place = os.path.relpath(target, ROOT)
    # Not what the make that runs the tests was told.
    clean = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    subprocess.run(["make", "-j2", "SETUP=no", f"B={place}", f"PROGRAM={place}/sphfsi", *arch,
                    flags,
                    f"{place}/sphfsi"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL, env=clean)
    return target / "sphfsi"


ALLOCATOR = re.compile(r"malloc|calloc|realloc|free|unlink_chunk|mem_align")


def instructions(path):
    """Of all functions in callgrind's file but the allocator's."""
    names, name, total, inclusive = {}, "", 0, False
    for line in Path(path).read_text().splitlines():
        function = re.match(r"fn=\((\d+)\)(?: (.*))?", line)
        if function:
            name = names.setdefault(function[1], function[2])
        elif line.startswith("calls="):
            inclusive = True  # the next line is the cost of what is called, which is counted there
        elif re.match(r"[+*\-\d]", line):
            if not inclusive and not ALLOCATOR.search(name):
                total += int(line.split()[1])
            inclusive = False
        elif line.startswith("cfn=("):
            called = re.match(r"cfn=\((\d+)\)(?: (.*))?", line)
            names.setdefault(called[1], called[2])
    return total


def measure(program, scene):
    """Instructions a step, bytes, state and effects."""
    with tempfile.TemporaryDirectory() as top:
        case, counts = Path(top) / "scene.cfg", Path(top) / "counts"
        case.write_text(scene)
        result = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={counts}",
             "--toggle-collect=simulation_step", str(program), str(case), "--quiet", "--threads",
             "1",
             "--out", f"{top}/run", "--until", repr(STEPS * STEP)], capture_output=True, text=True)
        assert result.returncode == 0 and counts.exists(), result.stderr + result.stdout
        summary = json.loads(Path(top, "run/summary.json").read_text())
        steps = instructions(counts) / summary["steps"]
        assert steps > 1000, f"{program} {case}: nothing was counted"
        return steps, summary["memory_bytes"], summary["state_hash"], set(summary["effects"])


def compare(left_out, program, scene, whole, allowed):
    """What the effects cost a scene that does not have them, instructions and bytes; whether it is
    good."""
    steps, size, state, _ = measure(program, SCENES[scene])
    excess = [whole[scene][0] / steps - 1, whole[scene][1] / size - 1]
    same = state == whole[scene][2]
    good = max(excess) <= allowed and same
    print(f"{'ok' if good else 'FAILED':6s} {scene:12s} without {' '.join(left_out)}: {steps:.0f} "
          f"instructions a step, {100 * excess[0]:+.3f} % with it; {size} bytes, "
          f"{100 * excess[1]:+.3f} %{'' if same else '; OTHER BITS'}", flush=True)
    return excess, good


def far_wall_is_free(program):
    """A wall that no fluid reaches, of more particles than the tank: no instructions."""
    near = measure(program, GRAVITY + TOP + WATER + WALL + DOMAIN + OUTPUT)[0]
    both = measure(program, GRAVITY + TOP + WATER + WALL + FAR_WALL + DOMAIN + OUTPUT)[0]
    good = abs(both / near - 1) <= ALLOWED
    print(f"{'ok' if good else 'FAILED':6s} dam break    with a wall out of reach: {both:.0f} "
          f"instructions "
          f"a step, {near:.0f} without it ({100 * (both / near - 1):+.2f} %)", flush=True)
    return near, both, good


def row(name, cells):
    return "| " + " | ".join([name, *cells]) + " |"


def summary(effects, costs):
    """Three sentences: whether an effect that a scene does not use costs anything."""
    most = max(cell[0] for cell in costs.values())
    least = min(cell[0] for cell in costs.values())
    size = max(abs(cell[1]) for cell in costs.values())
    over = sum(max(cell) > ALLOWED_EACH for cell in costs.values())
    return (f"**Does an effect cost anything in a scene that does not use it?** {len(costs)} pairs "
            f"of "
            f"{len(effects)} effects and {len(SCENES)} scenes were compared. The program with the "
            f"effect "
            f"takes from {100 * least:+.3f} to {100 * most:+.3f} % more instructions than the one "
            f"without "
            f"it, and {100 * size:.2f} % more bytes. {over} pairs are above the limit of "
            f"{100 * ALLOWED_EACH:.2f} %. "
            "The results are the same to the bit. Where code is absent, the compiler assigns "
            "registers "
            "differently in code that stays, which is why some programs are dearer without the "
            "effect.")


def report(whole, effects, costs, far, version):
    lines = [
        "# What an absent effect costs", "", summary(effects, costs), "",
        f"`make absence` writes this report. It builds {len(effects) + 1} programs: one with all "
        f"effects, and for "
        "each effect one without it. Each runs five small scenes (`tests/agree/test_absence.py`) "
        "over "
        f"{STEPS} steps on one thread, for x86-64-v3. Valgrind counts the instructions within "
        "`simulation_step`, which are the same in every run. Bytes are those of the run's arena. "
        "The "
        "hash of the "
        f"state was the same in all programs. Program: {version}.", "",
        row("program with all effects", SCENES), row("---", ["---:"] * len(SCENES)),
        row("instructions a step", [f"{whole[s][0]:.0f}" for s in SCENES]),
        row("bytes", [str(whole[s][1]) for s in SCENES]), "",
        "Each cell says by how much the program with all effects exceeds the one without the "
        "effect: "
        "instructions / bytes. *on*: the scene uses the effect, so there is nothing to compare. "
        "The limit is "
        f"{100 * ALLOWED_EACH:.2f} %.", "",
        row("effect", SCENES), row("---", ["---:"] * len(SCENES))]
    for effect in effects:
        lines.append(row(effect, cells_of(effect, costs)))
    near, both, _ = far
    lines += ["", f"A wall out of the fluid's reach is free as well. The dam break takes "
                  f"{both:.0f} "
                  f"instructions a "
              f"step with it and {near:.0f} without it ({100 * (both / near - 1):+.2f} %).", ""]
    REPORT.write_text("\n".join(lines))


def cells_of(effect, costs):
    return ["on" if (effect, s) not in costs else
            "{:+.3f} % / {:+.2f} %".format(*(100 * c for c in costs[effect, s])) for s in SCENES]


def reported():
    """The costs in the report."""
    costs = {}
    for effect, cells in re.findall(r"^\| ([A-Z_]+) \| (.*) \|$", REPORT.read_text(), re.M):
        for scene, cell in zip(SCENES, cells.split(" | ")):
            numbers = re.fullmatch(r"([+-]\S+) % / ([+-]\S+) %", cell)
            if numbers:
                costs[effect, scene] = [float(n) / 100 for n in numbers.groups()]
    return costs


def replace_rows(effects, measured, costs, version):
    """The rows of the effects `measured`; the other rows stay, with their programs."""
    lines = REPORT.read_text().splitlines()
    for k, line in enumerate(lines):
        name = re.match(r"\| ([A-Z_]+) \|", line)
        if name and name[1] in measured:
            lines[k] = row(name[1], cells_of(name[1], costs))
        elif line.startswith("**Does an effect"):
            lines[k] = summary(effects, reported() | costs)
        elif line.startswith("`make absence`"):
            text, programs = line.split("Program: ")
            parts = [p for p in programs.rstrip(".").split("; ")
                     if p.split(": ")[0] not in measured]
            parts[1:1] = [f"{effect}: {version}" for effect in measured]
            lines[k] = text + "Program: " + "; ".join(parts) + "."
    REPORT.write_text("\n".join(lines) + "\n")


def each(effects, measured, whole, far, version):
    costs, failures = {}, 0
    for effect in measured:
        scenes = [name for name in SCENES if effect not in whole[name][3]]
        if not scenes:
            print(f"FAILED every scene here has {effect}")
            failures += 1
            continue
        program = build("without", [effect])
        for scene in scenes:
            costs[effect, scene], good = compare([effect], program, scene, whole, ALLOWED_EACH)
            failures += not good
    if measured == effects:
        report(whole, effects, costs, far, version)
    else:
        replace_rows(effects, measured, costs, version)
    return failures


def together(effects, whole):
    """The same in short, and what is committed of the long form."""
    used = set.union(*(row[3] for row in whole.values()))
    unused = [e for e in effects if e not in used and e != "MULTIRATE"]
    program = build("quick", unused)
    failures = sum(not compare(unused, program, name, whole, ALLOWED)[1] for name in whole)
    rows = re.findall(r"^\| ([A-Z_]+) \|.*", REPORT.read_text(), re.M)
    costs = [float(c) for c in re.findall(r"\| ([+-]\d+\.\d+) % /", REPORT.read_text())]
    if rows != effects or not costs or max(costs) > 100 * ALLOWED_EACH:
        print(f"FAILED {REPORT} does not have every effect within the limit: make absence writes "
              f"it anew")
        failures += 1
    return failures


def main():
    if not shutil.which("valgrind"):
        print("valgrind is not installed")
        return 77
    if Path(os.environ.get("SPHFSI", "./sphfsi")).resolve() != Path("sphfsi").resolve():
        print("builds programs of its own: once, beside the release program, is enough")
        return 77
    effects = re.findall(r"^EFFECT\((\w+)", (ROOT / "src/case/effects.def").read_text(), re.M)
    reference = build("whole", [])
    long = "--each" in sys.argv
    whole = {name: measure(reference, text) for name, text in SCENES.items()
             if long or name in ("dam break", "gate")}
    far = far_wall_is_free(reference)
    version = subprocess.run([reference, "--version"], capture_output=True, text=True,
                             check=True).stdout.strip()
    named = sys.argv[2:]
    return (each(effects, named or effects, whole, far, version) if long
            else together(effects, whole)) + (not far[2]) > 0


if __name__ == "__main__":
    sys.exit(main())
