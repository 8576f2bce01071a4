# SPDX-License-Identifier: MIT
"""Tables of the accuracy study's report."""

import common
from common import np
from study_results import CROSSING, across, against, cost, finished, main_error, percent, seconds

AIMS = (0.1, 0.05, 0.02, 0.01, 0.005)


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


def cheapest(study, points, aim):
    """Cost and text of the cheapest point within an error; zero crossings only where nothing else
    is."""
    good = sorted((study.crosses(p), cost(p)) for p in points if (study.error(p) or np.inf) <= aim)
    return (good[0][1],
            f"{good[0][1]:.3g} s{f' {CROSSING}' if good[0][0] else ''}") if good else (None, "-")


def schemes_table(study):
    """What an error costs with either scheme of the fluid, and what a step does."""
    rows = []
    for case, entry in study.cases.items():
        paper, standard = study.of(case, "scheme", "paper"), study.of(case, "base")
        if not paper:
            continue
        cells = []
        for aim in AIMS[1:4]:
            (new, say_new), (old, say_old) = cheapest(study, standard, aim), cheapest(study, paper,
                                                                                      aim)
            cells.append(f"{say_new} / {say_old}" + (f" = {new / old:.2f}" if new and old else ""))
        errors = [" to ".join(percent(study.error(p)) for p in (points[0], points[-1]))
                  for points in ([p for p in of if study.error(p)] for of in (standard, paper))
                  if points]
        steps = [cost(p) / p["particle_steps"] / (cost(q) / q["particle_steps"])
                 for p, q in zip(standard, paper) if finished(p) and finished(q)]
        rows.append([entry.get("title", case), main_error(entry), *errors, *cells,
                     f"{np.median(steps):.2f}" if steps else "-"])
    return table(["case", "error", "standard, coarsest to finest (%)", "paper (%)",
                  *(f"{100 * aim:g} %: standard / paper" for aim in AIMS[1:4]), "particle step"],
                 rows)


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
                    [f"{seconds(p, 'cpu')} {study.marks(p)}", seconds(p, "wall"),
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
        [study.label(k, v)] + [cells.get(level, "") for level in levels] + [gain_text(g)]
        for g, k, v, cells, *_ in rows])


def ranked_knobs(study, scene):
    """(least gain, largest gain, knob, value, whether any error is a zero crossing), best first."""
    found, crossed = {}, set()
    for case in (c for c in study.cases if study.cases[c]["scene"] == scene):
        for gain, knob, value, _, sound, zero in knob_rows(study, case,
                                                           main_error(study.cases[case])):
            found.setdefault((knob, value), []).append(gain if sound else 0)
            crossed |= {(knob, value)} if zero else set()
    return sorted(((min(g), max(g), *k, k in crossed) for k, g in found.items() if min(g) > 0),
                  reverse=True)


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
    for number, wanted, got in (
            ("{:,.0f}", row["foreseen"]["steps"], row["taken"]["steps"]),
            ("{:.1f}", row["foreseen"]["seconds"], seconds_taken(row))):
        cells += [f"{number.format(wanted)} / {number.format(got)}",
                  f"{100 * (wanted / got - 1):+.0f}"]
    cells[-1] = cells[-1] if is_long(row) else f"({cells[-1]})"
    return head + cells + [f"{row['taken']['load']:.1f}"]


def seconds_taken(row):
    """CPU time of one thread, wall time of more."""
    return row["taken"]["cpu" if row["threads"] == 1 else "seconds"]


def is_long(row):
    """Whether a run is no short one, of which start and end are a large part."""
    return "failed" not in row and seconds_taken(row) >= 0.5


def speed_up(data):
    """The speed-up by more threads, from the time of a step."""
    each = {(r["case"], r["threads"]): r["taken"]["seconds"] / r["taken"]["steps"]
            for r in data["rows"] if "failed" not in r}
    text = ""
    for threads in sorted({n for _, n in each if n > 1}):
        gains = [each[case, 1] / each[case, n] for case, n in each if n == threads and
                 (case, 1) in each]
        if gains:
            text += (f" {threads} threads were {min(gains):.2f} to {max(gains):.2f} times as fast "
                     f"as one, {np.exp(np.mean(np.log(gains))):.2f} times in the geometric mean.")
    return text


def forecast_table(data):
    ratio = {f"{row['case']} on {row['threads']}":
             seconds_taken(row) / row["foreseen"]["seconds"]
             for row in data["rows"] if is_long(row)}
    off = [f"{name} {100 * (1 / x - 1):+.0f} %" for name, x in ratio.items()
           if abs(1 / x - 1) > 0.15]
    failed = sum("failed" in r for r in data["rows"])
    low, high = np.quantile(list(ratio.values()) or [1], [0.05, 0.95])
    text = (f"The seconds are right within 15 % in {len(ratio) - len(off)} of {len(ratio)} runs. "
            f"The others: {', '.join(off) or 'none'}. Nine of ten runs took "
            f"{low:.2f} to {high:.2f} times the forecast. Not among these are runs below half a "
            "second, with errors in brackets: start and end are a large part of them."
            f"{f' {failed} failed.' * (failed > 0)}{speed_up(data)}")
    return table(["case", "threads", "until (s)", "steps forecast / measured", "error (%)",
                  "seconds forecast / measured", "error (%)", "load before"],
                 [forecast_cells(row) for row in data["rows"]]) + "\n\n" + text
