# SPDX-License-Identifier: MIT
"""The collected results of an accuracy study (results.json), and the tables of its report."""

import json

import common
from common import BadFile, np, read_text


def machine_text(m):
    return f"{m['cpu']}, {m['cores']} cores, {m['compiler']}"


CROSSING = "(z)"  # marks an error that is small because it changes its sign there
AIMS = (0.1, 0.05, 0.02, 0.01, 0.005)


# --- numbers of a point ---

def cost(p):
    """CPU s: the least of its runs, which other work on the machine disturbs least."""
    return max(1e-3, min(t["cpu"] for t in p["timing"]))


def seconds(p, key):
    """Median and spread over the repeats."""
    values = sorted(t[key] for t in p["timing"])
    middle = np.median(values)
    return f"{middle:.3g}" if len(values) == 1 \
        else f"{middle:.3g} ({values[0]:.3g}-{values[-1]:.3g})"


def main_error(case):
    return case["error"][0]["name"]


def finished(p):
    return p["outcome"] == "finished" and bool(p["timing"])


def percent(value):
    return "-" if value is None else f"{100 * value:.3g}"


def across(case, p):
    return case["across"] / p["dp"]


def against(error):
    """What an error is measured against."""
    return error.get("against", "own finest run" if error["kind"].endswith("finest") else "exact")


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

    def label(self, knob, value):
        """A setting by the keys of the case file."""
        return f"{self.knobs[knob].get('label', knob)} = {value}" if value else "defaults"

    def setting(self, p):
        return self.label(p["knob"], p["value"]) + (f" {CROSSING}" if self.crosses(p) else "")

    def crosses(self, p, error=None):
        """Whether a finer run with the same setting has a larger error: it changed its sign on the
        way, so the small value is a zero crossing, not an accuracy."""
        error = error or main_error(self.cases[p["case"]])
        own = p.get("errors", {}).get(error)
        return bool(own) and any(own < 0.9 * (q["errors"].get(error) or 0) for q in
                                 self.of(p["case"], p["knob"], p["value"])
                                 if finished(q) and q["level"] > p["level"])

    def of(self, case, knob=None, value=None):
        return [p for p in self.points if p["case"] == case and
                knob in (None, p["knob"]) and value in (None, p["value"])]

    def base(self, case):
        return [p for p in self.of(case, "base") if finished(p)]

    def error(self, p):
        """The main error of a point, None where there is none."""
        return p.get("errors", {}).get(main_error(self.cases[p["case"]])) if finished(p) else None

    def known(self, case):
        """Points of a case with an error to draw."""
        return [p for p in self.of(case) if self.error(p)]

    def front(self, case):
        """Points that no other one beats in both error and cost."""
        found, best = [], np.inf
        for p in sorted(self.known(case), key=cost):
            if self.error(p) < best:
                found.append(p)
                best = self.error(p)
        return found

    def slope(self, case, error):
        """b of error = a cost^-b along the resolutions of the defaults; None: it does not fall."""
        points = [(cost(p), p["errors"].get(error)) for p in self.base(case)]
        points = [(c, e) for c, e in points if e]
        if len(points) < 2:
            return None
        b = -np.polyfit(*np.log(points).T, 1)[0]
        return b if b > 0.05 else None

    def ratios(self, p, error):
        """Error and cost over those of the defaults at the same resolution; None where unknown."""
        base = next((b for b in self.base(p["case"]) if b["level"] == p["level"]), None)
        if not base or not finished(p) or not p["errors"].get(error) or \
            not base["errors"].get(error):
            return None
        return p["errors"][error] / base["errors"][error], cost(p) / cost(base)

    def gain(self, p, error):
        """How many times longer the defaults would take to the same error; None: unknown."""
        b, ratios = self.slope(p["case"], error), self.ratios(p, error)
        return ratios[0] ** (-1 / b) / ratios[1] if b and ratios else None


# --- tables ---

def table(head, rows):
    return common.table(head, rows) if rows else "None."


def aims_table(study):
    """The cheapest run whose main error is within some percent."""
    rows = []
    for case, entry in study.cases.items():
        cells = []
        for aim in AIMS:
            good = [p for p in study.known(case) if study.error(p) <= aim]
            p = min(good, key=cost, default=None)
            cells.append(f"{cost(p):.3g} s: {study.setting(p)}, {across(entry, p):.3g} particles"
                         if p else "-")
        rows.append([entry.get("title", case), main_error(entry), against(entry["error"][0]),
                     *cells])
    return table(["case", "error", "against"] + [f"{100 * aim:g} %" for aim in AIMS], rows)


def base_table(study, case):
    entry = study.cases[case]
    names = [e["name"] for e in entry["error"]]
    head = [entry.get("what", "across"), "dp (mm)"] + \
        [f"{e['name']} (%), against: {against(e)}" for e in entry["error"]] + \
        ["CPU s: median (spread)", "wall s", "million particle steps", "evaluations",
         "ns a particle step"]
    rows = []
    for p in study.of(case, "base"):
        if not finished(p):
            rows.append([f"level {p['level']}", f"**{p['outcome']}** {p['message']}"] +
                        [""] * (len(head) - 2))
            continue
        rows.append([f"{across(entry, p):.3g}", f"{1e3 * p['dp']:.4g}"] +
                    [percent(p["errors"].get(n)) + (f" {CROSSING}" if study.crosses(p, n) else "")
                     for n in names] +
                    [seconds(p, "cpu"), seconds(p, "wall"),
                     f"{1e-6 * p['particle_steps']:.3g}", f"{p['evaluations']:,}",
                     f"{1e9 * cost(p) / p['particle_steps']:.0f}"])
    return table(head, rows)


def halving_table(study):
    rows = []
    for case, entry in study.cases.items():
        for error, reference in [(e["name"], against(e)) for e in entry["error"]]:
            b = study.slope(case, error)
            points = sorted((p for p in study.base(case) if p["errors"].get(error)),
                            key=lambda p: -p["dp"])
            if len(points) < 2:
                continue
            order = np.polyfit(np.log([p["dp"] for p in points]),
                               np.log([p["errors"][error] for p in points]), 1)[0]
            rows.append([entry.get("title", case), error, reference,
                         f"{percent(points[0]['errors'][error])} to "
                         f"{percent(points[-1]['errors'][error])}", f"{order:.2f}",
                         f"{2 ** (1 / b):.1f}" if b else "refinement does not reduce it"])
    return table(["case", "error", "against", "coarsest to finest (%)", "power of dp",
                  "halving it costs x times"], rows)


def knob_rows(study, case, error):
    """(gain, knob, value, {level: cell}, whether all finished, whether any error is a zero
    crossing)."""
    for knob, entry in study.knobs.items():
        for value in entry["values"]:
            points = study.of(case, knob, value)
            if not points:
                continue
            cells, gains = {}, []
            for p in points:
                ratios = study.ratios(p, error)
                zero = f" {CROSSING}" if finished(p) and study.crosses(p, error) else ""
                cells[p["level"]] = f"**{p['outcome']}**" if not finished(p) else \
                    f"{ratios[0]:.2f} / {ratios[1]:.2f}{zero}" if ratios else "-"
                gains.append(study.gain(p, error))
            gains = [g for g in gains if g]
            yield (float(np.exp(np.mean(np.log(gains)))) if gains else 0, knob, value, cells,
                   all(finished(p) for p in points), any(study.crosses(p, error) for p in points))


def knob_table(study, case):
    entry = study.cases[case]
    rows = sorted(knob_rows(study, case, main_error(entry)), key=lambda r: -r[0])
    levels = sorted({level for r in rows for level in r[3]})
    fineness = {p["level"]: f"{across(entry, p):.3g} {entry.get('what', 'across')}"
                for p in study.of(case) if p["dp"]}
    head = [f"error / cost, {fineness.get(k, f'level {k}')}" for k in levels]
    return table(["setting", *head, "gain"], [
        [study.label(k, v)] + [cells.get(level, "") for level in levels] +
        ["-" if not g else "over 1000" if g > 1000 else f"{g:.3g}"]
        for g, k, v, cells, *_ in rows])


def failures(study):
    rows = [[p["name"], p["outcome"], p["message"]] for p in study.points
            if not finished(p) and p["outcome"] != "not run"]
    missing = [p["name"] for p in study.points if p["outcome"] == "not run"]
    text = table(["point", "outcome", "message"], rows)
    if missing:
        text += f"\n\nNot run: {len(missing)} of {len(study.points)} points: {', '.join(missing)}."
    return text


def forecast_cells(row):
    """Case, threads, and forecast / measured steps and seconds, with the error of the forecast."""
    head = [row["case"], row["threads"]]
    if "failed" in row:
        return head + [f"**{row['failed']}**"] + [""] * 5
    cells = [f"{row['until']:g} of {row['end']:g}"]
    steps, taken = row["foreseen"]["steps"], row["taken"]["steps"]
    for number, wanted, got, over in (
            ("{:,.0f}", steps, taken, steps / taken),
            ("{:.1f}", row["foreseen"]["seconds"], seconds_taken(row), forecast_over_run(row))):
        cells += [f"{number.format(wanted)} / {number.format(got)}", f"{100 * (over - 1):+.0f}"]
    cells[-1] = cells[-1] if is_long(row) else f"({cells[-1]})"
    return head + cells + [f"{row['taken']['load']:.1f}"]


def seconds_taken(row):
    """CPU time of one thread, wall time of more."""
    return row["taken"]["cpu" if row["threads"] == 1 else "seconds"]


def forecast_over_run(row):
    """Median over pairs of a forecast and the run after it: a slow minute takes both."""
    return float(np.median([foreseen / (cpu if row["threads"] == 1 else wall)
                            for foreseen, cpu, wall in row["each"]]))


def is_long(row):
    """Whether a run is no short one, of which start and end are a large part."""
    return "failed" not in row and seconds_taken(row) >= 0.5


def forecast_table(data):
    ratio = {f"{row['case']} on {row['threads']}":
             1 / forecast_over_run(row)
             for row in data["rows"] if is_long(row)}
    off = [f"{name} {100 * (1 / x - 1):+.0f} %" for name, x in ratio.items()
           if abs(1 / x - 1) > 0.15]
    failed = sum("failed" in r for r in data["rows"])
    low, high = np.quantile(list(ratio.values()) or [1], [0.05, 0.95])
    text = (f"The seconds are right within 15 % in {len(ratio) - len(off)} of {len(ratio)} runs. "
            f"The others: {', '.join(off) or 'none'}. Nine of ten runs took "
            f"{low:.2f} to {high:.2f} times the forecast. Not among these are runs below half a "
            "second, with errors in brackets: start and end are a large part of them."
            f"{f' {failed} failed.' * (failed > 0)}")
    return table(["case", "threads", "until (s)", "steps forecast / measured", "error (%)",
                  "seconds forecast / measured", "error (%)", "load before"],
                 [forecast_cells(row) for row in data["rows"]]) + "\n\n" + text
