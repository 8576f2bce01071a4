# SPDX-License-Identifier: MIT
"""Targets of docs/performance.md: seconds of whole runs beside those of other programs, and
nanoseconds, shares and bytes of the bench. The other programs' seconds are given, not measured by
`make performance`."""

# Work as WORK of performance.py names it, what a peer takes for it, the target: (what, limit).
RUNS = [
    ("gate, dp = 1 mm, leapfrog", "SPHinXsys 73 s (c0 = 20 sqrt(gH)), 94 s (40 sqrt(gH))",
     ("seconds", 12)),
    ("gate, dp = 0.5 mm, leapfrog", "DualSPHysics 5.4: 19.2 ms a step of 61,000 particles",
     ("ms", 1.7)),
    ("gate, dp = 0.5 mm, leapfrog", "SPHinXsys about 530 s; DualSPHysics near 2 hours",
     ("seconds", 90)),
    ("cantilever, ts/dp = 10", "SPHinXsys 12.5 s, period 9 % long", ("seconds", 2)),
    ("cantilever, ts/dp = 20", "SPHinXsys 77 s, period 6 % long", ("seconds", 10)),
    ("cantilever, ts/dp = 20", "SPHinXsys 5.4 to 6.3 million particle steps a second",
     ("rate", 30)),
    ("hydrostatic plate, leapfrog", "SPHinXsys about 920 s", ("seconds", 150)),
]
UNITS = {"seconds": "s", "ms": "ms a fluid step", "rate": "million particle steps a second"}


def verdict(met):
    return "met" if met else "**missed**"


def run_rows(found):
    """found: {(words, threads): {"seconds", "ms", "rate"}} of the runs on all threads."""
    rows = []
    for words, peer, (what, limit) in RUNS:
        value = found.get(words, {}).get(what)
        least = what == "rate"
        sign = "at least" if least else "at most"
        target = f"{sign} {limit} {UNITS[what]}"
        if value is None:
            rows.append((words, peer, target, "no result", "not run"))
            continue
        rows.append((words, peer, target, f"{value:.3g}",
                     verdict(value >= limit if least else value <= limit)))
    return rows


def share(phases, *names):
    return 100 * sum(phases.get(name, 0) for name in names) / sum(phases.values())


def bench_rows(value, sizes, shares, speed):
    """value(what, variant, particles, threads, part) of the bench, nan where there is none; shares:
    {words: seconds by phase} of whole runs; speed: how much faster all threads are, steps alone and
    in all."""
    rows, small, large = [], sizes[0], sizes[-1]

    def add(words, found, limit, unit, least=False):
        if found == found:  # not nan
            rows.append((words, "", f"{'at least' if least else 'at most'} {limit:g} {unit}",
                         f"{found:.3g}",
                         verdict(found >= limit if least else found <= limit)))
    add("pair sweep with viscosity and diffusion, one thread",
        value("fluid", "dam_break (mixed)", small, 1,
                                                                     "fluid"), 45, "ns")
    add("pair sweep, bare, one thread", value("fluid", "bare (mixed)", small, 1, "fluid"), 30, "ns")
    add("the same in double precision", value("fluid", "bare (double)", small, 1, "fluid"), 80,
        "ns")
    add("solid, one thread", value("solid", "default (mixed)", None, 1, "step"), 50,
        "ns a particle and step")
    add(f"memory, {large} particles", value("fluid", "dam_break (mixed)", large, 1, "memory"), 250,
        "bytes a fluid particle")
    costs = [value("fluid", "dam_break (mixed)", n, 1, "all") for n in sizes]
    add(f"all phases a particle, most over least of {', '.join(map(str, sizes))} particles, one "
        f"thread",
        max(costs) / min(costs), 1.15, "times")
    for words, phases in shares.items():
        add(f"sorting and cells: {words}", share(phases, "sort"), 8, "% of the time")
        add(f"output and checkpoints: {words}", share(phases, "output"), 3, "% of the time")
    for words, times in speed.items():
        add(f"two threads against one, gate with dp = 0.5 mm, {words}", times, 1.85,
            "times as fast", True)
    return rows
