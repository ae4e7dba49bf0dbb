# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of P.-Y. Lagree, L. Staron & S. Popinet, The granular column collapse
as a continuum: validity of a two-dimensional Navier-Stokes model with a
mu(I)-rheology, J. Fluid Mech. 686 (2011) 378. Case: examples/column.lua, with
a viscosity that has no lower bound (eq. 2.18) and an exact yield stress instead
of the cap to which the paper's results were insensitive."""
import math

from power_law import fit_two
from sweep import draw_law, set_log_axis
import run_data
from papers.study import (EXAMPLES, Row, around, make_panels, shades,
                          within)
import numpy as np

ASPECTS = (0.25, 0.35, 0.5, 0.7, 1, 1.4, 2, 2.8, 4, 5.6, 8, 11, 16, 23, 32, 64)
BREAK = 7  # eq. 3.3
GRAINS = 6040  # in a column, so that d = sqrt(a/6040)
TALLEST, TALLEST_GRAINS = 67.9, 20050
FRICTION = {"mu_s": 0.32, "delta_mu": 0.28, "I0": 0.4}
X, Y, T = "$x/L_0$", "$H/L_0$", r"$t/\sqrt{H_0/g}$"
COLOURS = ("#24639c", "#8a5a22", "#b5382b")
REFERENCE = "contact_dynamics_a6.26.csv"


def collapse(study, a, cells, times, stop=12, grains=GRAINS, **physics):
    """The run of a column, to its rest or the time `stop`."""
    reach = 1.3 * (1 + (2.4 * a if a < BREAK else 3.9 * a ** 0.7))
    d = math.sqrt(a / grains)
    output = {"d": d, "eta_min": 0, "front_height": d / 2,
              "regularisation": "exact", "every": 0, "rest": 1e-3,
              "stop": stop * math.sqrt(a),
              "times": ",".join(map(str, times))}
    return study.collapse("column", a, reach, cells, output, **physics)


# Scaling, figure 12


def law_of_height(a):
    """Eq. 3.4, up to the aspect ratios at which a side bump forms."""
    return np.where(a <= 0.5, a, np.where(a < 6, 0.67 * a ** 0.4, 1.4))


def scaling(study):
    """Run-outs and heights at both resolutions: {cells: (a, y, height)}."""
    found = {}
    for cells in (16, 32) if study.cells is None else (study.cells,):
        runs = [collapse(study, a, cells, (0, 4)) for a in ASPECTS]
        found[cells] = (np.array(ASPECTS), np.array([r.runout for r in runs]),
                        np.array([r.height for r in runs]))
    return found


def draw_runouts(ax, found):
    rows = []
    for (cells, (a, y, _)), colour in zip(found.items(), COLOURS):
        laws = fit_two(a, y, BREAK)
        ax.plot(a, y, "o", color=colour, ms=4, label=f"{cells} cells to $L_0$")
        for law in laws:
            draw_law(ax, "a", law, BREAK, colour)
        below, above = laws
        rows += [Row(f"exponent, a < 7, {cells} cells", below.exponent, "1",
                     within(1, 0.07)),
                 Row(f"exponent, a > 7, {cells} cells", above.exponent, "0.7",
                     within(0.7, 0.05)),
                 Row(f"factor, a < 7, {cells} cells", below.factor, "2.2",
                     around(2.2, 0.2)),
                 Row(f"factor, a > 7, {cells} cells", above.factor, "3.9",
                     around(3.9, 0.2))]
    for ends, factor, power in (((a[0], BREAK), 2.2, 1),
                                ((BREAK, a[-1]), 3.9, 0.7)):
        x = np.array(ends)
        ax.plot(x, factor * x ** power, ":", color="#777777",
                label=f"paper: {factor} $a^{{{power}}}$")
    return rows


def draw_heights(ax, found):
    rows = []
    for (cells, (a, _, height)), colour in zip(found.items(), COLOURS):
        ax.plot(a, height, "o", color=colour, ms=4)
        for low, high, law in ((0, 0.5, "a"), (0.6, 6, "0.67 a^0.4"),
                               (6, 12, "1.4")):
            keep = (a >= low) & (a <= high)
            ratio = (height / law_of_height(a))[keep]
            worst = ratio[np.argmax(np.abs(ratio - 1))]
            rows.append(Row(f"height over {law}, a = {a[keep][0]:g} to "
                            f"{a[keep][-1]:g}, worst, {cells} cells", worst,
                            "1", within(1, 0.12)))
    x = np.geomspace(a[0], 12, 200)
    ax.plot(x, law_of_height(x), ":", color="#777777", label="paper, eq. 3.4")
    return rows


def scalings(study):
    found = scaling(study)
    fig, axes = make_panels(2, 2, width=10, height=4)
    rows = draw_runouts(axes[0], found) + draw_heights(axes[1], found)
    for ax, k, words in zip(axes, (1, 2), (r"$(L_\infty - L_0)/L_0$",
                                           r"$H_\infty/L_0$")):
        set_log_axis(ax.xaxis, np.array(ASPECTS))
        set_log_axis(ax.yaxis, np.concatenate([v[k] for v in found.values()]))
        ax.set(xlabel="$a$", ylabel=words)
        ax.legend(fontsize=8)
    study.finish(fig, rows)


# The bump, figure 13


def bump(study):
    """The outlines for three sets of friction; the bar is for the default."""
    times = (0.5, 1, 1.2, 1.4, 1.7, 2)
    sets = ((0.3, 0.26, 0.3), (0.32, 0.28, 0.3), (0.32, 0.28, 0.4))
    fig, axes = make_panels(len(times), 2, width=9, height=1.9)
    for friction, colour in zip(sets, ("#3d7d3a", "#24639c", "#0f8f8f")):
        changed = {k: v for k, v in zip(FRICTION, friction)
                   if v != FRICTION[k]}
        run = collapse(study, TALLEST, 16, times, times[-1], TALLEST_GRAINS,
                       **changed)
        outlines = run.outlines(times)
        for ax, (_, x, height) in zip(axes, outlines):
            ax.plot(x, height, color=colour,
                    label="{:g}, {:g}, {:g}".format(*friction))
    for ax, (time, _, _) in zip(axes, outlines):
        ax.set(title=f"$t$ = {time:.3g} " r"$\sqrt{H_0/g}$", ylim=(0, None),
               xlim=(0, None))
    axes[0].legend(title=r"$\mu_s, \Delta\mu, I_0$", fontsize=8)
    study.finish(fig, rows_of_bump(outlines))


def rows_of_bump(outlines):
    rows, places = [], []
    for time, x, height in outlines[-2:]:
        k = np.argmax(height)
        places.append(x[k])
        rows += [Row(f"highest at {time:.2g}: x", x[k], "off the axis",
                     (1, math.inf)),
                 Row(f"its height over that at the axis at {time:.2g}",
                     height[k] / height[0], "> 1", (1.02, math.inf))]
    return rows + [Row("the maximum moves by", places[1] - places[0],
                       "outwards", (0.1, math.inf))]


# Without advection, figure 14e


def without_inertia(study):
    times = (0, 1, 2, 3, 4)
    fig, axes = make_panels(2, height=2.4, sharex=True)
    shapes = []
    for ax, advection in zip(axes, ("off", "on")):
        run = collapse(study, 6.26, 16, times, advection=advection)
        shapes.append(run.outlines(times))
        for (time, x, height), colour in zip(shapes[-1], shades(len(times))):
            ax.plot(x, height, color=colour, label=f"{time:.2g}")
        ax.set(title=f"advection {advection}", ylabel=Y, ylim=(0, 3))
        ax.legend(title=T, fontsize=8)
    axes[-1].set_xlabel(X)
    axes[0].set_xlim(0, 1.03 * max(o[1][-1] for s in shapes for o in s))
    rows = []
    for off, on in list(zip(*shapes))[1:]:
        rows.append(Row(f"difference of the outlines at {on[0]:.2g}",
                        run_data.compare(*off[1:], *on[1:])[0]))
        for (_, _, height), words in ((off, "off"), (on, "on")):
            rows.append(Row(f"highest over height at the axis, {words}",
                            height.max() / height[0],
                            "a wave" if words == "off" else ""))
    study.finish(fig, rows)


# The map of errors, figure 17


def error_in_grains(run, reference, grain):
    """Mean over the times of |height - that of the grains|, weighted by the
    height, so that thin fronts count little; in diameters of a grain. Heights
    of the grains are scaled to the same area, as they dilate."""
    errors = []
    for profile in run_data.read_profiles(run.directory):
        other = reference.at(profile.time / run.unit)
        if other is None or profile.time == 0:
            continue
        x, h, r, _ = run_data.align(profile.x, profile.height, reference.x,
                                    other)
        errors.append(run_data.integral(np.abs(h - r) * r, x)
                      / run_data.integral(r, x) / grain)
    return float(np.mean(errors))


def map_of_errors(study):
    mu_s, delta_mu = np.arange(0.3, 0.361, 0.01), np.arange(0.2, 0.301, 0.02)
    reference = run_data.Reference(EXAMPLES / "reference" / REFERENCE)
    error = np.empty((len(delta_mu), len(mu_s)))
    times = 0.66, 0.95, 1.24, 1.52, 2.28
    for j, rise in enumerate(delta_mu):
        for i, rest in enumerate(mu_s):
            run = collapse(study, 6.26, 16, times, times[-1],
                           mu_s=round(rest, 3), delta_mu=round(rise, 3))
            error[j, i] = error_in_grains(run, reference, 0.0464)
    fig, (ax,) = make_panels(1, width=6, height=4.2)
    levels = np.arange(math.floor(error.min() / 0.03),
                       math.ceil(error.max() / 0.03) + 1) * 0.03
    filled = ax.contourf(mu_s, delta_mu, error, levels, cmap="viridis_r")
    ax.contour(mu_s, delta_mu, error, levels, colors="white", linewidths=0.5)
    fig.colorbar(filled, label="error in grains")
    j, i = np.unravel_index(np.argmin(error), error.shape)
    ax.plot(mu_s[i], delta_mu[j], "o", color="white", mec="black")
    ax.set(xlabel=r"$\mu_s$", ylabel=r"$\Delta\mu$")
    study.finish(fig, [Row("smallest error, in grains", error.min(), "2.06"),
                       Row("largest error, in grains", error.max(), "4.36"),
                       Row("mu_s of the smallest", mu_s[i]),
                       Row("delta_mu of the smallest", delta_mu[j])])


FIGURES = {
    "12": ("run-out and height against the aspect ratio", scalings),
    "13": ("the bump of a column with a = 67.9", bump),
    "14e": ("a = 6.26, without advection of momentum", without_inertia),
    "17": ("error against the grains, a = 6.26, $I_0$ = 0.4", map_of_errors),
}
