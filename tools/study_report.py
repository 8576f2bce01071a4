# SPDX-License-Identifier: MIT
"""The report of the accuracy study (docs/accuracy.md and its figures) from its collected results."""

import json
import os
import re
from pathlib import Path

from runfiles import COLOURS, WIDTH, BadFile, np, plt, read_text, save
from study_order import convergence

SCENES = {"solid": "solid alone", "fluid": "fluid alone", "coupled": "fluid and structure"}
ROOT = Path(__file__).resolve().parent.parent
MARKS = "osD^v<>ph*XP"


def machine(root):
    """What the timings depend on besides the program."""
    cpu = "unknown processor"
    info = Path("/proc/cpuinfo")
    for line in info.read_text().splitlines() if info.exists() else []:
        if line.startswith("model name"):
            cpu = line.split(":", 1)[1].strip()
            break
    flags = root / "build" / "release" / "flags"
    words = flags.read_text().split() if flags.exists() else ["unknown compiler"]
    compiler = f"{words[0]} {words[-1]}" if len(words) > 1 else words[0]
    options = " ".join(w for w in words if w.startswith(("-O", "-march", "-mcpu")))
    return {"cpu": cpu, "cores": os.cpu_count(), "compiler": f"{compiler} {options}".strip()}


# --- numbers of a point ---

def cost(p):
    """CPU s: the least of its runs, which other work on the machine disturbs least."""
    return min(t["cpu"] for t in p["timing"])


def seconds(p, key):
    """Median and spread over the repeats."""
    values = sorted(t[key] for t in p["timing"])
    middle = np.median(values)
    return f"{middle:.3g}" if len(values) == 1 else f"{middle:.3g} ({values[0]:.3g}-{values[-1]:.3g})"


def main_error(case):
    return case["error"][0]["name"]


def finished(p):
    return p["outcome"] == "finished" and p["timing"]


def percent(value):
    return "-" if value is None else f"{100 * value:.3g}"


def across(case, p):
    return case["across"] / p["dp"]


class Study:
    """Collected results."""

    def __init__(self, path):
        try:
            data = json.loads(read_text(path))
            self.definition, self.points = data["definition"], data["points"]
            self.head = data
        except (ValueError, KeyError, TypeError) as problem:
            raise BadFile(f"{path}: not the results of a study ({problem})") from None
        self.cases, self.knobs = self.definition["case"], self.definition["knob"]

    def of(self, case, knob=None, value=None):
        return [p for p in self.points if p["case"] == case and
                knob in (None, p["knob"]) and value in (None, p["value"])]

    def base(self, case):
        return [p for p in self.of(case, "base") if finished(p)]

    def base_at(self, case, level):
        return next((p for p in self.base(case) if p["level"] == level), None)

    def front(self, case):
        """Points that no other one beats in both error and cost."""
        name, found, best = main_error(self.cases[case]), [], np.inf
        known = [p for p in self.of(case) if finished(p) and p["errors"].get(name) is not None]
        for p in sorted(known, key=cost):
            if p["errors"][name] < best:
                found.append(p)
                best = p["errors"][name]
        return found

    def slope(self, case, error):
        """b of error = a cost^-b along the resolutions of the base settings; None: it does not fall."""
        points = [(cost(p), p["errors"].get(error)) for p in self.base(case)]
        points = [(c, e) for c, e in points if e]
        if len(points) < 2:
            return None
        b = -np.polyfit(*np.log(points).T, 1)[0]
        return b if b > 0.05 else None

    def gain(self, p, error):
        """How many times longer the base settings would take to the same error; None: unknown."""
        base, b = self.base_at(p["case"], p["level"]), self.slope(p["case"], error)
        if not base or not b or not finished(p):
            return None
        mine, its = p["errors"].get(error), base["errors"].get(error)
        return (its / mine) ** (1 / b) * cost(base) / cost(p) if mine and its else None


def front_names(path):
    study = Study(path)
    return [p["name"] for case in study.cases for p in study.front(case)] + \
        [p["name"] for p in study.points if p["knob"] == "base"]


# --- figures ---

def draw_case(study, case, path):
    entry, error = study.cases[case], main_error(study.cases[case])
    figure, axes = plt.subplots(figsize=(WIDTH, 0.58 * WIDTH))
    lines = [("base", "")] + [(k, v) for k in study.knobs for v in study.knobs[k]["values"]
                              if study.of(case, k, v)]
    knobs = [k for k in dict.fromkeys(k for k, _ in lines) if k != "base"]
    for number, (knob, value) in enumerate(lines):
        points = [p for p in study.of(case, knob, value) if finished(p) and p["errors"].get(error)]
        if not points:
            continue
        points.sort(key=lambda p: p["level"])
        base = knob == "base"
        order = 0 if base else knobs.index(knob)
        axes.loglog([cost(p) for p in points], [100 * p["errors"][error] for p in points],
                    color="black" if base else COLOURS[order % len(COLOURS)],
                    linestyle="-" if base else ["-", "--", ":", "-."][order // len(COLOURS) % 4],
                    marker=MARKS[number % len(MARKS)], markersize=4, linewidth=1.8 if base else 0.8,
                    label="base settings" if base else f"{knob} = {value}", zorder=3 if base else 2)
    front = study.front(case)
    axes.loglog([cost(p) for p in front], [100 * p["errors"][error] for p in front], color="0.8",
                linewidth=6, solid_capstyle="round", zorder=1, label="Pareto front")
    axes.set_xlabel("CPU time (s)")
    axes.set_ylabel(f"{error} (%)")
    axes.set_title(entry.get("title", case))
    axes.grid(True, which="both", linewidth=0.3, alpha=0.5)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=6)
    figure.tight_layout()
    save(figure, path)
    plt.close(figure)


# --- tables ---

def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] +
                     ["| " + " | ".join(str(c) for c in row) + " |" for row in rows])


def base_table(study, case):
    entry = study.cases[case]
    names = [e["name"] for e in entry["error"]]
    head = [entry.get("what", "across"), "dp (mm)"] + [f"{n} (%)" for n in names] + \
        ["CPU s: median (spread)", "wall s", "million particle steps", "evaluations", "ns a particle step"]
    rows = []
    for p in study.of(case, "base"):
        if not finished(p):
            rows.append([f"level {p['level']}", f"**{p['outcome']}**: {p['message']}"] +
                        [""] * (len(head) - 2))
            continue
        rows.append([f"{across(entry, p):.3g}", f"{1e3 * p['dp']:.4g}"] +
                    [percent(p["errors"].get(n)) for n in names] +
                    [seconds(p, "cpu") + busy(study, p), seconds(p, "wall"),
                     f"{1e-6 * p['particle_steps']:.3g}", f"{p['evaluations']:,}",
                     f"{1e9 * cost(p) / p['particle_steps']:.0f}"])
    return table(head, rows)


def busy(study, p):
    """A mark for timings that were taken beside other work."""
    quiet = study.definition["study"].get("threads", 1) + 0.3
    return " †" if max(t["load"] for t in p["timing"]) > quiet else ""


def order_table(study):
    rows = []
    for case, entry in study.cases.items():
        base = sorted(study.base(case), key=lambda p: p["dp"])
        for error in entry["error"]:
            values = [(p["dp"], p["values"].get(error["name"])) for p in base]
            values = [v for v in values if v[1] is not None][:3]
            if len(values) < 3 or error["kind"] in ("noise",):
                continue
            c = convergence(*zip(*values))
            reference = error.get("reference", error.get("rate"))
            rows.append([case, error["name"], *(f"{v:.5g}" for _, v in values),
                         f"{c['order']:.2f}" if c["order"] else f"none ({c['why']})",
                         f"{c['extrapolated']:.5g}" if c["order"] else "-", f"{100 * c['band']:.2g}",
                         "-" if reference is None else f"{reference:.5g}"])
    return table(["case", "quantity", "finest", "middle", "coarsest", "observed order", "extrapolated",
                  "band of the finest (%)", "reference"], rows)


def halving_table(study):
    rows = []
    for case, entry in study.cases.items():
        for error in [e["name"] for e in entry["error"]]:
            b = study.slope(case, error)
            points = [p for p in study.base(case) if p["errors"].get(error)]
            if len(points) >= 2:
                rows.append([case, error, f"{percent(points[0]['errors'][error])} to "
                             f"{percent(points[-1]['errors'][error])}",
                             f"{2 ** (1 / b):.1f}" if b else "cannot be bought with resolution here"])
    return table(["case", "error", "range (%)", "to halve it costs x times"], rows)


def knob_rows(study, case, error):
    rows = []
    for knob, entry in study.knobs.items():
        for value in entry["values"]:
            points = study.of(case, knob, value)
            if not points:
                continue
            cells, gains = [], []
            for p in sorted(points, key=lambda p: p["level"]):
                base = study.base_at(case, p["level"])
                if not finished(p):
                    cells.append(f"**{p['outcome']}**")
                elif base and p["errors"].get(error) and base["errors"].get(error):
                    cells.append(f"{p['errors'][error] / base['errors'][error]:.2f} / "
                                 f"{cost(p) / cost(base):.2f}")
                    gains.append(study.gain(p, error))
                else:
                    cells.append("-")
            gains = [g for g in gains if g]
            rows.append((np.exp(np.mean(np.log(gains))) if gains else 0, knob, value, cells))
    return rows


def knob_table(study, case):
    entry = study.cases[case]
    error = main_error(entry)
    rows = sorted(knob_rows(study, case, error), key=lambda r: -r[0])
    width = max((len(r[3]) for r in rows), default=0)
    levels = [f"{across(entry, p):.3g}" for p in study.base(case)]
    what = entry.get("what", "across")
    head = ["setting"] + [f"error / cost, {levels[k] if k < len(levels) else k} {what}" for k in range(width)]
    return table(head + ["gain"], [
        [f"{k} = {v}"] + cells + [""] * (width - len(cells)) + [f"{g:.2f}" if g else "-"]
        for g, k, v, cells in rows])


def best_knobs(study):
    """Per scene the setting of each knob with the largest gain in all cases where it ran."""
    rows = []
    for scene, words in SCENES.items():
        cases = [c for c in study.cases if study.cases[c]["scene"] == scene]
        found = {}
        for case in cases:
            for gain, knob, value, cells in knob_rows(study, case, main_error(study.cases[case])):
                sound = gain > 0 and not any("**" in c for c in cells)
                found.setdefault((knob, value), []).append(gain if sound else 0)
        ranked = sorted(((min(g), max(g), *k) for k, g in found.items()),
                        reverse=True)
        for low, high, knob, value in ranked[:8]:
            if low > 0:
                rows.append([words, f"{knob} = {value}",
                             f"{low:.2f}" if low == high else f"{low:.2f} to {high:.2f}"])
    return table(["scene", "setting", "gain, least and most over its cases"], rows)


def preset_points(study):
    """(preset, scene, case, point) of every point that stands for a preset, finished or not."""
    for preset, knobs in study.definition.get("preset", {}).items():
        for case, entry in study.cases.items():
            knob, _, value = knobs.get(entry["scene"], "base").partition("=")
            for p in sorted(study.of(case, knob, value), key=lambda p: p["level"]):
                yield preset, entry["scene"], case, p


def preset_section(study):
    rows = []
    for preset, _, case, p in preset_points(study):
        entry = study.cases[case]
        error = p.get("errors", {}).get(main_error(entry)) if finished(p) else None
        if finished(p) and error is None:
            continue
        what = entry.get("what", "across")
        rows.append([case, preset, f"{across(entry, p):.3g} {what}" if p["dp"] else "-",
                     percent(error) if finished(p) else f"**{p['outcome']}**",
                     f"{cost(p):.3g}" if finished(p) else "-"])
    return table(["case", "preset", "resolution", "main error (%)", "CPU s"],
                 sorted(rows, key=lambda r: r[0]))


def write_evidence(study, path):
    """What the program says of its presets: the same numbers as a list that it is compiled with."""
    rows = []
    for preset, scene, case, p in preset_points(study):
        entry = study.cases[case]
        error = p.get("errors", {}).get(main_error(entry)) if finished(p) else None
        if error is not None:
            rows.append(f'EVIDENCE({scene.upper()}, {preset.upper()}, "{entry.get("title", case)}", '
                        f'"{main_error(entry)}", {across(entry, p):.3g}, "{entry.get("what", "across")}", '
                        f"{100 * error:.3g})")
    head = ("/* Written by make accuracy: errors of the presets in the study of program "
            f"{', '.join(study.head['versions'])}.\n * EVIDENCE(scene, accuracy, case, error, resolution, "
            "what it counts, percent) */\n")
    path.write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
    print(f"written {path}")


def failures(study):
    rows = [[p["name"], p["outcome"], p["message"]] for p in study.points if not finished(p)]
    return table(["point", "outcome", "message"], rows) if rows else "None."


TEXT = """# What accuracy costs in time

Written by `make accuracy` (`tools/accuracy_cost.py`) from `{data}`; nothing here is typed by hand.
Program {versions} (sources {program}); {machines}; {threads} thread a run; {counters}. {points} points
in {runs} runs.

Cost is CPU time, the least of a point's repeats; beside it stand median and spread. Points that cost
more than {repeat_below:g} s were run once. † marks timings taken while the load average was above
{quiet:g}: {busy} of {points} points. On such a machine CPU time is some tenths too long and unsteady,
and wall time means little. *Base settings* are those of the case file with the program's defaults. {note}

{cases}

## Order of convergence

From the three finest runs with base settings: the observed order p, the extrapolated value, and the
band of the finest run, 1.25 |f1 - f2|/(r^p - 1) relative to it (Roache 1994; Celik et al. 2008; p at
most 2). Where the three do not converge monotonically, or p < 0.5, there is no order and the band is
three times their largest difference (Eça and Hoekstra 2014). *Extrapolated* differs from *reference*
where the model, not the resolution, is off, or where three grids do not yet tell the order.

{order}

## To halve the error

Slope of error against cost over the resolutions, base settings.

{halving}

## Which knob buys most accuracy per second

In each column error and cost over those of the base settings at the same resolution. *Gain*: how many
times longer the base settings, refined, would take to the same error (geometric mean over the columns):
above 1 the setting is worth it. A gain of a quantity whose error passes through zero, or that hardly
depends on resolution, says little.

{knobs}

### Best by kind of scene

{best}

## Presets

`accuracy = draft | standard | fine` at the top of a case file, as `src/presets.def` defines them. Their
error in the study:

{presets}

## What failed

{failures}

## Holes

{holes}
"""

CASE = """## {title}

{words} Main error: **{error}**. {references}

![Error against cost](img/accuracy_{case}.png)

{table}
"""


def case_text(study, case):
    entry = study.cases[case]
    sources = [f"{e['name']}: {e['source']}." for e in entry["error"] if e.get("source")]
    front = ", ".join(f"{p['knob']}{'=' + p['value'] if p['value'] else ''} at {across(entry, p):.3g}"
                      for p in study.front(case))
    return CASE.format(title=entry.get("title", case), words=entry.get("words", ""), case=case,
                       error=main_error(entry), references=" ".join(sources),
                       table=base_table(study, case)) + \
        f"\nPareto front, from cheap to exact: {front or 'no finished point'}.\n"


def write(data, out, evidence=None):
    study = Study(data)
    if evidence:
        write_evidence(study, evidence)
    (out / "img").mkdir(parents=True, exist_ok=True)
    for case in study.cases:
        if study.base(case):
            draw_case(study, case, out / "img" / f"accuracy_{case}.png")
    timings = [t for p in study.points for t in p["timing"]]
    energy = any(t["joules"] is not None for t in timings)
    rules = study.definition["study"]
    machines = "; ".join(f"{m['cpu']}, {m['cores']} cores, {m['compiler']}" for m in study.head["machines"])
    knobs = "\n\n".join(f"### {entry.get('title', case)}: {main_error(entry)}\n\n{knob_table(study, case)}"
                        for case, entry in study.cases.items())
    text = TEXT.format(
        data=Path(os.path.relpath(data, ROOT)) if str(data.resolve()).startswith(str(ROOT)) else data.name,
        versions=", ".join(study.head["versions"]) or "unknown", program=study.head["program"],
        machines=machines or "unknown machine", threads=rules.get("threads", 1),
        counters="energy from the processor's counters" if energy else
        "no energy: this machine has no counter in /sys/class/powercap",
        note=rules.get("note", ""), points=len(study.points),
        runs=len(timings), repeat_below=rules.get("repeat_below", np.inf),
        quiet=rules.get("threads", 1) + 0.3,
        busy=sum(bool(p["timing"] and busy(study, p)) for p in study.points),
        cases="\n".join(case_text(study, c) for c in study.cases), order=order_table(study),
        halving=halving_table(study), knobs=knobs, best=best_knobs(study), presets=preset_section(study),
        failures=failures(study), holes="\n".join(f"* {h}" for h in study.head["holes"]) or "None.")
    (out / "accuracy.md").write_text(re.sub(r" +\n", "\n", text), encoding="utf-8")
    print(f"written {out / 'accuracy.md'}")
    return 0
