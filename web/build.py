#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the page that runs the program in a browser: one HTML file with both WebAssembly programs,
the cases, their references, and the state hashes of the native program, which runs each case once
for that.

    web/build.py --program ./sphfsi --fused build/web/fused.wasm --exact build/web/exact.wasm --out
    page.html
"""
import argparse
import base64
import gzip
import hashlib
import html
import json
import math
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path.insert(0, str(ROOT / "python"))
try:
    import matplotlib
    import numpy as np
    from sphfsi import files
except ImportError as missing:
    sys.exit(f"{missing.name} is missing; tools/setup.sh plot installs it")

PALETTES = {"fluid": "viridis", "solid": "OrRd"}

# Coarse or short enough for a browser. set: other than in cases/; view: x0, x1, y0, y1 of the
# picture, m; fluid: the field that colours the fluid at first
CASES = {
    "gate": {"set": {"dp": "2 mm", "wall": "6 mm"}, "view": (-0.01, 0.45, -0.01, 0.17)},
    "two_posts": {"set": {"end_time": "0.3 s"}},
    "rolling_tank": {"set": {"end_time": "1.6 s"}},
    "wet_baffle": {"set": {"dp": "4 mm", "end_time": "0.6 s"}},
    "sluice_gate": {"set": {"dp": "4 mm", "end_time": "0.6 s"}},
    "hydrostatic_plate": {"set": {"dp": "25 mm", "wall": "0.1 m"}},
    "elastic_valve": {"set": {"end_time": "0.25 s"}, "fluid": "velocity"},
    "turek_hron/fsi2": {"set": {"end_time": "1 s"}, "fluid": "velocity"},
    "vortices": {"fluid": "velocity"},
    "rotating_patch": {"view": (-1.2, 1.2, -1.2, 1.2)},
    "channel": {"fluid": "velocity"},
    "ringing_bar": {},
    "cantilever": {"set": {"ratio": "10"}},
    "beam_on_beam": {},
    "still_water": {"set": {"dp": "10 mm"}},
    "accelerated_tank": {},
    "templates/thin_plate": {"set": {"dp": "20 mm"}},
    "templates/flap": {"set": {"end_time": "4 s"}},
}
FUNCTIONS = {name: getattr(math, name)
             for name in ("sqrt", "sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log")}
FUNCTIONS.update(pi=math.pi, min=min, max=max, abs=abs, round=round)
POINTS = 400  # of the curve of a formula


def with_values(text, values):
    """The text of a case with other values at the top and of constants, and what they were."""
    for key, value in values.items():
        text, found = re.subn(
            rf"(?m)^{key} = ([^#\n]*?)( *#.*)?$",
            lambda hit: f"{key} = {value}" + (f"{hit[2]};" if hit[2] else "  #") +
            f" {hit[1]} in cases/",
            text, count=1)
        if not found:
            raise SystemExit(f"web/build.py: the case has no line `{key} = `")
    return text


def as_sets(values):
    return [item for key, value in values.items() for item in ("--set", f"{key}={value}")]


def native_run(program, name, values, folder):
    """The finished folder of a run by the native program, which is kept for the next time."""
    case = ROOT / "cases" / f"{name}.cfg"
    sum_of = hashlib.sha256(program.read_bytes() + case.read_bytes() +
                            repr(values).encode()).hexdigest()[:16]
    stem = name.replace("/", "_")
    out = folder / f"{stem}-{sum_of}"
    if not (out / "summary.json").exists() or files.Run(out).failure():
        for old in folder.glob(f"{stem}-*"):
            subprocess.run(["rm", "-rf", old], check=True)
        command = [program, case, "--out", out, "--threads", "1", "--quiet"]
        print(f"  native {name}", flush=True)
        subprocess.run(command + as_sets(values), check=True, stderr=subprocess.DEVNULL)
    return files.Run(out)


def number(text):
    return float(re.match(r"[-+\d.eE]+", text)[0])


def formula_curve(keys, sections, end):
    """Times and values of a formula of t. The case in effect has its constants in SI units."""
    names = dict(FUNCTIONS)
    for kind, _, values in sections:
        names.update((key, number(value)) for key, value in values.items() if kind == "constants")
        names.update((key, number(values[key])) for key in ("dp",) if kind == "top")
    text = re.sub(r"(?<=\d) (kg|m|s|N|Pa|rad)([*/](kg|m|s)|\^-?\d)*", "",
                  keys["formula"]).replace("^", "**")
    begin, stop = max(0.0, number(keys.get("from", "0"))), min(end,
                                                               number(keys.get("until", "1e9")))
    time = np.linspace(begin, stop, POINTS)
    return time, [eval(text, {"__builtins__": {}}, {**names, "t": t}) for t in time.tolist()]


def references(run, end):
    found = [{"column": ref.probe, "label": ref.label, "measured": ref.measured, "time": ref.time,
              "value": ref.value} for ref in files.references(run)]
    for kind, name, keys in run.case():
        if kind == "reference" and keys.get("formula"):
            time, value = formula_curve(keys, run.case(), end)
            found.append({"column": keys["probe"], "label": keys.get("label") or name,
                          "measured": False,
                          "time": time, "value": value})
    for ref in found:
        if len(ref["time"]) == 1:  # constant in time
            ref["time"], ref["value"] = [0, end], [ref["value"][0]] * 2
        for key in ("time", "value"):
            ref[key] = [float(f"{v:.6g}") for v in ref[key]]
    return found


def case_data(program, name, folder):
    own = CASES[name]
    values = own.get("set", {})
    text = (ROOT / "cases" / f"{name}.cfg").read_text(encoding="utf-8")
    run = native_run(program, name, values, folder)
    title = run.summary.get("title") or name
    return {"name": name, "title": title, "text": with_values(text, values),
            "view": own.get("view"),
            "fluid": own.get("fluid", "pressure"),
            "hash": run.summary["state_hash"], "references": references(run, run.summary["time"])}


def palette(name):
    return np.rint(255 *
                   matplotlib.colormaps[name](np.arange(256))[:, :3]).astype(int).ravel().tolist()


def packed(path):
    return base64.b64encode(gzip.compress(path.read_bytes(), 9, mtime=0)).decode()


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True, help="the native program")
    parser.add_argument("--fused", type=Path, required=True, help="built with relaxed SIMD")
    parser.add_argument("--exact", type=Path, required=True, help="built without")
    parser.add_argument("--out", type=Path, required=True, help="the page")
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES),
                        help="these cases, not all")
    args = parser.parse_args()
    folder = args.out.parent / "runs"
    program = args.program.resolve()
    said = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout
    version = said.split()[-1]
    data = {"version": version,
            "palettes": {kind: palette(name) for kind, name in PALETTES.items()},
            "programs": {"fused": packed(args.fused), "exact": packed(args.exact)},
            "cases": [case_data(program, name, folder) for name in args.only]}
    page = (HERE / "index.html").read_text(encoding="utf-8")
    for name, text in (("STYLE", (HERE / "style.css").read_text(encoding="utf-8")),
                       ("ABOUT",
                        html.escape("Nothing is loaded from elsewhere, and nothing is sent.")),
                       ("DATA", json.dumps(data, separators=(",", ":")).replace("</", "<\\/")),
                       ("WORKER", (HERE / "worker.js").read_text(encoding="utf-8")),
                       ("DRAW", (HERE / "draw.js").read_text(encoding="utf-8")),
                       ("PAGE", (HERE / "page.js").read_text(encoding="utf-8"))):
        page = page.replace(f"@{name}@", text)
    args.out.write_text(page, encoding="utf-8")
    print(f"written {args.out}: {len(args.only)} cases, {len(page) / 1e6:.2f} MB; any browser "
          f"opens it")


if __name__ == "__main__":
    main()
