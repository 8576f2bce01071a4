#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Separates incident and reflected waves of a run, from the levels that two or more probes record
(quantity = level). Waves run along x; incident ones towards larger x."""

import runfiles
from runfiles import BadFile, np, read_case
from sphfsi.waves import separate, wave_number

EXAMPLE = """examples:
  tools/waves.py runs/wave_flume --gauges near far --depth 0.4 --period 1 --from 10
  tools/waves.py runs/sea --gauges a b c --depth 2     all frequencies of an irregular sea
"""


def arguments():
    parser = runfiles.options(__doc__, EXAMPLE)
    parser.add_argument("run", nargs="?", metavar="RUN", help="folder of a run")
    parser.add_argument("--gauges", nargs="+", metavar="NAME", required=True,
                        help="two or more [probe] sections")
    parser.add_argument("--depth", type=float, required=True, metavar="D", help="of the water, m")
    parser.add_argument("--period", type=float, metavar="T",
                        help="of regular waves, s (default: all frequencies)")
    parser.add_argument("--from", type=float, default=0, metavar="TIME", dest="start",
                        help="use the levels from this time on, in s")
    return runfiles.parse(parser)


def place_of(run, gauge):
    for kind, name, keys in read_case(run.folder / "case.cfg"):
        if kind == "probe" and name == gauge:
            if keys.get("quantity") != "level":
                raise BadFile(f"{run.folder / 'case.cfg'}: [probe {gauge}] measures "
                              f"{keys.get('quantity', 'nothing')}, not the level")
            return float(keys["point"].split(",")[0].split()[0])
    raise BadFile(f"{run.folder / 'case.cfg'}: there is no [probe {gauge}]")


def main():
    args = arguments()
    run = runfiles.make_runs([args.run])[-1]
    places = [place_of(run, gauge) for gauge in args.gauges]
    table = run.table("probes.csv")
    late = table["time_s"] >= args.start
    if late.sum() < 3:
        raise BadFile(f"{run.folder / 'probes.csv'}: fewer than three rows from "
                      f"{args.start:g} s on")
    levels = [table[f"{gauge}_level_m"][late] for gauge in args.gauges]
    gravity = next(keys["gravity"] for kind, _, keys in read_case(run.folder / "case.cfg")
                   if kind == "top")
    waves = separate(table["time_s"][late], levels, places, args.depth, args.period,
                     float(np.hypot(*(float(g.split()[0]) for g in gravity.split(",")))))
    top = waves.frequency[np.argmax(waves.amplitude[:, 0])]
    length = 2 * np.pi / wave_number(2 * np.pi * top, args.depth)
    print(f"{run.label()}: incident height {1e3 * waves.incident:.4g} mm, reflected "
          f"{1e3 * waves.reflected:.4g} mm ({100 * waves.reflection:.3g} %), "
          f"{'period' if args.period else 'peak period'} {1 / top:.4g} s, length {length:.4g} m")


if __name__ == "__main__":
    runfiles.run_tool(main)
