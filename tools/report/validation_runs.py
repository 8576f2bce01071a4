# SPDX-License-Identifier: MIT
"""The runs of the validation: which there are, whether they are up to date, and running them."""

import fcntl
import shutil
import subprocess
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor

from common import ROOT, BadFile, Run, last_line, read_text, sentence, settings
from validation_measures import NotRun
from validation_sound import ENDED, check_ended

FOLDER = ROOT / "runs" / "validation"
PRINTED_SOLID = ["{}.gradient=linear", "{}.hourglass_form=printed"]

# Rough seconds of a run with ratio = 1 or dp = 1 mm by leapfrog, or by the integrator of its file,
# which go with the cube of the resolution: enough to begin with the longest. Other cases take
# seconds.
SECONDS = {"cantilever": 6e-3, "hydrostatic_plate": 8e4, "gate": 35, "wet_baffle": 1000,
           "sluice_gate": 1350,
           "still_water": 7000, "verify/standing_wave": 4e-4, "verify/elastica": 4e-2}
SLOWER = {"verlet": 1.6, "symplectic": 3.5}


class Spec:
    """A run: a case, the settings over it, what is different about it in words, and whether it
    belongs to the quick selection."""

    def __init__(self, name, case, sets=(), words="", quick=False):
        self.name, self.case, self.sets = name, ROOT / "cases" / f"{case}.cfg", list(sets)
        self.words, self.quick, self.folder = words, quick, FOLDER / name
        keys = dict(item.split("=", 1) for item in self.sets)
        across = float(keys["ratio"]) if "ratio" in keys else 1 / float(keys.get("dp",
                                                                                 "10").split()[0])
        self.cost = SECONDS.get(case, 0) * across ** 3 * SLOWER.get(keys.get("integrator"), 1)

    def arguments(self):
        return settings(self.sets)


def all_integrators(name, case, sets, words, quick=False):
    """The same run with the paper's two integrators and with leapfrog, which has a longer step."""
    return [Spec(name, case, [*sets, "integrator=symplectic"], f"{words}, symplectic", quick),
            Spec(f"{name}-verlet", case, [*sets, "integrator=verlet"], f"{words}, Verlet", quick),
            Spec(f"{name}-leapfrog", case, [*sets, "integrator=leapfrog"], f"{words}, leapfrog",
                 quick)]


def cantilevers():
    fine = "output.snapshot_interval=10 ms"
    specs = [Spec(f"cantilever-{n}", "cantilever", [f"ratio={n}", fine], f"ts/dp = {n}", n < 40)
             for n in (10, 20, 40, 80)]
    specs += [Spec(f"cantilever-{n}-kappa{k}", "cantilever", [f"ratio={n}", f"plate.hourglass={k}"],
                   f"ts/dp = {n}, kappa = {k}", n == 10)
              for n in (10, 20, 40, 80) for k in (0, 1, 10)]
    specs += [Spec(f"cantilever-{n}-symplectic", "cantilever",
                   [f"ratio={n}", fine, "integrator=symplectic"],
                   f"ts/dp = {n}, symplectic", n == 10) for n in (10, 20)]
    specs += [Spec(f"cantilever-{n}-printed", "cantilever",
                   [f"ratio={n}", "plate.viscosity_form=printed",
                    *(s.format("plate") for s in PRINTED_SOLID)],
                   f"ts/dp = {n}, Eqs. 13, 17 and 18 as printed", n == 10) for n in (10, 20)]
    return specs


def plates():
    def at(size):
        return [f"dp={size} mm"]
    return [*all_integrators("plate", "hydrostatic_plate", at("6.25"), "dp = 6.25 mm"),
            *all_integrators("plate-12.5mm", "hydrostatic_plate", at("12.5"), "dp = 12.5 mm", True),
            Spec("plate-3.125mm-leapfrog", "hydrostatic_plate",
                 [*at("3.125"), "integrator=leapfrog"],
                 "dp = 3.125 mm, leapfrog"),
            Spec("plate-12.5mm-h1.5", "hydrostatic_plate",
                 [*at("12.5"), "integrator=leapfrog", "numerics.h_over_dp=1.5"],
                 "dp = 12.5 mm, leapfrog, h/dp = 1.5"),
            Spec("plate-h1.5", "hydrostatic_plate",
                 [*at("6.25"), "integrator=leapfrog", "numerics.h_over_dp=1.5"],
                 "dp = 6.25 mm, leapfrog, h/dp = 1.5"),
            Spec("plate-printed", "hydrostatic_plate",
                 [*at("6.25"), "integrator=verlet", "plate.viscosity_form=printed"],
                 "dp = 6.25 mm, Verlet, Eq. 18 as printed")]


def gates():
    coarse = ["dp=1 mm", "integrator=leapfrog"]
    printed = ["gate.viscosity_form=printed", *(s.format("gate") for s in PRINTED_SOLID)]

    def changed(name, sets, words, quick=False):
        return Spec(f"gate-1mm-{name}", "gate", [*coarse, *sets], f"dp = 1 mm, leapfrog, {words}",
                    quick)
    return [*all_integrators("gate", "gate", ["dp=0.5 mm"], "dp = 0.5 mm"),
            *all_integrators("gate-1mm", "gate", ["dp=1 mm"], "dp = 1 mm", True),
            Spec("gate-0.25mm-leapfrog", "gate", ["dp=0.25 mm", "integrator=leapfrog"],
                 "dp = 0.25 mm, leapfrog"),
            changed("printed", printed, "Eqs. 13, 17 and 18 as printed"),
            changed("plane-stress", ["gate.plane=stress"], "plane stress", True),
            changed("neo-hookean", ["gate.law=neo_hookean"], "neo-Hookean"),
            changed("kappa10", ["gate.hourglass=10"], "kappa = 10"),
            changed("h1.5", ["numerics.h_over_dp=1.5"], "h/dp = 1.5"),
            changed("alpha0.05", ["water.artificial_viscosity=0.05"], "alpha = 0.05"),
            changed("cfl0.2", ["numerics.cfl=0.2"], "C_CFL = 0.2"),
            changed("cfl0.5", ["numerics.cfl=0.5"], "C_CFL = 0.5"),
            *[Spec(f"gate-1mm-{integrator.lower()}-cfl{cfl}", "gate",
                   ["dp=1 mm", f"integrator={integrator.lower()}", f"numerics.cfl={cfl}"],
                   f"dp = 1 mm, {integrator}, C_CFL = {cfl}")
              for integrator, cfl in (("symplectic", 0.4), ("Verlet", 0.1), ("Verlet", 0.3))]]


def single_rates():
    """Without sub-steps of the solid: gate whole, plate over its first swings."""
    return [Spec(f"single-{name}{suffix}", case, [*sets, f"integrator={integrator.lower()}",
                                                  "numerics.multirate=off"],
                 f"{words}, {integrator}, single rate")
            for name, case, sets, words in (
                ("gate-1mm", "gate", ["dp=1 mm"], "gate, dp = 1 mm"),
                ("plate-12.5mm", "hydrostatic_plate", ["dp=12.5 mm", "end_time=0.1 s"],
                 "plate, dp = 12.5 mm"))
            for suffix, integrator in (("", "symplectic"), ("-verlet", "Verlet"))]


def at_2mm(prefix, case, at, name, sets, words):
    """The effect of the assumptions in cases without a measured curve."""
    return Spec(f"{prefix}-2mm-{name}", case, [*at(2, "integrator=leapfrog"), *sets],
                f"dp = 2 mm, leapfrog{words}")


def baffles():
    def at(size, *sets):
        return [f"dp={size} mm", "output.snapshot_interval=25 ms", *sets]

    def changed(name, sets, words):
        return at_2mm("baffle", "wet_baffle", at, name, sets, words)
    return [*all_integrators("baffle", "wet_baffle", at(1), "dp = 1 mm"),
            *all_integrators("baffle-2.5mm", "wet_baffle", at(2.5), "dp = 2.5 mm"),
            *all_integrators("baffle-4mm", "wet_baffle", at(4), "dp = 4 mm", True),
            changed("leapfrog", [], ""), changed("embedded", ["embedded=16 mm"], ", 64 mm free"),
            changed("slow", ["lift_speed=0.75 m/s"], ", plate lifted at 0.75 m/s"),
            changed("fast", ["lift_speed=6 m/s"], ", plate lifted at 6 m/s")]


def sluices():
    def at(size, *sets):
        return [f"dp={size} mm", *sets]

    def changed(name, sets, words):
        return at_2mm("sluice", "sluice_gate", at, name, sets, words)
    return [*all_integrators("sluice", "sluice_gate", at(1), "dp = 1 mm"),
            *all_integrators("sluice-2.5mm", "sluice_gate", at(2.5), "dp = 2.5 mm"),
            *all_integrators("sluice-5mm", "sluice_gate", at(5), "dp = 5 mm", True),
            *[Spec(f"sluice-{name}", "sluice_gate",
                   [*at(size), f"integrator={integrator.lower()}", "water.wall_repulsion=0"],
                   f"dp = {size} mm, {integrator}, without repulsion")
              for name, size,
              integrator in (("bare", 1, "symplectic"), ("bare-verlet", 1, "Verlet"),
                                             ("2.5mm-bare-verlet", 2.5, "Verlet"))],
            changed("leapfrog", [], ""), changed("opening10", ["opening=10 mm"], ", opening 10 mm"),
            changed("opening40", ["opening=40 mm"], ", opening 40 mm"),
            changed("slow", ["lift_speed=1 m/s"], ", plate lifted at 1 m/s"),
            changed("viscous", ["water.artificial_viscosity=0.06"], ", alpha = 0.06")]


def verifications():
    still = ["end_time=10 s", "wall=4*dp", "output.snapshot_interval=1 s"]
    kept = "water.diffusion_form=fourtakas"
    specs = [Spec(f"still-{name}-{h}", "still_water",
                  [*still, f"dp={size} mm", f"numerics.h_over_dp={h}", *extra],
                  f"dp = {size} mm, h/dp = {h}{words}", size == 10)
             for size, name, extra, words in (
                 (10, "10mm-printed", ["water.diffusion_form=molteni"], ", Eq. 6 as printed"),
                 (10, "10mm", [kept], ", Fourtakas"),
                 (10, "10mm-c20", [kept, "water.max_speed=2*sqrt(g*H)"], ", Fourtakas, c0 = 20 "
                     "sqrt(gH)"),
                 (5, "5mm", [kept], ", Fourtakas"))
             for h in (1.35, 1.5)]
    specs += [Spec(f"wave-{n}-{h}", "verify/standing_wave",
                   [f"ratio={n}", f"numerics.h_over_dp={h}"], f"H/dp = {n}, h/dp = {h}", n < 40)
              for h in (1.35, 1.5) for n in (10, 20, 40)]
    specs += [Spec(f"wave-20-1.5-{name}", "verify/standing_wave",
                   ["ratio=20", "numerics.h_over_dp=1.5", setting], f"H/dp = 20, h/dp = 1.5, "
                                                                    f"{words}", True)
              for name, setting, words in (
                  ("symplectic", "integrator=symplectic", "symplectic"),
                  ("c20", "water.max_speed=2*sqrt(g*H)", "c0 = 20 sqrt(gH)"),
                  ("small", "a=0.01", "amplitude 10 mm"),
                  ("diffusion", "water.density_diffusion=0.01", "delta = 0.01"),
                  ("viscous", "water.artificial_viscosity=0.05", "alpha = 0.05"),
                  ("suction", "numerics.suction=on", "walls may pull"))]
    specs += [Spec(f"wave-{n}-{h}", "verify/standing_wave",
                   [f"ratio={n}", f"numerics.h_over_dp={h}"],
                   f"H/dp = {n}, h/dp = {h}", n < 40)
              for h in (1.6, 1.7, 1.8, 2) for n in (20, 40)]
    specs += [Spec(f"taylor-green-{n}", "verify/taylor_green", [f"ratio={n}"], f"L/dp = {n}",
                   n < 100)
              for n in (25, 50, 100)]
    # Morris et al. 1997 for the viscosity, and particles evened out at stagnation points, too.
    evened = ["water.artificial_viscosity=0", "water.laminar_viscosity=nu", "numerics.h_over_dp=2",
              "water.shifting=10", "water.shifting_speed=largest"]
    specs += [Spec(f"taylor-green-{n}-shifted", "verify/taylor_green", [f"ratio={n}", *evened],
                   f"L/dp = {n}, laminar viscosity, h/dp = 2, shifted", n < 100)
              for n in (25, 50, 100)]
    specs += [Spec("taylor-green-50-unshifted", "verify/taylor_green", ["ratio=50", *evened[:3]],
                   "L/dp = 50, laminar viscosity, h/dp = 2", True)]
    specs += [Spec(f"front-{n}", "verify/dam_break_front", [f"ratio={n}"], f"a/dp = {n}", n < 80)
              for n in (20, 40, 80)]
    specs += [Spec(f"front-40-square", "verify/dam_break_front", ["ratio=40", "n2=1"],
                   "a/dp = 40, square column", True)]
    specs += [Spec(f"impact-{n}-{h}", "verify/dam_break_impact",
                   [f"ratio={n}", f"numerics.h_over_dp={h}"], f"H/dp = {n}, h/dp = {h}", n < 60)
              for n in (30, 60) for h in (1.35, 2)]
    specs += [Spec(f"block-{n}", "verify/rotating_block", [f"ratio={n}", "turns=1"], f"L/dp = {n}",
                   n == 10) for n in (10, 20)]
    specs += [Spec(f"elastica-{n}", "verify/elastica", [f"ratio={n}"], f"thickness/dp = {n}",
                   n < 16)
              for n in (4, 8, 16)]
    specs += [Spec(f"bar-{n}", "verify/stretched_bar", [f"ratio={n}"], f"thickness/dp = {n}", True)
              for n in (5, 10, 20)]
    return specs


SPECS = [*cantilevers(), *plates(), *gates(), *single_rates(), *baffles(), *sluices(),
         *verifications()]
BY_NAME = {spec.name: spec for spec in SPECS}


# What earlier versions wrote where nothing was named and no case can hold now.
RETIRED = ("interface = auto", "interface = impedance", "gradients = plain")


def physics(text):
    """Lines of an effective case that the results depend on: comments name the program, the paths
    of files the place where it ran, and numerics.skin says only when particles are sorted."""
    return [line for line in text.splitlines()
            if line.strip() and
            not line.startswith(("#", "file ", "title ", "source ", "label ", "skin "))]


def holds_results(folder):
    """Whether the program recognises the folder as that of a run."""
    return any(path.suffix == ".ckpt" or path.name in ("summary.json", "probes.csv", "ledger.csv",
                                                       "fields.vtkhdf", "case.cfg")
               for path in (folder.iterdir() if folder.is_dir() else ()))


def refuses_checkpoint(done):
    """Whether the program ended because of the checkpoint that it should continue from."""
    text = last_line(done)
    return done.returncode in (1, 2) and ("checkpoint" in text or ".ckpt" in text) and \
        "no memory" not in text


def summary_time(folder):
    """When the summary was written, or None."""
    path = folder / "summary.json"
    return path.stat().st_mtime_ns if path.exists() else None


def is_busy(folder):
    """Whether a run holds the lock of its folder."""
    try:
        with open(folder / ".lock", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:  # no lock, or a file system that knows none
        return False
    return False


class Program:
    """The program under validation."""

    def __init__(self, path):
        self.path, self.cases = str(path), {}
        try:
            done = subprocess.run([self.path, "--version"], capture_output=True, text=True,
                                  check=True)
        except (OSError, subprocess.CalledProcessError):
            raise BadFile(f"cannot run {path}; build it with make") from None
        self.version = done.stdout.split()[-1]

    def effective(self, case, *arguments):
        """The effective case of a file and settings, as text."""
        done = subprocess.run([self.path, "--effective", str(case), *arguments],
                              capture_output=True,
                              text=True, check=False)
        if done.returncode:
            raise BadFile(f"{case}: {last_line(done)}")
        return done.stdout

    def means(self, spec, text):
        """Whether the effective case of a run, which another version may have written, is what the
        specification means now: the present program gives keys that were not there, or that held
        what is no longer known, their defaults."""
        meant = (spec.case, *spec.arguments())
        if meant not in self.cases:
            try:
                self.cases[meant] = self.effective(*meant)
            except BadFile as problem:
                raise BadFile(f"{spec.name}: {problem}") from None
        now = self.cases[meant]
        if physics(text) == physics(now):
            return True
        files = iter([line for line in now.splitlines() if line.startswith("file ")])
        lines = [next(files, line) if line.startswith("file ") else line
                 for line in text.splitlines()
                 if line not in RETIRED]
        with tempfile.NamedTemporaryFile("w", suffix=".cfg", encoding="utf-8") as old:
            old.write("\n".join([*lines, ""]))
            old.flush()
            try:
                return physics(self.effective(old.name)) == physics(now)
            except BadFile:
                return False


class Runner:
    """Runs what is not up to date, several at a time with a thread each: a run gives the same bits
    on any number of threads, and separate runs share no barrier. `kept`: the kept results, which
    count as run unless `again`; `keep`: those of the longer runs are kept as they end."""

    def __init__(self, program, kept, any_version=False, again=False, keep=False):
        self.program, self.kept, self.lock = program, kept, threading.Lock()
        self.any_version, self.again, self.keep = any_version, again, keep
        self.failed = {}

    def state(self, spec):
        """How a run stands: new, finished, ended (and would end again), interrupted, or other: what
        is there cannot be used; and why not."""
        if not holds_results(spec.folder):
            return "new", ""
        try:
            run, case = Run(spec.folder), read_text(spec.folder / "case.cfg")
        except BadFile as problem:
            return "other", f"it is damaged: {problem}"
        if not self.program.means(spec, case):
            return "other", "it is of another case than is meant now"
        reason, version = run.summary.get("exit_reason"), run.summary.get("version", "unknown")
        if reason not in ENDED and not list(spec.folder.glob("*.ckpt")):
            return "other", "it was interrupted and has no checkpoint"
        if not self.any_version and version != self.program.version:
            return "other", \
                f"it is by version {version}, not {self.program.version} (--any-version takes it)"
        if reason not in ENDED:
            return "interrupted", ""
        try:
            check_ended(run)
        except BadFile as problem:
            return "other", f"it is damaged: {problem}"
        return ("finished" if reason == "finished" else "ended"), ""

    def is_kept(self, spec):
        try:
            self.kept.find(spec)
        except NotRun:
            return False
        return True

    def run(self, spec):
        try:
            state, why = self.state(spec)
            if state not in ("finished", "ended"):
                if not self.again and self.is_kept(spec):
                    return
                self.compute(spec, state, why)
            self.store(spec)
        except Exception as problem:  # the other runs go on
            text = sentence(problem)
            self.say(f"{spec.name}: {text}")
            self.failed.setdefault(spec.name, text)

    def compute(self, spec, state, why):
        if state == "other":
            self.discard(spec, why)
        goes_on, before = state == "interrupted", summary_time(spec.folder)
        done = self.start(spec, goes_on)
        # What it says of checkpoints once it has begun comes with a new summary.
        if goes_on and refuses_checkpoint(done) and summary_time(spec.folder) == before:
            self.discard(spec, f"the program does not go on from it: {last_line(done)}")
            done = self.start(spec, False)
        if done.returncode:
            self.failed[spec.name] = last_line(done)
            self.say(f"{spec.name} failed: {last_line(done)}")

    def start(self, spec, goes_on):
        self.say(f"{'continues' if goes_on else 'runs'} {spec.name}: {spec.words}")
        command = [self.program.path, str(spec.case), "--out", str(spec.folder), "--quiet",
                   "--threads", "1",
                   *spec.arguments(), *(["--restart"] if goes_on else [])]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def discard(self, spec, why):
        """Removes the folder of a run that cannot be used, and says why."""
        if is_busy(spec.folder):
            raise BadFile(f"{spec.folder}: another process writes there; wait for it, or use other "
                          f"--runs")
        self.say(f"discards {spec.folder}: {why}; {spec.name} is run anew")
        shutil.rmtree(spec.folder)

    def store(self, spec):
        """Keeps the result of a longer run that has ended, if that is wanted."""
        if not self.keep or spec.quick or not holds_results(spec.folder):
            return
        try:
            if Run(spec.folder).summary.get("exit_reason") in ENDED:
                path = self.kept.store(spec)
                self.say(f"kept {spec.name}: {path.stat().st_size / 1000:.0f} kB")
        except Exception as problem:  # the other runs are kept
            self.say(f"{spec.name} is not kept: {sentence(problem)}")

    def say(self, text):
        with self.lock:
            print(text, flush=True)

    def run_all(self, specs, jobs):
        with ThreadPoolExecutor(jobs) as pool:
            list(pool.map(self.run, specs))
