# SPDX-License-Identifier: MIT
"""Grids and samples of values for the runs of a sweep, and the table and the plot of what came
out."""
import itertools
import re

import matplotlib.pyplot as plt
import numpy as np

from .files import BadFile, Run
from .style import COLOURS

METRICS = {"final": lambda v: v[-1], "low": np.min, "high": np.max, "mean": np.mean,
           "largest": lambda v: v[np.argmax(np.abs(v))]}
NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")


def with_unit(text, key):
    found = NUMBER.match(text)
    if not found:
        raise BadFile(f"--vary {key}: '{text}' is not a number with its unit")
    return float(found[1]), found[2]


def as_text(value, unit):
    return f"{value:.10g} {unit}".strip()


def read_vary(text):
    """KEY, and its values as texts or its range (low, high, step or None, unit)."""
    key, equals, values = text.partition("=")
    key, values = key.strip(), values.strip()
    if not equals or not key or not values:
        raise BadFile(f"--vary {text}: not KEY=VALUES")
    if ":" not in values:
        return key, [value.strip() for value in values.split(",")]
    parts = [with_unit(part, key) for part in values.split(":")]
    units = {unit for _, unit in parts} - {""}
    if len(parts) not in (2, 3) or len(units) > 1:
        raise BadFile(f"--vary {key}: {values} is not LOW:HIGH:STEP in one unit")
    low, high, step = parts[0][0], parts[1][0], parts[2][0] if len(parts) == 3 else None
    if not low < high or (step is not None and not 0 < step <= high - low):
        raise BadFile(f"--vary {key}: {values} goes from no lower to a higher value by steps")
    return key, (low, high, step, "".join(units))


def grid(varied):
    """All combinations, the first key slowest."""
    levels = []
    for key, values in varied:
        if isinstance(values, tuple):
            low, high, step, unit = values
            if step is None:
                raise BadFile(f"--vary {key}: a grid needs the step of a range, LOW:HIGH:STEP")
            count = int((high - low) / step * (1 + 1e-12)) + 1
            values = [as_text(low + k * step, unit) for k in range(count)]
        levels.append(values)
    keys = [key for key, _ in varied]
    return [dict(zip(keys, combination)) for combination in itertools.product(*levels)]


def sample(varied, how, seed):
    """A Latin hypercube: each of N equal parts of every range is met once (McKay et al. 1979)."""
    found = re.fullmatch(r"lhs:(\d+)", how)
    if not found or int(found[1]) < 2:
        raise BadFile(f"--sample {how}: not lhs:N with N of 2 or more")
    n, random, columns = int(found[1]), np.random.default_rng(seed), {}
    for key, values in varied:
        share = (random.permutation(n) + random.random(n)) / n
        if isinstance(values, tuple):
            low, high, _, unit = values
            columns[key] = [as_text(float(f"{low + (high - low) * s:.6g}"), unit) for s in share]
        else:
            columns[key] = [values[int(s * len(values))] for s in share]
    return [dict(zip(columns, row)) for row in zip(*columns.values())]


def outcome(run):
    """Measures of every probe column, {"M1_dx_m:largest": value}."""
    found = {}
    try:
        curves = run.curves()
    except BadFile:
        return found
    for column, (_, values) in curves.items():
        values = values[np.isfinite(values)]
        if len(values):
            found.update((f"{column}:{name}", float(f(values))) for name, f in METRICS.items())
    return found


def read_rows(folder, runs):
    """A row for each run, of which number k is in folder/k."""
    rows = []
    for k, values in enumerate(runs):
        row = {"run": k, **values, "exit_reason": "missing", "wall_seconds": float("nan")}
        if (folder / str(k)).is_dir():
            run = Run(folder / str(k))
            row["exit_reason"] = run.summary.get("exit_reason", "running")
            row["wall_seconds"] = run.summary.get("wall_seconds", float("nan"))
            row.update(outcome(run))
        rows.append(row)
    return rows


def cell(value):
    text = f"{value:.9g}" if isinstance(value, float) else str(value)
    return f'"{text}"' if "," in text else text


def write_table(path, rows):
    names = list(dict.fromkeys(name for row in rows for name in row))
    lines = [",".join(names)] + [",".join(cell(row.get(name, "")) for name in names)
                                 for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def numbers(rows, key):
    """Values of a key and its unit; of words their places in the order in which they come."""
    texts = [row[key] for row in rows]
    found = [NUMBER.match(text) for text in texts]
    units = {match[2] for match in found if match}
    if all(found) and len(units) == 1:
        return np.array([float(match[1]) for match in found]), units.pop()
    words = list(dict.fromkeys(texts))
    return np.array([words.index(text) for text in texts], float), ", ".join(words)


def swings(keys, inputs, result):
    """What the result changes by when a value goes from its lowest to its highest, the others held:
    slopes of the plane of least squares times the ranges."""
    ranges = [np.ptp(inputs[key]) or 1.0 for key in keys]
    columns = [(inputs[key] - inputs[key].mean()) / width for key, width in zip(keys, ranges)]
    plane = np.column_stack([np.ones(len(result)), *columns])
    return dict(zip(keys, np.linalg.lstsq(plane, result, rcond=None)[0][1:]))


def draw(plan, rows):
    """What the result changes by with each value, and the result over each."""
    keys = list(plan["runs"][0])
    metric = plan["metric"] or next((name for row in rows for name in row
                                     if name.endswith(":largest")), None)
    if metric and not any(metric in row for row in rows):
        known = sorted({name for row in rows for name in row if ":" in name})
        raise BadFile(f"no run has {metric}; there are {', '.join(known)}")
    good = [row for row in rows if row["exit_reason"] == "finished" and metric in row]
    figure, axes = plt.subplots(1, 1 + len(keys), figsize=(2.6 * (1 + len(keys)), 2.6),
                                squeeze=False,
                                layout="constrained")
    if good:
        result = np.array([row[metric] for row in good])
        inputs = {key: numbers(good, key) for key in keys}
        swing = swings(keys, {key: values for key, (values, _) in inputs.items()}, result)
        order = sorted(keys, key=lambda key: abs(swing[key]))
        axes[0, 0].barh(order, [swing[key] for key in order],
                        left=[result.mean() - swing[key] / 2 for key in order], color=COLOURS[0])
        axes[0, 0].axvline(result.mean(), color="0.4", linewidth=0.8)
        axes[0, 0].set_xlabel(metric)
        axes[0, 0].use_sticky_edges = False
        axes[0, 0].margins(x=0.05)
        axes[0, 1].set_ylabel(metric)
        for place, key in zip(axes[0, 1:], keys):
            place.plot(inputs[key][0], result, "o", color=COLOURS[1], markersize=4)
            place.set_xlabel(f"{key} ({inputs[key][1]})" if inputs[key][1] else key)
    axes[0, 0].set_title(f"change from lowest to highest value\n{len(good)} of {len(rows)} runs "
                         f"finished")
    return figure
