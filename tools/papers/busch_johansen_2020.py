# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of A. Busch & S. T. Johansen, Powder Technol. 364 (2020) 429. Case:
examples/cliff.lua, with the closures critical_state and planes in the leaves of
the surface; closure=ktgf takes the paper's. A word that names a dimension of the
matrix (a, x_0, d, fluid, start, alpha) keeps those of its cases alone, as in

  tools/figure.py busch_johansen_2020 matrix x_0=0.1 fluid=water

Starts are settled; 0.55, loose; 0.60, dense: these two carry their weight by a
plastic packing, or are patched with closures that have none. Runs end at
LONGEST times sqrt(y_0/g'), at the latest at the paper's 4 s in air and 100 s in
liquids; stop= says otherwise. A run that fails is told of, and counts as none."""
import csv
import itertools
import math
import re
import subprocess
from typing import NamedTuple

import run_data  # first: it says so if one of the next is missing
import run_cases
from papers.study import EXAMPLES, Row, around, make_panels, shades
import numpy as np

ASPECTS = (1, 2, 3)
LENGTHS = (0.1, 1, 10)  # x_0, m
GRAINS = (1e-4, 1e-3, 1e-2)  # d, m
FLUIDS = {"air": (1.225, 1.79e-5), "water": (998, 1.002e-3),
          "pac2": (1000, 7.21e-2), "pac4": (1000, 0.214)}  # density, eta_0
STARTS = {"settled": {"start": "settled"},
          "0.55": {"start": "dense", "alpha": 0.55},
          "0.60": {"start": "dense", "alpha": 0.6}}
DIMENSIONS = ("a", "x_0", "d", "fluid", "start", "alpha")
SOLID, G = 2560, 9.81
CELLS = 25
LATEST = {"air": 4, "water": 100, "pac2": 100, "pac4": 100}  # s
LONGEST = 40  # sqrt(y_0/g')
REACH = {1: 6, 2: 10, 3: 12}  # of the box, x_0
MARKS = dict(zip(LENGTHS, "oDs"))
SIZES = dict(zip(GRAINS, (3, 5, 8)))
COLOURS = dict(zip(GRAINS, ("#24639c", "#8a5a22", "#b5382b")))

# s until the fluid has left a bed from 0.55 on, for x_0 = 0.1, 1, 10 m; beyond
# the end of the paper's runs a flat deposit is right (Terzaghi, 90 %)
EXPELLED = {
    ("air", 1e-4): (0.3, 4.5, 58), ("air", 1e-3): (0.006, 0.09, 1.2),
    ("air", 1e-2): (0.3, 0.3, 0.3), ("water", 1e-4): (20, 381, 5e3),
    ("water", 1e-3): (0.3, 5, 65), ("water", 1e-2): (0.04, 0.7, 10),
    ("pac2", 1e-4): (1.5e3, 3e4, 4e5), ("pac2", 1e-3): (15, 274, 4e3),
    ("pac2", 1e-2): (0.2, 3, 39), ("pac4", 1e-4): (4e3, 8e4, 1e6),
    ("pac4", 1e-3): (43, 814, 1e4), ("pac4", 1e-2): (0.4, 8, 110)}


# The laws: (x_f - x_0)/x_0 and y_f/y_0, eqs. 5 to 8, 11, 12


def lube_runout(a):
    return 1.6 * a if a < 2.3 else 2.2 * a ** (2 / 3)


def lube_height(a):
    return 1 if a < 1.15 else a ** -0.6


def inertial_runout(a):
    return 2.7 * a if a < 2 else 3.7 * a ** 0.64


def inertial_height(a):
    return 1 if a < 0.75 else 0.8 * a ** -0.65


def viscous_runout(a):
    return 1.5 * a if a < 2 else 1.9 * a ** 0.64


def viscous_height(a):
    return 1 if a < 0.75 else 0.87 * a ** -0.52


LAWS = (("Lube et al., eqs. 5, 6", lube_runout, lube_height, "0.6", "-"),
        ("free fall, inertial, eqs. 7, 8", inertial_runout, inertial_height,
         "k", "-"),
        ("viscous, eqs. 11, 12", viscous_runout, viscous_height, "k", ":"))


# Regimes, eqs. 9 and 10


def stokes_number(d, fluid):
    density, eta = FLUIDS[fluid]
    return math.sqrt(0.5 * SOLID * (SOLID - density) * G * d ** 3) / (18 * eta)


def density_ratio(fluid):
    return math.sqrt(SOLID / FLUIDS[fluid][0])


def regime(d, fluid):
    St, r = stokes_number(d, fluid), density_ratio(fluid)
    if r > 4 and St > 10:
        return "free fall"
    return "inertial" if St > 10 * min(r / 4, 1) else "viscous"


class Case(NamedTuple):
    """One of the matrix."""
    a: float
    x_0: float
    d: float
    fluid: str
    start: str

    def number(self):
        """That of table 3."""
        return 3 * LENGTHS.index(self.x_0) + GRAINS.index(self.d) + 1

    def words(self):
        return {"a": self.a, "x_0": self.x_0, "d": self.d,
                "fluid": self.fluid, **STARTS[self.start]}

    def can_rest(self):
        """Whether the fluid can leave in time."""
        time = EXPELLED[self.fluid, self.d][LENGTHS.index(self.x_0)]
        return time < LATEST[self.fluid]

    def runout_bar(self):
        """None where no law holds: grains of the viscous regime that are not
        dense float on what they press out."""
        kind = regime(self.d, self.fluid)
        if not self.can_rest() or (kind == "viscous" and self.start != "0.60"):
            return None
        if kind == "free fall":
            return 0.85 * lube_runout(self.a), 1.15 * inertial_runout(self.a)
        law = viscous_runout if kind == "viscous" else inertial_runout
        return around(law(self.a), 0.25)

    def height_bar(self):
        if not self.can_rest():
            return None
        viscous = regime(self.d, self.fluid) == "viscous"
        law = viscous_height if viscous else inertial_height
        return around(law(self.a), 0.25)

    def end(self):
        """When the run ends, s."""
        g = G * (1 - FLUIDS[self.fluid][0] / SOLID)
        time = LONGEST * math.sqrt(self.a * self.x_0 / g)
        return min(LATEST[self.fluid], float(f"{time:.2g}"))


class Cliff:
    """What a case came to; NaN if its run failed."""

    def __init__(self, case, directory):
        self.case, self.directory = case, directory
        self.runout = self.height = self.speed = math.nan
        self.steps = self.seconds = self.time = math.nan
        if directory is None:
            return
        series = run_data.read_series(directory)
        self.series = series
        self.runout = (series["front"][-1] - case.x_0) / case.x_0
        self.height = series["height"][-1] / (case.a * case.x_0)
        self.speed = series["max_flux"][-1] / math.sqrt(G * case.a * case.x_0)
        self.time, self.steps = series["time"][-1], series["step"][-1]
        self.seconds = series["wall_seconds"][-1]

    def rests(self):
        return self.speed < 1e-4


def value_of(text):
    try:
        return float(text)
    except ValueError:
        return text


def chosen(study, cases):
    """The cases that the words on the command line leave."""
    words = {k: value_of(v) for k, v in
             (w.split("=", 1) for w in study.words) if k in DIMENSIONS}
    return [case for case in cases if words.items() <= case.words().items()]


def words_of(study, case):
    words = {"stop": case.end(), "reach": REACH[case.a],
             "cells": study.cells or CELLS} | case.words()
    if "closure=ktgf" in study.words and "alpha" in words:
        words["start"] = "patched"
    return words


def cliff(study, case):
    """The run of a case, which may fail."""
    words = words_of(study, case)
    name = [f"a{case.a:g}", f"x{case.x_0:g}", f"d{case.d:g}", case.fluid,
            case.start]
    return Cliff(case, study.run("cliff", name_of(study, name), words,
                                 may_fail=True))


def name_of(study, parts):
    """The name of a run: what it is, its grid, and words that change it."""
    changed = [w.replace("=", "") for w in study.words
               if w.partition("=")[0] not in DIMENSIONS]
    return "-".join(parts + [f"cells{study.cells or CELLS}"] + changed)


def cliffs(study, fluids, starts, aspects=ASPECTS):
    cases = [Case(a, x_0, d, fluid, start) for fluid, start, a, x_0, d in
             itertools.product(fluids, starts, aspects, LENGTHS, GRAINS)]
    cases = chosen(study, cases)
    if not cases:
        run_cases.fail("no case of the matrix has " + " ".join(
            w for w in study.words if w.partition("=")[0] in DIMENSIONS))
    return [cliff(study, case) for case in cases]


# Rows


def count_row(what, kept):
    """How many of a list hold, of all: a bar."""
    return Row(what, sum(kept), f"of {len(kept)}", (len(kept), math.inf))


def inside(value, bar):
    return bar[0] <= value <= bar[1]


def law_rows(runs):
    """Run-outs and heights beside their laws, by aspect ratio."""
    rows = []
    for a in sorted({run.case.a for run in runs}):
        here = [run for run in runs if run.case.a == a]
        for what, bar in (("runout", "runout_bar"), ("height", "height_bar")):
            pairs = [(getattr(run, what), getattr(run.case, bar)())
                     for run in here]
            kept = [inside(*pair) for pair in pairs if pair[1]]
            if kept:
                rows.append(count_row(f"{what} within its law, a = {a:g}",
                                      kept))
    return rows


def rest_rows(runs):
    rest = [run.rests() for run in runs if run.case.can_rest()]
    rows = [count_row("runs at rest at the end", rest)] if rest else []
    failed = sum(run.directory is None for run in runs)
    return rows + [Row("runs that failed", failed, "", (0, 0))]


def loose_rows(runs):
    """In the viscous regime loose grains run farther than dense ones."""
    known = {run.case: run.runout for run in runs}
    longer = [runout > known[case._replace(start="0.60")]
              for case, runout in known.items()
              if case.start == "0.55" and case.can_rest()
              and regime(case.d, case.fluid) == "viscous"
              and case._replace(start="0.60") in known]
    return ([count_row("loose viscous beyond dense", longer)]
            if longer else [])


def ends_of(bar):
    return [f"{v:.4g}" for v in bar] if bar else ["", ""]


def write_runs(path, runs):
    with open(path, "w", newline="", encoding="utf-8") as f:
        writer = csv.writer(f, lineterminator="\n")
        writer.writerow(["fluid", "start", "a", "x_0", "d", "case", "St", "r",
                         "regime", "end", "runout", "lowest", "highest",
                         "height", "lowest_height", "highest_height",
                         "last_speed", "steps", "wall_seconds"])
        for run in runs:
            case = run.case
            writer.writerow(
                [case.fluid, case.start, case.a, case.x_0, case.d,
                 case.number(), f"{stokes_number(case.d, case.fluid):.4g}",
                 f"{density_ratio(case.fluid):.4g}",
                 regime(case.d, case.fluid), f"{run.time:.4g}",
                 f"{run.runout:.4g}",
                 *ends_of(case.runout_bar()), f"{run.height:.4g}",
                 *ends_of(case.height_bar()), f"{run.speed:.3g}", run.steps,
                 f"{run.seconds:.3g}"])


# Figure 4


def figure_4(study):
    fig, (ax,) = make_panels(1, height=4)
    rows = []
    for fluid, d in itertools.product(FLUIDS, GRAINS):
        answer = subprocess.run(
            [study.talus, "check", EXAMPLES / "cliff.lua", f"fluid={fluid}",
             f"d={d:g}"], capture_output=True, text=True).stdout
        St, r = map(float, re.search(
            r"St = (\S+), r = ([^\s:]+)", answer).groups())
        ax.plot(St, r, "o", ms=SIZES[d] + 2, color=COLOURS[d],
                mfc="none" if fluid == "air" else None)
        ax.annotate(f" {fluid}, {1e3 * d:g} mm", (St, r), fontsize=6,
                    rotation=45)
        rows.append(Row(f"St of {1e3 * d:g} mm in {fluid}", St, "",
                        around(stokes_number(d, fluid), 0.01)))
    ax.plot([10, 10, 1e5], [100, 4, 4], "k", lw=0.8)
    ax.plot([1e-4, 2.5, 10], [1, 1, 4], "k:", lw=0.8)
    for x, y, text in ((2e3, 30, "free fall"), (2e3, 2.2, "inertial"),
                       (2e-3, 12, "viscous")):
        ax.text(x, y, text, fontsize=8, color="0.4")
    ax.set(xscale="log", yscale="log", xlabel="St", ylabel="$r$",
           xlim=(3e-4, 1e5), ylim=(1, 120))
    study.finish(fig, rows)


# Figures 5 to 10


def draw_laws(axes, low=0.9, high=3.3):
    a = np.linspace(low, high, 200)
    for name, runout, height, colour, style in LAWS:
        for ax, law in zip(axes, (runout, height)):
            ax.plot(a, [law(v) for v in a], color=colour, ls=style, lw=1,
                    label=name)


def draw_runs(axes, runs):
    for run in runs:
        case = run.case
        shift = 1 + 0.02 * (case.number() - 5)
        style = {"marker": MARKS[case.x_0], "ms": SIZES[case.d],
                 "color": COLOURS[case.d], "ls": "none",
                 "mfc": None if case.can_rest() else "none"}
        axes[0].plot(case.a * shift, run.runout, **style)
        axes[1].plot(case.a * shift, run.height, **style)


def scaling(fluid, start):
    def draw(study):
        runs = cliffs(study, (fluid,), (start,))
        fig, axes = make_panels(2, 2, height=3.6)
        draw_laws(axes)
        draw_runs(axes, runs)
        for ax, text in zip(axes, ("$(x_f - x_0)/x_0$", "$y_f/y_0$")):
            ax.set(xlabel="$a$", ylabel=text, ylim=(0, None))
        axes[0].legend(fontsize=7)
        axes[1].set_title("$x_0$: circles 0.1, diamonds 1, squares 10 m\n$d$: "
                          "blue 0.1, brown 1, red 10 mm\nhollow: the fluid "
                          "cannot leave in time", fontsize=7)
        write_runs(study.output / f"fig{study.name}-runs.csv", runs)
        study.finish(fig, law_rows(runs) + rest_rows(runs))
    return draw


def matrix(study):
    """All there is."""
    runs = cliffs(study, FLUIDS, STARTS)
    write_runs(study.output / "matrix.csv", runs)
    fig, axes = make_panels(2, 2, height=4)
    for ax, what, bar, text in zip(
            axes, ("runout", "height"), ("runout_bar", "height_bar"),
            ("run-out", "height")):
        for name, colour in (("free fall", "#b5382b"),
                             ("inertial", "#8a5a22"), ("viscous", "#24639c")):
            pairs = [(np.mean(getattr(run.case, bar)()), getattr(run, what))
                     for run in runs if getattr(run.case, bar)()
                     and regime(run.case.d, run.case.fluid) == name]
            if pairs:
                ax.plot(*np.array(pairs).T, "o", ms=4, color=colour,
                        label=name)
        ends = np.array(ax.get_xlim())
        ax.plot(ends, ends, "k", lw=0.8)
        ax.set(xlabel=f"{text}, middle of its bar", ylabel=f"{text}, ours")
        ax.legend(fontsize=8)
    rows = []
    for fluid, start in itertools.product(FLUIDS, STARTS):
        here = [r for r in runs if (r.case.fluid, r.case.start)
                == (fluid, start)]
        rows += [row._replace(what=f"{fluid}, {start}: {row.what}")
                 for row in (law_rows(here) + rest_rows(here) if here else [])]
    slowest = np.nanmax([run.seconds for run in runs])
    study.finish(fig, rows + loose_rows(runs)
                 + [Row("longest run, s on the clock", slowest, "90")])


# Outlines in time, figures A.1 to A.16


def outlines(fluid, start, a, parts):
    def draw(study):
        runs = cliffs(study, (fluid,), (start,), (a,))
        fig, axes = make_panels(len(runs), 3, width=9, height=1.9)
        rows = []
        for ax, run in zip(axes, runs):
            ax.set_title(f"{run.case.number()}: $x_0$ = {run.case.x_0:g} m, "
                         f"$d$ = {1e3 * run.case.d:g} mm", fontsize=8)
            rows.append(Row(f"run-out of {run.case.number()}, over x_0",
                            run.runout))
            if run.directory is None:
                continue
            profiles = run_data.read_profiles(run.directory)
            near = [min(profiles, key=lambda p, t=t: abs(p.time - t))
                    for t in np.array(parts) * run.time]
            for p, colour in zip(near, shades(len(near))):
                ax.plot(np.r_[0, p.x], np.r_[p.height[0], p.height],
                        color=colour, lw=0.9, label=f"{p.time:.2g} s")
            ax.legend(fontsize=5)
            front = max(p.x[p.height > 0.01 * p.height.max()].max()
                        for p in near)
            ax.set(xlim=(0, 1.1 * front), ylim=(0, None))
        study.finish(fig, rows)
    return draw


# Fields at the top of the bed, figures 11, 12 and B.1 to B.10


def bed(study, a, x_0, d):
    """A bed behind its gate in air, after the 4 s of the paper's first run:
    (last snapshot, largest speed that it shows)."""
    words = {"a": a, "x_0": x_0, "d": d, "fluid": "air", "gate": 1,
             "closure": "ktgf", "stop": 4,
             "cells": study.cells or CELLS}
    name = name_of(study, ["bed", f"a{a:g}", f"x{x_0:g}", f"d{d:g}"])
    directory = study.run("cliff", name, words)
    snapshot = run_data.Snapshot(run_data.find_snapshots(directory)[-1])
    return snapshot, run_data.read_series(directory)


def frictional_pressure(alpha):
    """Eq. 35."""
    room = np.maximum(0.63 - alpha, 1e-3)
    return np.where(alpha > 0.5, 0.05 * (alpha - 0.5) ** 2 / room ** 5, 0)


def column_of(snapshot):
    """(height, {field: values}) of the column of leaves at the left side, from
    below."""
    low = snapshot.low
    first = low[:, 0] <= low[:, 0].min() + 1e-9
    order = np.nonzero(first)[0][np.argsort(low[first, 1])]
    y = 0.5 * (low + snapshot.high)[order, 1]
    return y, {k: v[order] for k, v in snapshot.fields.items()}


def profiles_of(snapshot):
    """(height, {title: values}) of what figures B.1 to B.10 show."""
    y, f = column_of(snapshot)
    p_f = frictional_pressure(f["solid_fraction"])
    p_s = f["solid_pressure"]
    gamma = np.maximum(f["shear_rate"], 1e-12)
    kinetic = p_s - p_f
    return y, {
        r"$\alpha_s$": f["solid_fraction"], "$p_s$ (Pa)": p_s,
        r"$\partial p_s/\partial y$": np.gradient(p_s, y),
        "$p_f$ (Pa)": p_f, r"$\partial p_f/\partial y$": np.gradient(p_f, y),
        "$p_{k/c}$ (Pa)": kinetic,
        r"$\partial p_{k/c}/\partial y$": np.gradient(kinetic, y),
        r"$\Theta$ (m$^2$/s$^2$)": f["temperature"],
        r"$\dot\gamma$ (1/s)": f["shear_rate"],
        r"$\eta_f$ (Pa s)": p_s * math.sin(math.pi / 4) / gamma,
        "$|u_s|$ (m/s)": np.linalg.norm(f[run_data.VELOCITY], axis=1)}


def draw_bed(study, a, x_0, d, names=None):
    snapshot, series = bed(study, a, x_0, d)
    y, values = profiles_of(snapshot)
    values = {k: v for k, v in values.items() if names is None or k in names}
    fig, axes = make_panels(len(values), min(len(values), 4), width=9,
                            height=2.6)
    for ax, (name, v) in zip(axes, values.items()):
        ax.plot(v, y / x_0, ".-", color="#24639c", lw=0.8, ms=3)
        ax.set(xlabel=name, ylabel="$y/x_0$", ylim=(0, 1.1 * a),
               xscale="log" if "eta" in name else "linear")
    speed = np.linalg.norm(snapshot.fields[run_data.VELOCITY], axis=1).max()
    study.finish(fig, [
        Row("largest speed of grains shown, m/s", speed,
            "0.47" if a == 3 else ""),
        Row("largest flux of grains, m/s", series["max_flux"][-1], "",
            (0, 1e-5))])


def figure_11(study):
    draw_bed(study, 2, 0.1, 1e-4, (r"$\eta_f$ (Pa s)", "$p_s$ (Pa)",
                                   r"$\Theta$ (m$^2$/s$^2$)"))


def figure_12(study):
    draw_bed(study, 3, 1, 1e-3, (r"$\alpha_s$", "$p_{k/c}$ (Pa)",
                                 "$|u_s|$ (m/s)"))


def figures_b(study):
    draw_bed(study, 3, 1, 1e-3)


# Levelling


def slope_of(profile):
    """The angle of an outline between a fifth and four fifths of the way from
    its wall to its front, degrees."""
    heap = profile.height > 0.02 * profile.height.max()
    front = profile.x[heap].max()
    part = (profile.x > 0.2 * front) & (profile.x < 0.8 * front)
    return -math.degrees(math.atan(np.polyfit(profile.x[part],
                                              profile.height[part], 1)[0]))


def levelling(study):
    """The paper's closures as printed, with the cap of Fluent and the solid
    fraction of leaves in them, beside ours."""
    case = Case(1, 0.1, 1e-3, "water", "settled")
    printed = {"closure": "ktgf", "surface": "none",
               "regularisation": "clip", "eta_max": 1e5}
    end = {"stop": 4, "reach": 8, "cells": study.cells or CELLS}
    fig, axes = make_panels(2, 1, width=7.5, height=2)
    rows = []
    for ax, (name, words) in zip(axes, (("as printed", printed),
                                        ("ours", {}))):
        directory = study.run(
            "cliff", name_of(study, ["levelling", name.replace(" ", "-")]),
            case.words() | end | words)
        profiles = run_data.read_profiles(directory)
        for p, colour in zip(profiles, shades(len(profiles))):
            ax.plot(p.x, p.height, color=colour, lw=0.9,
                    label=f"{p.time:.2g} s")
        ax.set_title(name, loc="left", fontsize=9)
        ax.set(xlim=(0, 8 * case.x_0), ylim=(0, None), ylabel="y (m)")
        half = profiles[len(profiles) // 2]
        rows += [Row(f"slope at the end, {name}, degrees",
                     slope_of(profiles[-1])),
                 Row(f"its change over the last half, {name}",
                     slope_of(profiles[-1]) - slope_of(half), "",
                     (-1, 1) if name == "ours" else None)]
    axes[0].legend(fontsize=6, ncol=3)
    rows.append(Row("slope as printed over ours", rows[0].ours / rows[2].ours,
                    "levels out", (-math.inf, 0.8)))
    study.finish(fig, rows)


FEW, MANY = (0, 0.25, 0.5, 0.75, 1), np.linspace(0, 1, 11)
FIGURES = {
    "4": ("regimes of the matrix", figure_4),
    **{name: (f"run-out and height in {fluid}, start {start}",
              scaling(fluid, start)) for name, fluid, start in (
        ("5", "air", "settled"), ("6", "air", "0.55"), ("7", "air", "0.60"),
        ("8", "water", "settled"), ("9", "water", "0.55"),
        ("10", "water", "0.60"))},
    "matrix": ("all 324 cases", matrix),
    **{f"A.{k + 1}": (f"outlines in {fluid}, start {start}, a = {a}",
                      outlines(fluid, start, a, parts))
       for k, (fluid, start, a, parts) in enumerate(
           [("air", "settled", a, FEW) for a in (2, 3)]
           + [("water", "settled", a, MANY) for a in (2, 3)]
           + [("air", "0.55", a, (0, 0.5, 1)) for a in ASPECTS]
           + [("water", "0.55", a, (0, 0.5, 1)) for a in ASPECTS]
           + [("air", "0.60", a, (0, 1)) for a in ASPECTS]
           + [("water", "0.60", a, MANY) for a in ASPECTS])},
    "11": ("viscosity, pressure, temperature of a bed at rest", figure_11),
    "12": ("top of a bed at rest", figure_12),
    "B": ("fields of a bed at rest, B.1 to B.10", figures_b),
    "levelling": ("a heap that levels out", levelling)}
