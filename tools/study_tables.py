# SPDX-License-Identifier: MIT
"""Tables of the accuracy study's report."""

from runfiles import np
from study_order import convergence
from study_points import SCENES
from study_results import across, cost, finished, main_error, percent, seconds, setting

AIMS = (0.1, 0.05, 0.02, 0.01, 0.005)
# Kinds of error whose reference is the value that the table of orders shows.
SCALAR = ("period", "damped_period", "settled", "final")


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] +
                     ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) if rows else "None."


def aims_table(study):
    """The cheapest way to be within some percent."""
    rows = []
    for case, entry in study.cases.items():
        cells = []
        for aim in AIMS:
            good = [p for p in study.known(case) if study.error(p) <= aim]
            p = min(good, key=cost, default=None)
            cells.append(f"{cost(p):.3g} s: {setting(p)} at {across(entry, p):.3g}" if p else "-")
        rows.append([entry.get("title", case), main_error(entry), *cells])
    return table(["case", "error"] + [f"{100 * aim:g} %" for aim in AIMS], rows)


def base_table(study, case):
    entry = study.cases[case]
    names = [e["name"] for e in entry["error"]]
    head = [entry.get("what", "across"), "dp (mm)"] + [f"{n} (%)" for n in names] + \
        ["CPU s: median (spread)", "wall s", "million particle steps", "evaluations", "J",
         "ns a particle step"]
    rows = []
    for p in study.of(case, "base"):
        if not finished(p):
            rows.append([f"level {p['level']}", f"**{p['outcome']}** {p['message']}"] +
                        [""] * (len(head) - 2))
            continue
        energy = all(t.get("joules") is not None for t in p["timing"])
        rows.append([f"{across(entry, p):.3g}", f"{1e3 * p['dp']:.4g}"] +
                    [percent(p["errors"].get(n)) for n in names] +
                    [f"{seconds(p, 'cpu')} {study.marks(p)}", seconds(p, "wall"),
                     f"{1e-6 * p['particle_steps']:.3g}", f"{p['evaluations']:,}",
                     seconds(p, "joules") if energy else "-",
                     f"{1e9 * cost(p) / p['particle_steps']:.0f}"])
    return table(head, rows)


def orders(values):
    """Of the three finest, and the order of the three next to them."""
    c = convergence(*zip(*values[:3]))
    before = convergence(*zip(*values[1:4])) if len(values) > 3 else {"order": None, "why": "three only"}
    return c, f"{before['order']:.2f}" if before["order"] else f"none ({before['why']})"


def order_table(study):
    rows = []
    for case, entry in study.cases.items():
        base = sorted(study.base(case), key=lambda p: p["dp"])
        for error in entry["error"]:
            values = [(p["dp"], p["values"].get(error["name"])) for p in base]
            values = [v for v in values if v[1] is not None]
            if len(values) < 3 or error["kind"] == "noise":
                continue
            c, before = orders(values)
            reference = error.get("reference") if error["kind"] in SCALAR else None
            rows.append([case, error["name"], *(f"{v:.5g}" for _, v in values[:3]),
                         f"{c['order']:.2f}" if c["order"] else f"none ({c['why']})", before,
                         f"{c['extrapolated']:.5g}" if c["order"] else "-", f"{100 * c['band']:.2g}",
                         "-" if reference is None else f"{reference:.5g}"])
    return table(["case", "quantity", "finest", "middle", "coarsest", "observed order",
                  "order one level coarser", "extrapolated", "band of the finest (%)", "reference"], rows)


def halving_table(study):
    rows = []
    for case, entry in study.cases.items():
        for error in [e["name"] for e in entry["error"]]:
            b = study.slope(case, error)
            points = sorted((p for p in study.base(case) if p["errors"].get(error)), key=lambda p: -p["dp"])
            if len(points) < 2:
                continue
            order = np.polyfit(np.log([p["dp"] for p in points]),
                               np.log([p["errors"][error] for p in points]), 1)[0]
            rows.append([case, error, f"{percent(points[0]['errors'][error])} to "
                         f"{percent(points[-1]['errors'][error])}", f"{order:.2f}",
                         f"{2 ** (1 / b):.1f}" if b else "cannot be bought with resolution here"])
    return table(["case", "error", "coarsest to finest (%)", "power of dp", "to halve it costs x times"],
                 rows)


def knob_rows(study, case, error):
    """(gain, knob, value, {level: cell}, whether all finished)."""
    for knob, entry in study.knobs.items():
        for value in entry["values"]:
            points = study.of(case, knob, value)
            if not points:
                continue
            cells, gains = {}, []
            for p in points:
                ratios = study.ratios(p, error)
                cells[p["level"]] = f"**{p['outcome']}**" if not finished(p) else \
                    f"{ratios[0]:.2f} / {ratios[1]:.2f}" if ratios else "-"
                gains.append(study.gain(p, error))
            gains = [g for g in gains if g]
            yield (float(np.exp(np.mean(np.log(gains)))) if gains else 0, knob, value, cells,
                   all(finished(p) for p in points))


def gain_text(gain):
    return "-" if not gain else "over 1000" if gain > 1000 else f"{gain:.3g}"


def knob_table(study, case):
    entry = study.cases[case]
    rows = sorted(knob_rows(study, case, main_error(entry)), key=lambda r: -r[0])
    levels = sorted({level for r in rows for level in r[3]})
    fineness = {p["level"]: f"{across(entry, p):.3g} {entry.get('what', 'across')}"
                for p in study.of(case) if p["dp"]}
    head = [f"error / cost, {fineness.get(k, f'level {k}')}" for k in levels]
    return table(["setting", *head, "gain"], [
        [f"{k} = {v}"] + [cells.get(level, "") for level in levels] + [gain_text(g)]
        for g, k, v, cells, _ in rows])


def best_knobs(study):
    """Per scene the settings with the largest gain in all cases where they ran."""
    rows = []
    for scene, words in SCENES.items():
        found = {}
        for case in (c for c in study.cases if study.cases[c]["scene"] == scene):
            for gain, knob, value, _, sound in knob_rows(study, case, main_error(study.cases[case])):
                found.setdefault((knob, value), []).append(gain if sound else 0)
        ranked = sorted(((min(g), max(g), *k) for k, g in found.items() if min(g) > 0), reverse=True)
        rows += [[words, f"{knob} = {value}", " to ".join(dict.fromkeys(map(gain_text, (low, high))))]
                 for low, high, knob, value in ranked[:8]]
    return table(["scene", "setting", "gain, least and most over its cases"], rows)


def failures(study):
    rows = [[p["name"], p["outcome"], p["message"]] for p in study.points
            if not finished(p) and p["outcome"] != "not run"]
    missing = [p["name"] for p in study.points if p["outcome"] == "not run"]
    text = table(["point", "outcome", "message"], rows)
    if missing:
        text += f"\n\nNot run: {len(missing)} of {len(study.points)} points: {', '.join(missing)}."
    return text


def forecast_cells(row):
    """Case, threads, and foreseen / taken of steps and seconds, with what the forecast is off."""
    head = [row["case"], row["threads"]]
    if "failed" in row:
        return head + [f"**{row['failed']}**"] + [""] * 5
    cells = [f"{row['until']:g} of {row['end']:g}"]
    for key, number in (("steps", "{:,.0f}"), ("seconds", "{:.1f}")):
        wanted, got = row["foreseen"][key], row["taken"][key]
        cells += [f"{number.format(wanted)} / {number.format(got)}", f"{100 * (wanted / got - 1):+.0f}"]
    return head + cells + [f"{row['taken']['load']:.1f}"]


def speed_up(data):
    """What more threads gained, by the time of a step."""
    each = {(r["case"], r["threads"]): r["taken"]["seconds"] / r["taken"]["steps"]
            for r in data["rows"] if "failed" not in r}
    text = ""
    for threads in sorted({n for _, n in each if n > 1}):
        gains = [each[case, 1] / each[case, n] for case, n in each if n == threads and (case, 1) in each]
        if gains:
            text += (f" {threads} threads were {min(gains):.2f} to {max(gains):.2f} times as fast as one, "
                     f"in the geometric mean {np.exp(np.mean(np.log(gains))):.2f} times.")
    return text


def forecast_table(data):
    off = [abs(r["foreseen"]["seconds"] / r["taken"]["seconds"] - 1)
           for r in data["rows"] if "failed" not in r]
    text = f"Seconds within 20 % in {sum(x <= 0.2 for x in off)} of {len(data['rows'])} runs.{speed_up(data)}"
    return table(["case", "threads", "until (s)", "steps foreseen / taken", "off (%)",
                  "seconds foreseen / taken", "off (%)", "load before"],
                 [forecast_cells(row) for row in data["rows"]]) + "\n\n" + text
