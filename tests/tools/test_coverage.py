#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What tools/report/coverage.py counts as held, and how it tests the errors that --explain
foresees. Exit 77: a package is missing."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import ROOT, packages
with packages():
    import cffi  # noqa: F401  the package needs it
    import tomllib
    import coverage


def row(value, answer, band, **more):
    return {"problem": "p", "column": "c", "measure": "mean", "value": value, "answer": answer,
            "band": band, "known": 1e-6, **more}


def test_states():
    assert coverage.state(row(1.1, 1, 0.11)) == "held"
    assert coverage.state(row(1.1, 1, 0.09)) == "missed"
    assert coverage.state(row(1.1, 1, 0.09) | {"known": 0.02}) == "held"
    assert coverage.state(row(-1.1, -1, 1.2)) == "no result"
    assert coverage.state(row(1.1, 1, None)) == "no result"
    assert coverage.state(row(None, 1, None)) == "absent"


def test_answers():
    problem = {"let": {"w": "2*pi"}, "answer": {"a_fx_N_per_m mean": "w/pi"},
               "curve": {"b": "sin(w*t) + 3"}, "measures": ["peak", "frequency"]}
    found = coverage.answers(problem, 4.0)
    assert found["a_fx_N_per_m", "mean"] == 2.0, found
    assert abs(found["b", "peak"] - 4) < 1e-6 and abs(found["b", "frequency"] - 1) < 1e-5, found


def test_evidence():
    """Errors by particles across, coarse first; of other problems with as few or fewer particles,
    nine of ten must be as small."""
    problems = {"p": {"kind": "rest", "across": 0.4}, "q": {"kind": "rigid"}}
    rows = [row(1.1, 1, 1, dp=[0.1, 0.2], spacing=[1.1, 1.3], accuracy="standard"),
            row(1, 1, 1, dp=[0.1], spacing=[1.2], accuracy="standard") | {"problem": "q"}]
    lines = list(coverage.evidence(rows, problems))
    assert [line[0] for line in lines] == ["fluid"] * 2, lines
    assert [(line[4], line[6]) for line in lines] == [("2", "30"), ("4", "10")], lines
    others = [["fluid", "standard", f"o{k}", "c", "4", "", str(k)] for k in range(1, 21)]
    known, kept = coverage.evidence_coverage(others)
    assert known == 20 and kept == 18, (known, kept)
    assert coverage.evidence_coverage(others[:9]) == (0, 0)


def test_definition():
    """Every problem has a kind, a source, a case and an answer."""
    with open(ROOT / "tools" / "report" / "coverage.toml", "rb") as file:
        problems = tomllib.load(file)
    assert len(problems) >= 24, len(problems)
    for name, problem in problems.items():
        assert problem["kind"] in coverage.KINDS and problem["source"], name
        assert "case" in problem or (ROOT / problem["file"]).is_file(), name
        assert coverage.answers(problem, 1.0), name


def main():
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
    return 0


if __name__ == "__main__":
    sys.exit(main())
