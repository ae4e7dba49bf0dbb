# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of L. Valette et al., Sensitivity to the rheology
and geometry of granular collapses by using the mu(I) rheology, Comput. Fluids
191 (2019). Case: examples/sensitivity.lua; cylinders are in cylinders.py."""
import math

from power_law import fit_one, fit_two
from sweep import draw_law, set_log_axis
import plot
import run_data
from papers import cylinders
from papers.study import Row, around, make_panels, shades, within
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

MU_S = (0.32, 0.42, 0.52, 0.62)
DELTA_MU = (0.18, 0.28, 0.38, 0.48)
I0 = (0.04, 0.4, 4)
USUAL = {"mu_s": 0.32, "delta_mu": 0.28, "I0": 0.4}
TALL, SHORT, TALLEST = 10, 1.42, 50
ASPECTS = (0.5, 0.7, 1, SHORT, 2, 3, 4.5, 7, TALL, 14, 20, 30, TALLEST)
BREAK = 7  # eq. 9
FALL = math.sqrt(2)  # sqrt(h/g): of a free fall from h
COLOURS = ("#24639c", "#8a5a22", "#b5382b", "#3d7d3a")
TIMES = (0, 0.5, 1, 1.25, 1.5, 1.75, 2, 2.5, 3, 4, 5)
X, Y, T = "$x/r_i$", "$h/r_i$", r"$t/\sqrt{h_i/g}$"
RUNOUT = r"$(r_f - r_i)/r_i$"


def collapse(study, a, **changed):
    """The run of a column, with one parameter of the friction changed or
    none; without, it has snapshots where a figure wants them."""
    changed = {k: v for k, v in changed.items() if v != USUAL[k]}
    shown = not changed and a in (SHORT, TALL, TALLEST)
    output = {"times": ",".join(f"{t:g}" for t in TIMES),
              "every": 0.1 if shown else 0}
    reach = 1.3 * (1 + max(2.4 * a, 0) if a < BREAK else 1.3 + 5 * a ** 0.7)
    return study.collapse("sensitivity", a, reach, 16, output, **changed)


def collapses(study, a, key, values):
    return [collapse(study, a, **{key: value}) for value in values]


def runouts(runs):
    return np.array([run.runout for run in runs])


# Sensitivities, figures 5 to 13


def draw_profiles(study, a, key, values):
    """Outlines of the deposits."""
    runs = collapses(study, a, key, values)
    fig, (ax,) = make_panels(1, height=3.2)
    for run, value, colour in zip(runs, values, COLOURS):
        ax.plot(*run.outline(), color=colour,
                label=f"{run_data.symbol(key)} = {value:g}")
    ax.set(xlabel=X, ylabel=Y, ylim=(0, None),
           xlim=(0, 1.03 * max(run.front[-1] for run in runs)))
    ax.legend()
    rows = [Row(f"{quantity}, {key} = {value:g}", getattr(run, quantity))
            for quantity in ("runout", "height")
            for run, value in zip(runs, values)]
    return fig, rows, runs


def friction_at_rest(a):
    def draw(study):
        fig, rows, runs = draw_profiles(study, a, "mu_s", MU_S)
        rows.append(Row("run-out at 0.52 over 0.62",
                        runs[2].runout / runs[3].runout, "1.2"))
        study.finish(fig, rows)
    return draw


def rise_of_friction(a):
    def draw(study):
        fig, rows, runs = draw_profiles(study, a, "delta_mu", DELTA_MU)
        heights = [run.height for run in runs]
        rows.append(Row("spread of heights over their mean",
                        np.ptp(heights) / np.mean(heights), "independent"))
        study.finish(fig, rows)
    return draw


def fronts(key, values):
    def draw(study):
        runs = collapses(study, SHORT, key, values)
        fig, (ax,) = make_panels(1)
        for run, value, colour in zip(runs, values, COLOURS):
            ax.plot(run.time, run.front, color=colour,
                    label=f"{run_data.symbol(key)} = {value:g}")
        ax.set(xlabel=T, ylabel=X)
        ax.legend()
        rows = [Row(f"front at {t}, largest over smallest",
                    np.divide(*np.sort([np.interp(t, run.time, run.front)
                                        for run in runs])[[-1, 0]]))
                for t in (1, 2, 4)]
        study.finish(fig, rows)
    return draw


def draw_laws(study, key, values, aspects, paper):
    """Run-out against a parameter of the friction, with power laws; `paper`
    has what is said of the exponent."""
    fig, (ax,) = make_panels(1)
    x, rows, exponents = np.array(values), [], []
    for a, colour in zip(aspects, COLOURS):
        y = runouts(collapses(study, a, key, values))
        law = fit_one(x, y)
        draw_law(ax, key, law, None, colour)
        ax.plot(x, y, "o", color=colour)
        rows.append(Row(f"exponent, a = {a:g}", law.exponent, paper))
        exponents.append(law.exponent)
    y = np.concatenate([line.get_ydata() for line in ax.lines])
    set_log_axis(ax.xaxis, x)
    set_log_axis(ax.yaxis, y)
    ax.set(xlabel=run_data.symbol(key), ylabel=RUNOUT)
    handles, names = ax.get_legend_handles_labels()
    ax.legend(handles, [f"a = {a:g}: {n}" for a, n in zip(aspects, names)])
    return fig, rows, exponents


def law_of_friction_at_rest(study):
    fig, rows, _ = draw_laws(study, "mu_s", MU_S, (SHORT, TALL), "-1.2")
    study.finish(fig, rows)


def law_of_rise(study):
    fig, rows, exponents = draw_laws(study, "delta_mu", DELTA_MU,
                                     (SHORT, TALL), "a quarter of mu_s's")
    rows.append(Row("short over tall", exponents[0] / exponents[1], "> 1"))
    study.finish(fig, rows)


def law_of_I0(study):
    fig, rows, _ = draw_laws(study, "I0", I0, (SHORT,), "0.11")
    study.finish(fig, rows)


# Geometry, figure 14


def law_of_aspect(study):
    runs = [collapse(study, a) for a in ASPECTS]
    a, y = np.array(ASPECTS), runouts(runs)
    below, above = fit_two(a, y, BREAK)
    fig, (ax,) = make_panels(1, height=4)
    for law, colour, factor, power in ((below, COLOURS[0], 1.72, 0.97),
                                       (above, COLOURS[1], 2.96, 0.69)):
        draw_law(ax, "a", law, BREAK, colour)
        x = np.array([law.low, law.high])
        ax.plot(x, factor * x ** power, ls=":", color=colour,
                label=f"paper: {factor} $a^{{{power}}}$")
    ax.plot(a, y, "o", color="#222222")
    set_log_axis(ax.xaxis, a)
    set_log_axis(ax.yaxis, y)
    ax.set(xlabel="$a$", ylabel=RUNOUT)
    ax.legend()
    study.finish(fig, [
        Row("exponent, a <= 7", below.exponent, "0.97", within(0.97, 0.07)),
        Row("exponent, a >= 7", above.exponent, "0.69", within(0.69, 0.05)),
        Row("factor, a <= 7", below.factor, "1.72"),
        Row("factor, a >= 7", above.factor, "2.96")])


# Energies and what flows, figures 15 to 20


def peak(run):
    """(time, part of the initial energy) of the largest kinetic energy."""
    kinetic = run.series["kinetic"] / run.energy
    k = np.argmax(kinetic)
    return run.time[k], kinetic[k]


def left_at_fall(run):
    """What is left of the largest kinetic energy at the end of a free fall."""
    kinetic = run.series["kinetic"]
    return np.interp(FALL, run.time, kinetic) / kinetic.max()


def energy_rows(study, a, run):
    time, part = peak(run)
    if a == SHORT:
        bars = around(FALL, 0.1), None, None
    else:
        short = collapse(study, SHORT)
        bars = ((0, FALL), (peak(short)[1], math.inf),
                (0, left_at_fall(short)))
    return [Row("largest kinetic energy at", time,
                "1.41" if a == SHORT else "earlier", bars[0]),
            Row("its part of the initial energy", part, "", bars[1]),
            Row("of it left at 1.41", left_at_fall(run),
                "" if a == SHORT else "falls fast", bars[2]),
            Row("dissipated by 1.41",
                np.interp(FALL, run.time, run.series["dissipated"])
                / run.energy),
            Row("dissipated at the end",
                run.series["dissipated"][-1] / run.energy),
            Row("lost by the scheme at the end",
                run.series["numerical"][-1] / run.energy)]


def energies(a):
    def draw(study):
        run = collapse(study, a)
        s = run.series
        fig, (ax,) = make_panels(1)
        for (name, values), colour in zip(
                {"kinetic": s["kinetic"], "potential": s["potential"],
                 "mechanical": s["kinetic"] + s["potential"],
                 "dissipated": s["dissipated"]}.items(), COLOURS):
            ax.plot(run.time, values / run.energy, color=colour, label=name)
        ax.axvline(FALL, color="#777777", lw=0.8, ls=":")
        ax.set(xlabel=T, ylabel="energy / initial energy", ylim=(0, 1.02))
        ax.legend()
        study.finish(fig, energy_rows(study, a, run))
    return draw


def flowing_parts(run):
    """(times, part of the grains that flows) of the snapshots."""
    parts = []
    for snapshot in run.snapshots():
        volume = snapshot.grains() * np.prod(snapshot.high - snapshot.low, 1)
        parts.append((snapshot.time / run.unit,
                      volume[run.flowing(snapshot)].sum() / volume.sum()))
    return np.array(parts).T


def flowing_volume(a):
    def draw(study):
        run = collapse(study, a)
        times, parts = flowing_parts(run)
        fig, (ax, below) = make_panels(2, height=2.8)
        ax.plot(times, parts, color=COLOURS[0])
        ax.axvline(FALL, color="#777777", lw=0.8, ls=":")
        ax.set(xlabel=T, ylabel="part that flows", ylim=(0, 1.02))
        snapshot, = run.snapshots([FALL])
        draw_map(below, snapshot, run, run.flowing(snapshot),
                 plt.Normalize(0, 1), "cividis")
        below.set_title(f"what flows at {snapshot.time / run.unit:.3g}",
                        loc="left")
        study.finish(fig, [
            Row("largest part that flows", parts.max(),
                "nearly all" if a > BREAK else ""),
            Row("part at 1.41", np.interp(FALL, times, parts)),
            Row("nothing flows from", times[parts > 0][-1])])
    return draw


# Maps


def draw_map(ax, snapshot, run, values, norm, cmap):
    """A field in the grains."""
    window = plot.window_of(snapshot)
    spacing = plot.raster_spacing(snapshot, window)
    window = plot.snap_window(window, snapshot, spacing)
    image = plot.draw_grains(ax, snapshot, window, spacing,
                             np.asarray(values, float), norm, cmap)
    plot.draw_contours(ax, snapshot, window, spacing)
    ax.set(xlabel=X, ylabel=Y, xlim=window[:2], ylim=window[2:])
    return image


def draw_maps(run, times, field, norm, cmap, text):
    """A panel for each time, with one scale of colours."""
    snapshots = run.snapshots(times)
    fig, axes = make_panels(len(times), width=7.5, height=2.0)
    for ax, snapshot in zip(axes, snapshots):
        draw_map(ax, snapshot, run, field(snapshot), norm, cmap)
        ax.set_title(f"$t$ = {snapshot.time / run.unit:.3g} "
                     r"$\sqrt{h_i/g}$", loc="left")
        if ax is not axes[-1]:
            ax.set_xlabel("")
    fig.colorbar(plt.cm.ScalarMappable(norm, cmap), ax=axes, label=text)
    return fig, snapshots


def crest(x, height):
    """(place, height) of the highest point of an outline."""
    k = np.argmax(height)
    return x[k], height[k]


def crater(study):
    run = collapse(study, TALLEST)
    outlines = run.outlines([t for t in TIMES if 0 < t < run.time[-1]])
    fig, (ax,) = make_panels(1, height=4)
    for (time, x, height), colour in zip(outlines, shades(len(outlines))):
        ax.plot(x, height, color=colour, label=f"{time:.3g}")
    low = [o for o in outlines if o[0] >= 1.5]
    ax.set(xlabel=X, ylabel=Y, xlim=(0, None),
           ylim=(0, 1.1 * max(h.max() for _, _, h in low)))
    ax.legend(title=T, ncol=2)
    rows = []
    for time, x, height in low:
        if time < 2.6:
            at, top = crest(x, height)
            rows += [Row(f"crest at {time:.3g}: x", at, "off the axis",
                         (0.5, math.inf)),
                     Row(f"crest at {time:.3g}: height over that at the axis",
                         top / height[0], "> 1", (1.02, math.inf))]
    study.finish(fig, rows)


def inertial_number(snapshot, run):
    """I of each leaf; d from the number of grains as the case has it."""
    d = run_data.number(run_data.read_parameters(run.directory), "d")
    pressure = np.maximum(snapshot.fields["pressure"], 1e-12)
    return snapshot.fields["shear_rate"] * d / np.sqrt(pressure)


def inertial_map(study):
    run = collapse(study, TALLEST)
    times = 1.5, 2
    fig, snapshots = draw_maps(
        run, times, lambda s: inertial_number(s, run) / USUAL["I0"],
        LogNorm(1e-2, 1e2), "coolwarm", "$I/I_0$")
    rows = []
    for time, x, height in run.outlines(times):
        snapshot, = run.snapshots([time])
        centre = 0.5 * (snapshot.low + snapshot.high)
        depth = np.interp(centre[:, 0], x, height) - centre[:, 1]
        whole = snapshot.grains() == 1
        part = inertial_number(snapshot, run) / USUAL["I0"]
        low, high = (np.median(part[whole & half])
                     for half in (depth > centre[:, 1],
                                  depth < centre[:, 1]))
        rows += [Row(f"median I/I0 of the lower half at {time:.3g}", low),
                 Row("that over the median of the upper half", low / high,
                     "inertial below", (1, math.inf) if time < 1.6 else None)]
    study.finish(fig, rows)


def shear_maps(a, times):
    def draw(study):
        run = collapse(study, a)
        rates = lambda s: s.fields["shear_rate"] * run.unit  # noqa: E731
        fig, snapshots = draw_maps(run, times, rates, LogNorm(1e-2, 1e2),
                                   "viridis", r"$\dot\gamma\sqrt{h_i/g}$")
        rows = []
        for s in snapshots:
            flowing = run.flowing(s)
            if not flowing.any():
                continue
            x = 0.5 * (s.low + s.high)[:, 0]
            weight = s.grains() * np.prod(s.high - s.low, 1) * rates(s)
            place = (np.average(x[flowing], weights=weight[flowing])
                     / run.front[-1])
            rows.append(Row(f"mean place of the shear at "
                            f"{s.time / run.unit:.3g}, over r_f", place))
        study.finish(fig, rows)
    return draw


# Arrest, figures 23 and 24


def mean_shear_rate(study):
    run = collapse(study, SHORT)
    fig, (ax,) = make_panels(1)
    ax.semilogy(run.time[1:], run.series["mean_shear_rate"][1:] * run.unit,
                color=COLOURS[0])
    ax.axvline(run.arrest(), color="#777777", lw=0.8, ls=":")
    ax.set(xlabel=T, ylabel=r"mean shear rate ($\sqrt{g/h_i}$)")
    near = run.time[run.front - 1 > 0.99 * run.runout][0]
    study.finish(fig, [Row("arrest, by its fall", run.arrest()),
                       Row("front within 1 % of its run-out from", near)])


def arrests(study):
    fig, axes = make_panels(2, 2, width=9)
    rows = []
    for ax, key, values in zip(axes, ("mu_s", "delta_mu"), (MU_S, DELTA_MU)):
        runs = collapses(study, SHORT, key, values)
        for run, value, colour in zip(runs, values, COLOURS):
            ax.semilogy(run.time[1:],
                        run.series["mean_shear_rate"][1:] * run.unit,
                        color=colour,
                        label=f"{run_data.symbol(key)} = {value:g}")
        ax.set(xlabel=T, ylabel=r"mean shear rate ($\sqrt{g/h_i}$)",
               ylim=(1e-4, None))
        ax.legend(fontsize=8)
        times = [run.arrest() for run in runs]
        rows += [Row(f"arrest, {key} = {v:g}", t)
                 for v, t in zip(values, times)]
        rows.append(Row("largest step from one to the next",
                        max(np.diff(times)), "falls: < 0", (-math.inf, 0)))
    study.finish(fig, rows)


# Master curves, figures 27 and 28


def master_curves(key, values):
    """t_f is the time of arrest as section 3.5.1 finds it."""
    def draw(study):
        fine = np.linspace(0, 1, 201)
        fig, (ax,) = make_panels(1)
        curves = []
        for value, colour in zip(values, COLOURS):
            run = collapse(study, TALL, **{key: value})
            curves.append(np.interp(fine, run.time / run.arrest(),
                                    (run.front - 1) / run.runout))
            ax.plot(fine, curves[-1], color=colour,
                    label=f"{run_data.symbol(key)} = {value:g}")
        ax.set(xlabel="$t/t_f$", ylabel="$(r - r_i)/(r_f - r_i)$")
        ax.legend()
        study.finish(fig, [Row("largest distance of two curves",
                               np.ptp(curves, axis=0).max(), "one curve",
                               (0, 0.05))])
    return draw


FIGURES = {
    "5": ("deposits, a = 1.42", friction_at_rest(SHORT)),
    "6": ("deposits, a = 10", friction_at_rest(TALL)),
    "7": ("run-out against the friction at rest", law_of_friction_at_rest),
    "8": ("deposits, a = 1.42", rise_of_friction(SHORT)),
    "9": ("fronts, a = 1.42", fronts("delta_mu", DELTA_MU)),
    "10": ("deposits, a = 10", rise_of_friction(TALL)),
    "11": ("run-out against the rise of friction", law_of_rise),
    "12": ("fronts, a = 1.42", fronts("I0", I0)),
    "13": ("run-out against $I_0$, a = 1.42", law_of_I0),
    "14": ("run-out against the aspect ratio, eq. 9", law_of_aspect),
    "15": ("energies, a = 1.42", energies(SHORT)),
    "16": ("energies, a = 10", energies(TALL)),
    "17": ("energies, a = 50", energies(TALLEST)),
    "18": ("volume that flows, a = 1.42", flowing_volume(SHORT)),
    "19": ("volume that flows, a = 10", flowing_volume(TALL)),
    "20": ("volume that flows, a = 50", flowing_volume(TALLEST)),
    "21": ("crater and crest, a = 50", crater),
    "22": ("inertial number, a = 50", inertial_map),
    "23": ("mean shear rate, a = 1.42", mean_shear_rate),
    "24": ("mean shear rates and arrest, a = 1.42", arrests),
    "25": ("shear rate, a = 1.42", shear_maps(SHORT, (1, 2, 3, 4))),
    "26": ("shear rate, a = 10", shear_maps(TALL, (1, 2, 3, 5))),
    "27": ("reduced fronts, a = 10", master_curves("mu_s", MU_S)),
    "28": ("reduced fronts, a = 10", master_curves("delta_mu", DELTA_MU)),
} | cylinders.FIGURES
