# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures and table II of C.-H. Lee, Z. Huang & Y.-M. Chiew, Phys. Fluids 27
(2015) 113303. Case: examples/four_state_column.lua. Runs of table II start
from uniform solid fraction, as the paper's do; its printed run-outs are shorter
than those of its equations (docs/notes/four_state.md). Dotted lines of figure 7
are eqs. 30 and 31 with a factor of 1, as they print none."""
import math

from power_law import fit_one
from sweep import draw_law, set_log_axis
import plot_packing
import plot_state
import run_data
from papers.study import Row, make_panels, within
from matplotlib.colors import LogNorm
import numpy as np

LEVEL = 8  # leaves of 2.5 mm
LENGTH = {1: 0.102, 2: 0.056, 3: 0.01}  # L_i, m
HEIGHT = {1: 0.0612, 2: 0.1344, 3: 0.165}
TIMES = (0.5, 1, 2, 3)  # tau_c
SLOW, FAST = "#24639c", "#b5382b"

# Table II: parameter, values, what the paper prints for run-out and height, cm,
# and the sign of their change: 1 rises, -1 falls, 0 below 2 %
TABLE = (
    ("e_eff", (0.46, 0.70), "20.4 -> 21.5", "6.53 -> 6.45", 1, -1),
    ("eta_S", (0.30, 0.51), "23.5 -> 19.2", "5.32 -> 7.32", -1, 1),
    ("nu_max", (0.62, 0.64), "20.5 -> 20.9", "6.46 -> 6.50", 0, 0),
    ("nu_min", (0.565, 0.575), "20.7 - 21.0", "6.50 -> 6.45", 0, 0),
    ("nu_0", (0.59, 0.61), "21.0 -> 20.6", "6.50 -> 6.47", 0, 0),
    ("a", (0.18, 0.38), "21.0 -> 20.7", "6.45 -> 6.53", 0, 0),
    ("delta", (0.39, 0.77), "20.7 - 21.1", "6.52 -> 6.45", 0, 0),
    ("K", (1e5, 1e9), "20.5 - 20.7", "6.33 -> 6.53", 0, 1),
    ("chi", (1.5, 3.5), "20.7 -> 20.6", "6.58 -> 6.29", 0, -1),
    ("n", (1e3, 1e6), "20.9 -> 20.7", "6.48", 0, 0))
MOST = 0.02  # change of the run-out where the paper's is small


class Column:
    """The run of a column; lengths in m, times in tau_c."""

    def __init__(self, directory, length, height):
        self.directory = directory
        self.tau_c = math.sqrt(height / 9.81)
        series = run_data.read_series(directory)
        self.series, self.time = series, series["time"] / self.tau_c
        self.runout = series["front"][-1] - length
        self.height = series["height"][-1]


def level_of(study):
    """That of the paper, or of --cells to the length of case 2."""
    return LEVEL if study.cells is None else round(
        math.log2(study.cells * 0.64 / LENGTH[2]))


def column(study, case=2, **words):
    words = {"case": case, "level": level_of(study)} | words
    name = "-".join(["column"] + [f"{k}{v}" if isinstance(v, str) else
                                  f"{k}{v:g}" for k, v in words.items()])
    return Column(study.run("four_state_column", name, words),
                  words.get("length", LENGTH[case]),
                  words.get("height", HEIGHT[case]))


# Contours and speed, figures 3 to 5


def contours(case):
    def draw(study):
        run = column(study, case, stop=6)
        fig = plot_packing.make_figure([run.directory], TIMES, run.tau_c,
                                       r"$\tau_c$")
        rows = [Row("run-out, cm", 100 * run.runout,
                    "20.7" if case == 2 else ""),
                Row("height, cm", 100 * run.height,
                    "6.48" if case == 2 else "")]
        study.finish(fig, rows)
    return draw


# Solid fraction at the start and grid, figure 6


def figure_6(study):
    runs = {"0.575": column(study, stop=6, start="uniform", nu_start=0.575),
            "0.58": column(study, stop=6, start="uniform", nu_start=0.58)}
    runs["0.575, leaves of twice the size"] = column(
        study, stop=6, start="uniform", nu_start=0.575,
        level=level_of(study) - 1)
    fig = plot_packing.make_figure(
        [run.directory for run in runs.values()], TIMES,
        runs["0.575"].tau_c, r"$\tau_c$")
    first = runs["0.575"].runout + LENGTH[2]
    rows = [Row(f"front for nu_i = {name}, cm",
                100 * (run.runout + LENGTH[2]), "",
                within(100 * first, 3 * first)) for name, run in runs.items()]
    study.finish(fig, rows)


# Scaling, figure 7

ASPECTS = (0.5, 0.7, 1, 1.5, 2.4, 4, 6, 8, 12, 20)
RUNOUT_FROM, HEIGHT_FROM = 3, 0.7  # a_L, a_H of eqs. 30 and 31


def aspect(study, a):
    """A column 13.44 cm high, or 1.68 cm long where that is higher."""
    height = max(HEIGHT[2], 0.0168 * a)
    return column(study, length=height / a, height=height, stop=6,
                  snapshots=6)


def figure_7(study):
    a = np.array(ASPECTS)
    runs = [aspect(study, value) for value in a]
    length = np.array([max(HEIGHT[2], 0.0168 * v) / v for v in a])
    fig, axes = make_panels(2, 2)
    rows = []
    for ax, words, name, y, start, power in zip(
            axes, ("run-out", "height"), (r"$\Delta L/L_i$", "$H_f/L_i$"),
            (np.array([r.runout for r in runs]) / length,
             np.array([r.height for r in runs]) / length),
            (RUNOUT_FROM, HEIGHT_FROM), (2 / 3, 1 / 3)):
        above = a > start
        law = fit_one(a[above], y[above])
        draw_law(ax, "H_i/L_i", law, None, SLOW)
        ax.plot(a, y, "o", color=SLOW)
        for end, exponent in ((start, 1), (a[-1], power)):
            x = np.array([a[0] if exponent == 1 else start, end])
            ax.plot(x, start ** (1 - exponent) * x ** exponent, "k:", lw=0.8)
        set_log_axis(ax.xaxis, a)
        set_log_axis(ax.yaxis, y)
        ax.set(xlabel="$H_i/L_i$", ylabel=name)
        rows.append(Row(f"exponent of {words} above {start:g}", law.exponent,
                        f"{power:.2f}", within(power, 0.08)))
    study.finish(fig, rows)


# States, figure 8

PARTS = {1: (0.73, 0.20, 0.07), 2: (0.44, 0.46, 0.10)}


def figure_8(study):
    run = column(study, stop=6)
    paths = run_data.find_snapshots(run.directory)
    times = sorted(PARTS)
    fig = plot_state.make_figure(
        plot_state.nearest(paths, [t * run.tau_c for t in times]),
        [rf"{t} $\tau_c$" for t in times],
        run_data.Units(run_data.read_parameters(run.directory)), "state")
    rows = []
    for t in times:
        k = int(np.argmin(abs(run.time - t)))
        part = [run.series[name][k] for name in
                ("solid", "quasi_static", "dense", "inertial")]
        for name, ours, paper in zip(
                ("solid or quasi-static", "dense", "inertial"),
                (part[0] + part[1], part[2], part[3]), PARTS[t]):
            rows.append(Row(f"{name} at {t} tau_c", ours, f"{paper:g}",
                            within(paper, 0.05)))
    study.finish(fig, rows)


# The vacuum


CLOUD_AT = 2  # tau_c
WINDOW = (0, 0.64, 0, 0.12)  # m
COLDEST, HOTTEST = 1e-6, 100  # of the colours, m^2/s^2


def draw_cloud(ax, run):
    """T of all leaves with grains, and the contour nu = 0.1."""
    paths = run_data.find_snapshots(run.directory)
    snapshot = plot_state.nearest(paths, [CLOUD_AT * run.tau_c])[0]
    spacing = float((snapshot.high - snapshot.low).min())
    nu, T = (snapshot.sample(snapshot.fields[name], WINDOW, spacing)[2]
             for name in ("solid_fraction", "temperature"))
    T = np.where(nu > 1e-4, np.maximum(T, COLDEST), np.nan)
    picture = ax.imshow(T, origin="lower", extent=WINDOW, cmap="inferno",
                        norm=LogNorm(COLDEST, HOTTEST))
    ax.contour(nu, [0.1], extent=WINDOW, colors="#24639c", linewidths=0.8)
    ax.set_ylabel("height, m")
    return picture


def vacuum(study):
    """Where grains are few mu_K stays finite and dissipation falls as nu^2, so that
    T grows; long steps make a hot cloud of it, which holds the front back, unless
    production is bounded by what is taken from the flow."""
    runs = {"divided by 1 + (mean free path)/(10 d), T up to 1 m$^2$/s$^2$":
            column(study, stop=6),
            "as printed, T up to 100 m$^2$/s$^2$":
            column(study, stop=6, knudsen=1e30, T_max=100)}
    fig, axes = make_panels(2, 1, height=1.9, sharex=True)
    for ax, (words, run) in zip(axes, runs.items()):
        picture = draw_cloud(ax, run)
        ax.set_title(words, loc="left", fontsize=8)
    axes[-1].set_xlabel(f"x, m, at {CLOUD_AT} tau_c")
    fig.colorbar(picture, ax=list(axes), label="T, m$^2$/s$^2$")
    paper = list(runs.values())[1]
    study.finish(fig, [
        Row("run-out, divided, cm", 100 * list(runs.values())[0].runout, "",
            within(26.6, 1.5)),
        Row("run-out, as printed, cm", 100 * paper.runout, "20.7",
            within(20.7, 0.07 * 20.7))])


# Table II


def change_row(what, values, paper, sign):
    change = values[1] / values[0] - 1
    bar = {1: (0, math.inf), -1: (-math.inf, 0), 0: None}[sign]
    return Row(f"change of {what}, %", 100 * change, paper, bar)


def table_2(study):
    fig, axes = make_panels(2, 2, height=3.6, sharey=True)
    rows = []
    for k, (name, ends, runout, height, of_L, of_H) in enumerate(TABLE):
        runs = [column(study, start="uniform", stop=5, snapshots=5,
                       **{name: value}) for value in ends]
        for ax, values in zip(axes, ([r.runout for r in runs],
                                     [r.height for r in runs])):
            ax.plot(100 * np.array(values), [k, k], color="0.7", zorder=1)
            ax.scatter(100 * np.array(values), [k, k], c=[SLOW, FAST], s=18,
                       zorder=2)
        words = f"{name} {ends[0]:g} -> {ends[1]:g}"
        rows.append(change_row(f"run-out, {words}",
                               [r.runout for r in runs], runout, of_L
                               if name in ("e_eff", "eta_S") else 0))
        if name in ("K", "chi"):
            rows[-1] = rows[-1]._replace(bar=(-100 * MOST, 100 * MOST))
        rows.append(change_row(f"height, {words}", [r.height for r in runs],
                               height, of_H))
    axes[0].set_yticks(range(len(TABLE)),
                       [run_data.symbol(row[0]) for row in TABLE])
    axes[0].invert_yaxis()
    axes[0].set_xlabel(r"$\Delta L$ (cm)")
    axes[1].set_xlabel("$H_f$ (cm)")
    axes[1].set_title("blue: smallest value, red: largest", fontsize=8)
    study.finish(fig, rows)


FIGURES = {
    "3": ("contours of nu and speed, case 1", contours(1)),
    "4": ("contours of nu and speed, case 2", contours(2)),
    "5": ("contours of nu and speed, case 3", contours(3)),
    "6": ("solid fraction at the start and size of leaves", figure_6),
    "7": ("final height and run-out against the aspect ratio", figure_7),
    "8": ("states of the grains at tau_c and 2 tau_c", figure_8),
    "vacuum": ("temperature of the few grains outside", vacuum),
    "II": ("sensitivity of case 2 to the parameters", table_2)}
