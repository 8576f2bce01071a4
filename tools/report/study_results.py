# SPDX-License-Identifier: MIT
"""The collected results of an accuracy study (results.json), and what follows from them."""

import json

from common import BadFile, np, read_text


def machine_text(m):
    return f"{m['cpu']}, {m['cores']} cores, {m['compiler']}"


CROSSING = "(z)"  # marks an error that is small because it changes its sign there


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

    def threads(self):
        return self.definition["study"].get("threads", 1)

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

    def base_at(self, case, level):
        return next((p for p in self.base(case) if p["level"] == level), None)

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
        base = self.base_at(p["case"], p["level"])
        if not base or not finished(p) or not p["errors"].get(error) or \
            not base["errors"].get(error):
            return None
        return p["errors"][error] / base["errors"][error], cost(p) / cost(base)

    def gain(self, p, error):
        """How many times longer the defaults would take to the same error; None: unknown."""
        b, ratios = self.slope(p["case"], error), self.ratios(p, error)
        return ratios[0] ** (-1 / b) / ratios[1] if b and ratios else None

    def busy(self, p):
        """Whether its timings were taken beside other work than the study's own."""
        return any(t["load"] > self.threads() * (t.get("beside", 0) + 1) + 0.3 for t in p["timing"])

    def beside(self, p):
        """Whether they were taken beside another run of the study."""
        return any(t.get("beside") for t in p["timing"])

    def marks(self, p):
        return "".join(mark for mark, is_so in (("†", self.busy), ("‡", self.beside)) if is_so(p))
