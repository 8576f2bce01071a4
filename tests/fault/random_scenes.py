# SPDX-License-Identifier: MIT
"""Random small scenes for random_cases.py: make(seed) gives the text of a valid case."""
import math
import random

DP = 0.01


class Scene:
    """The sections of a case, written one after the other."""

    def __init__(self, seed):
        self.dice = random.Random(seed)
        self.top, self.numerics, self.output, self.domain = {}, {}, {}, {}
        self.sections, self.files, self.features = [], {}, set()
        self.sound_speed, self.end, self.laminar = 0.0, 0.0, False

    def chance(self, share):
        return self.dice.random() < share

    def number(self, low, high):
        return float(f"{self.dice.uniform(low, high):.4g}")

    def add(self, kind, name, rows):
        self.sections.append((kind, name, rows))

    def text(self):
        parts = ["".join(f"{key} = {value}\n" for key, value in self.top.items())]
        for name, rows in (("numerics", self.numerics), ("domain", self.domain),
                           ("output", self.output)):
            if rows:
                parts.append(f"[{name}]\n" +
                             "".join(f"{key} = {value}\n" for key, value in rows.items()))
        for kind, name, rows in self.sections:
            parts.append(f"[{kind} {name}]\n" +
                         "".join(f"{key} = {value}\n" for key, value in rows))
        return "\n".join(parts)


def box(x0, y0, x1, y1):
    return f"box {x0 * DP:.6g}, {y0 * DP:.6g}, {x1 * DP:.6g}, {y1 * DP:.6g}"


def numerics(s, fluid):
    """Integrator, scheme, precision and all that a case may say of its numerics."""
    d = s.dice
    s.top["integrator"] = d.choice(["symplectic", "verlet", "leapfrog"])
    s.top["scheme"] = d.choice(["paper", "standard"])
    s.top["precision"] = d.choice(["mixed", "mixed", "double"])
    s.features |= {s.top["integrator"], f"scheme {s.top['scheme']}", f"{s.top['precision']} "
                                                                     f"precision"}
    if s.chance(0.2):
        s.top["accuracy"] = d.choice(["draft", "fine"])
    for key, share, values in (("multirate", 0.4, ["on", "off"]), ("verlet_reset", 0.3, [3, 7, 40]),
                               ("skin", 0.3, [0.1, 0.3, 1]),
                               ("solid_precision", 0.3, ["single", "double"]),
                               ("solid_safety", 0.2, [0.5, 0.8])):
        if s.chance(share):
            s.numerics[key] = d.choice(values)
    if fluid:
        for key, share, values in (("suction", 0.3, ["on", "off"]), ("sides", 0.3, ["both", "one"]),
                                   ("h_over_dp", 0.2, [1.2, 1.5]), ("cfl", 0.2, [0.1, 0.15])):
            if s.chance(share):
                s.numerics[key] = d.choice(values)


def fluid_rows(s, shapes, surface=None, open_sides=False):
    """A fluid section; sound is fast enough for what happens in some dozen steps."""
    d = s.dice
    s.sound_speed = s.number(15, 40)
    rows = [*shapes, ("sound_speed", s.sound_speed), ("density", d.choice([1000, 800, 1025]))]
    if surface is not None and not open_sides:
        rows.append(("surface", surface * DP))
    rows.append(("artificial_viscosity", s.number(0.02, 0.1)))
    # Verlet's two-step form is refused with friction.
    s.laminar = (s.chance(0.4) or open_sides) and s.top["integrator"] != "verlet"
    if s.laminar:
        rows.append(("laminar_viscosity", s.number(1e-6, 1e-3)))
    if s.chance(0.6) or open_sides:
        rows.append(("density_diffusion", 0.1))
        form = "molteni" if open_sides else d.choice(["molteni", "fourtakas", "antuono"])
        rows.append(("diffusion_form", form))
        s.features.add(f"density diffusion, {form}")
    for key, share, values in (("tensile_control", 0.2, [0.2]), ("wall_repulsion", 0.3, [0.1]),
                               ("shifting", 0.3, [1, 2]), ("acoustic_damper", 0.2, [0.1, 0.2])):
        if s.chance(share):
            rows.append((key, d.choice(values)))
            s.features.add(key.replace("_", " "))
    return rows


def solid_rows(s, shape, clamp=None):
    d = s.dice
    density = s.number(900, 2500)
    rows = [("shape", shape), *([("clamp", clamp)] if clamp else []), ("density", density),
            ("young", s.number(2e5, 3e6)), ("poisson", s.number(0, 0.45)),
            ("law", d.choice(["paper", "svk", "neo_hookean"])),
            ("plane", d.choice(["strain", "stress"]))]
    s.features.add(f"law {rows[-2][1]}")
    for key, share, values in (("gradient", 0.3, ["linear"]), ("hourglass_form", 0.2, ["printed"]),
                               ("viscosity_form", 0.2, ["printed"]), ("damping_time", 0.2, [1e-5]),
                               ("slip", 0.2, ["none"]), ("gravity", 0.1, ["off"]),
                               ("artificial_viscosity", 0.3, [0, 0.1])):
        if s.chance(share) and (key != "slip" or s.laminar):
            rows.append((key, d.choice(values)))
    if s.chance(0.15):
        rows.append(("dp", "dp/2"))
        s.features.add("a spacing of its own")
    elif s.chance(0.15):
        rows.append(("lattice_angle", s.number(0, 0.7)))
        s.features.add("a turned lattice")
    return rows


def motion(s, name, speed):
    """A motion that starts where the body is, no faster than `speed`."""
    d = s.dice
    course = d.choice(["line", "parabola", "table", "sine", "turn", "kink"])
    rows = []
    v = [s.number(-speed, speed), s.number(-speed, speed)]
    if course == "line":
        rows += [("x", f"{v[0]}*t"), ("y", f"{v[1]}*t")]
    elif course == "parabola":
        rows += [("x", f"t*({v[0]} + t)"), ("y", f"{v[1]}*t")]
    elif course == "table":
        times = [k * s.end / 4 for k in range(6)]
        lines = "".join(f"{t:.6g}, {v[0] * t * t / times[-1]:.6g}, {v[1] * t * t / times[-1]:.6g}\n"
                        for t in times)
        s.files[f"{name}.csv"] = lines
        for column, key in ((2, "x"), (3, "y")):
            s.add("table", f"{name}_{key}", [("file", f"{name}.csv"), ("column", column),
                                             ("between", d.choice(["line", "cubic"]))])
            rows += [(key, f"{name}_{key}(t)")]
    elif course == "sine":
        period = s.number(2, 8) * s.end
        a = speed * period / (2 * math.pi)
        wave = f"sin(2*pi*t/{period} + {d.choice([0, -1.5707963])})"
        rows += [("x", f"{a * d.choice([-1, 0, 1]):.4g}*{wave}"), ("y", f"{a:.4g}*{wave}")]
    elif course == "turn":
        rows += [("centre", f"{s.number(0, 0.2)}, {s.number(0, 0.1)}"),
                 ("turn", f"{s.number(-1, 1) * speed / 0.3:.4g}*t")]
    else:
        rows += [("x", f"{v[0]}*min(t, {s.end}/2)"), ("y", f"{v[1]}*t^2/{s.end}"),
                 ("turn", f"{speed}*sin(t)")]
    if s.chance(0.3):
        rows += [("start", s.number(0.1, 0.5) * s.end)]
    s.features.add(f"motion by a {course}")
    s.add("motion", name, rows)


def probes(s, fluid, solids, at):
    """Up to four probes of any quantity that the scene has."""
    d = s.dice
    possible = ["energy"] if solids or fluid else []
    if fluid:
        possible += ["pressure", "velocity", "level", "front", "flux", "surface_pressure"]
    if solids:
        possible += ["displacement", "stress", "strain", "acceleration", "pose", "solid velocity"]
        possible += ["force"] if fluid else []
    if any(rows for name, shape, rows in solids if any(key == "clamp" for key, _ in rows)):
        possible += ["reaction"]
    for k in range(d.randrange(5)):
        what = d.choice(possible)
        rows = [("quantity", what.split()[-1])]
        point = f"{at[0] * DP:.4g}, {at[1] * DP:.4g}"
        if what in ("displacement", "stress", "strain", "acceleration", "pose", "solid velocity",
                    "reaction"):
            held = [one for one in solids if any(key == "clamp" for key, _ in one[2])]
            name, shape, _ = d.choice(held if what == "reaction" else solids)
            x0, y0, x1, y1 = shape
            rows.append(("body", name))
            point = f"{(x0 + x1) / 2 * DP:.6g}, {(y0 + y1) / 2 * DP:.6g}"
        if what == "force":
            rows.append(("body", d.choice([name for name, _, _ in solids])))
        if what == "energy" and solids:
            rows.append(("body", d.choice(solids)[0]))
        elif what == "energy":
            continue
        if what in ("flux", "surface_pressure"):
            rows.append(("to", f"{at[0] * DP:.4g}, {(at[1] + 10) * DP:.4g}"))
        if what == "front":
            rows.append(("direction", d.choice(["right", "left", "up", "down"])))
        if what not in ("energy", "front", "pose"):
            rows.append(("point", point))
        if s.chance(0.25):
            rows.append(("interval", f"end_time/{d.choice([5, 9])}"))
            s.features.add("a probe with its own interval")
        if s.chance(0.2):
            rows.append(("average", "end_time/20"))
            s.features.add("a probe that averages")
        s.features.add(f"probe of {what}")
        s.add("probe", f"p{k}", rows)


def outputs(s):
    d = s.dice
    s.output = {"probe_interval": f"end_time/{d.choice([10, 20])}",
                "ledger_interval": "end_time/10",
                "snapshot_interval": f"end_time/{d.choice([1, 2, 3])}",
                "checkpoint_interval": f"end_time/{d.choice([4, 6])}"}
    for key, share, values in (("snapshot_precision", 0.3, ["double"]),
                               ("snapshot_compression", 0.3, [0, 6])):
        if s.chance(share):
            s.output[key] = d.choice(values)


def gravity(s):
    g = s.dice.choice(["0, -9.81", "0, -9.81", "3, -9.81", f"{s.number(1, 5)}*sin(400*t), -9.81"])
    if "t" in g:
        s.features.add("gravity that changes")
    if s.chance(0.15):
        s.files["shake.csv"] = "0, 0\n0.001, 5\n0.002, -5\n1, 0\n"
        s.add("table", "shake", [("file", "shake.csv")])
        g = f"shake(t) + {g}"
        s.features.add("gravity from a table")
    s.top["gravity"] = g


def tank(s):
    """Fluid in a tank, with posts, gates or floating bodies in it, and a wall that moves."""
    width, depth = s.dice.randrange(14, 22), s.dice.randrange(7, 12)
    numerics(s, True)
    gravity(s)
    water = fluid_rows(s, [("shape", box(0, 0, width, depth))], depth)
    minus, solids = [], []
    if s.chance(0.75):
        for k in range(s.dice.choice([1, 1, 2])):
            x0 = (4 if k == 0 else width // 2 + 2)
            x1 = x0 + s.dice.choice([3, 4])
            free = s.chance(0.3)
            y0, y1 = (3, min(depth - 1, 7)) if free else (-4, s.dice.randrange(4, depth + 4))
            shape = (x0, y0, x1, y1)
            rows = solid_rows(s, box(*shape), None if free else box(x0, -4, x1, 0))
            if s.chance(0.2) and not free:
                rows.append(("clamp_motion", f"shake{k}"))
                s.features.add("a clamp that moves")
                motion(s, f"shake{k}", 0.3)
            minus.append(("minus", box(x0, max(y0, 0), x1, y1)))
            solids.append((f"post{k}", shape, rows))
            s.features.add("a floating body" if free else "a clamped body in the fluid")
    if len(solids) > 1:
        s.features.add("several solids")
    s.add("fluid", "water", [*water, *minus])
    wall = [("shape", box(-4, -4, 0, depth + 8)), ("shape", box(width, -4, width + 4, depth + 8)),
            ("shape", box(0, -4, width, 0))]
    wall += [("minus", box(x0, -4, x1, 0)) for _, (x0, y0, x1, y1), _ in solids if y0 < 0]
    if s.laminar and s.chance(0.4):
        wall.append(("slip", "none"))
    s.add("wall", "tank", wall)
    if s.chance(0.35):
        s.add("wall", "plunger",
              [("shape", box(width // 2 - 2, depth + 4, width // 2 + 2, depth + 8)),
                                  ("motion", "push")])
        motion(s, "push", 0.5)
    for name, shape, rows in solids:
        s.add("solid", name, rows)
    loads(s, solids)
    probes(s, True, solids, (1, 2))


def loads(s, solids):
    for name, (x0, y0, x1, y1), rows in solids:
        if s.chance(0.2) and not any(key in ("dp", "lattice_angle") for key, _ in rows):
            more = [("body", name), ("shape", box(x0, y1 - 1, x1, y1))]
            more.append(("force", "3, -2*cos(x/1 m)") if s.chance(0.5)
                        else ("traction", "40, -300"))
            if s.chance(0.5):
                more.append(("history", "min(t/0.002, 1)"))
            s.add("load", f"on_{name}", more)
            s.features.add("a load")


def channel(s):
    """Fluid over a bed, through periodic sides, over a sill or past a post."""
    width, depth = s.dice.randrange(16, 24), s.dice.randrange(7, 11)
    numerics(s, True)
    both = s.chance(0.3)
    s.features.add("periodic in x and y" if both else "periodic in x")
    if both:
        s.top["gravity"] = f"{s.number(-2, 2)}, 0"
        s.domain = {"lower": "0, 0", "upper": f"{width * DP:.6g}, {width * DP:.6g}",
                    "periodic": "xy"}
        waves = f"0.5*sin(2*pi*x/{width * DP:.6g} m)*cos(2*pi*y/{width * DP:.6g} m)"
        rows = fluid_rows(s, [("shape", box(0, 0, width, width)),
                              ("velocity", f"{waves}*1 m/s, -{waves}*1 m/s")])
        s.add("fluid", "water",
              [row for row in rows if row[1] != "antuono" or row[0] != "diffusion_form"])
        probes(s, True, [], (4, 4))
        return
    s.top["gravity"] = f"{s.number(0, 4)}, -9.81"
    top = depth + 3 if s.chance(0.5) else depth
    s.domain = {"lower": f"0, {-4 * DP:.6g}", "upper": f"{width * DP:.6g}, {(depth + 10) * DP:.6g}",
                "periodic": "x"}
    minus, walls, solids = [], [("shape", box(0, -4, width, 0))], []
    if top == depth:
        walls.append(("shape", box(0, depth, width, depth + 4)))
    water = fluid_rows(s, [("shape", box(0, 0, width, depth))], depth)
    choice = s.dice.choice(["sill", "drift", "post", "none"])
    if choice in ("sill", "drift"):
        minus = [("minus", box(6, 0, 10, 3))]
    if choice == "post":
        rows = solid_rows(s, box(7, -4, 10, 5), box(7, -4, 10, 0))
        rows = [row for row in rows if row[0] not in ("dp", "lattice_angle")]
        solids.append(("post", (7, -4, 10, 5), rows))
        minus = [("minus", box(7, 0, 10, 5))]
        walls.append(("minus", box(7, -4, 10, 0)))
    s.add("fluid", "water", [*water, *minus, ("velocity", f"{s.number(-1, 1)}, 0")])
    s.add("wall", "bed", walls)
    if choice in ("sill", "drift"):
        sill = [("shape", box(6, 0, 10, 3))]
        if choice == "drift":
            sill.append(("motion", "drift"))
            s.add("motion", "drift", [("x", f"{s.number(-1, 1)}*t")])
            s.features.add("a wall that moves through a periodic side")
        s.add("wall", "sill", sill)
    for name, _, rows in solids:
        s.add("solid", name, rows)
        s.features.add("a solid in a periodic channel")
    probes(s, True, solids, (3, 3))


def meeting(s):
    """Solids that fall on each other, on a floor and on bonded ones."""
    numerics(s, False)
    gravity(s)
    speed = s.number(0.5, 3)
    solids = [("base", (0, 0, 14, 4), solid_rows(s, box(0, 0, 14, 4), box(0, 0, 2, 4)))]
    for k in range(s.dice.choice([1, 2, 3])):
        x0, gap = 1 + 5 * k, s.dice.choice([0.5, 1, 2])
        shape = (x0, 4 + gap, x0 + 4, 8 + gap)
        rows = solid_rows(s, box(*shape))
        solids.append((f"drop{k}", shape,
                       [*rows, ("velocity", f"{s.number(-0.5, 0.5)}, {-speed}")]))
    if s.chance(0.3):
        plain = [row for row in solids[0][2]
                 if row[0] not in ("dp", "lattice_angle", "shape", "clamp")]
        solids[0] = (*solids[0][:2],
                     [row for row in solids[0][2] if row[0] not in ("dp", "lattice_angle")])
        solids.append(("cap", (14, 0, 18, 4),
                       [("shape", box(14, 0, 18, 4)), *plain, ("joined", "base")]))
        s.features.add("bonded solids")
    s.features |= {"contact", "several solids"}
    if s.chance(0.6):
        s.add("wall", "floor", [("shape", box(-4, -5, 22, -0.5))])
        s.features.add("contact with a wall")
    for name, _, rows in solids:
        s.add("solid", name, rows)
    if s.chance(0.6):
        rows = [("damping", s.number(0, 1)), ("friction", s.number(0, 0.6))]
        if s.chance(0.3):
            rows += [("stiffness", s.number(0.5, 3)), ("gap", s.dice.choice([0, "dp/4"]))]
        s.add("contact", "all", rows)
        s.features.add("friction")
    s.sound_speed = 60.0
    s.domain = {"lower": "-0.5, -0.5", "upper": "0.8, 0.8"}
    loads(s, solids)
    probes(s, False, solids, (2, 2))


def open_channel(s):
    """A channel with an inflow and an outflow, and perhaps a flap."""
    length, height = s.dice.randrange(18, 26), s.dice.randrange(8, 12)
    numerics(s, True)
    s.numerics["suction"] = "on"
    s.features.add("open boundaries")
    base = 2000
    water = fluid_rows(s, [("shape", box(0, 0, length, height))], open_sides=True)
    minus, walls, solids = [], [("shape", box(-8, -4, length + 8, 0)),
                                ("shape", box(-8, height, length + 8, height + 4))], []
    if s.chance(0.5):
        rows = solid_rows(s, box(8, -4, 11, 4), box(8, -4, 11, 0))
        solids.append(("flap", (8, -4, 11, 4),
                       [r for r in rows if r[0] not in ("dp", "lattice_angle")]))
        minus = [("minus", box(8, 0, 11, 4))]
        s.features.add("a flap between open boundaries")
    s.add("fluid", "water", [*water, *minus, ("pressure", base)])
    s.add("wall", "plates", [*walls, *([("slip", "none")] if s.laminar and s.chance(0.5) else [])])
    for name, _, rows in solids:
        s.add("solid", name, rows)
    top, speed = height * DP, s.number(0.1, 0.8)
    inlet = [("from", f"0, {top:.6g}"), ("to", "0, 0")]
    inlet.append(("velocity", f"{speed}*min(t/0.002, 1), 0") if s.chance(0.3) else
                 ("speed", f"{speed}*4*y*({top:.6g} - y)/{top:.6g}^2*min(t/0.001, 1)"))
    s.add("inflow", "left", inlet)
    outlet = [("from", f"{length * DP:.6g}, 0"), ("to", f"{length * DP:.6g}, {top:.6g}"),
              ("pressure", base)]
    if s.chance(0.5):
        outlet.append(("absorb", 0.05))
    s.add("outflow", "right", outlet)
    if solids:
        s.add("contact", "any", [("enabled", "off")])
    probes(s, True, solids, (4, 4))


def make(seed):
    """The case of a seed, the files that it reads, when it ends, and what it has."""
    s = Scene(seed)
    kind = s.dice.choice([tank, tank, channel, meeting, open_channel])
    s.top = {"dp": DP, "end_time": 0}
    s.end = s.dice.randrange(20, 80) * 1e-4
    s.top["end_time"] = f"{s.end:.4g}"
    kind(s)
    outputs(s)
    s.features.add(kind.__name__.replace("_", " "))
    return {"text": s.text(), "files": s.files, "end": s.end, "sound_speed": s.sound_speed,
            "features": sorted(s.features)}
