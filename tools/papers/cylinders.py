# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of cylindrical columns of L. Valette et al., Comput. Fluids 191
(2019), section 4. Case: examples/cylinder.lua, axisymmetric; the paper has a
quarter of a cylinder in three dimensions. It does not say which of its two
radii eq. 10 and figs. 30 to 32 are of; they are those of the small column here,
which the bars hold for."""
from power_law import fit_one, fit_two
from sweep import draw_law, set_log_axis
import run_data
from papers.study import Collapse, Row, around, make_panels, within
import numpy as np

MU_S = (0.32, 0.42, 0.52, 0.62)
DELTA_MU = (0.18, 0.28, 0.38, 0.48)
I0 = (0.04, 0.4, 4)
BASE = {"mu_s": 0.32, "delta_mu": 0.28, "I0": 0.4}  # those of figs. 5 to 13
ASPECTS = (0.5, 0.8, 1.3, 2.1, 3.5, 6, 11, 20)
BREAK = 2.7  # eq. 10
BELOW, ABOVE = (1.2, 1.0), (1.93, 0.54)  # its factors and exponents
LARGE, SMALL = 0.2, 0.02  # r_i in m
STRIP = 3  # grain diameters
COLOURS = {LARGE: "#24639c", SMALL: "#8a5a22"}
CELLS = 16


def collapse(study, a, **words):
    """The run of a column to rest."""
    cells = study.cells or CELLS
    words = {"a": a, "cells": cells} | words
    name = "-".join(["cylinder"] + [f"{k}{v:g}" for k, v in words.items()])
    return Collapse(study.run("cylinder", name, words), a)


# Sensitivities, figures 30 to 32


def spread(study, key, value, r_i):
    run = collapse(study, 1, **(BASE | {key: value}), r_i=r_i)
    return run.front[-1] ** 2 - 1


def sensitivity(key, values, power, slack):
    def draw(study):
        fig, (ax,) = make_panels(1, height=3.4)
        x, rows, y = np.array(values), [], {}
        for r_i in (LARGE, SMALL):
            y[r_i] = np.array([spread(study, key, v, r_i) for v in values])
            law = fit_one(x, y[r_i])
            draw_law(ax, key, law, None, COLOURS[r_i])
            ax.plot(x, y[r_i], "o", color=COLOURS[r_i],
                    label=f"$r_i$ = {r_i:g} m")
            rows.append(Row(f"exponent, r_i = {r_i:g} m", law.exponent,
                            f"{power:g}", within(power, slack)
                            if r_i == SMALL else None))
        set_log_axis(ax.xaxis, x)
        set_log_axis(ax.yaxis, np.concatenate(list(y.values())))
        ax.set(xlabel=run_data.symbol(key),
               ylabel=r"$(r_f^2 - r_i^2)/r_i^2$")
        ax.legend()
        study.finish(fig, rows)
    return draw


# Geometry, figure 33


def runouts(study, r_i, strip):
    return np.array([collapse(study, a, r_i=r_i, strip=strip).runout
                     for a in ASPECTS])


def law_rows(r_i, strip, laws):
    """The laws below and above the break beside eq. 10."""
    what = f"r_i = {r_i:g} m" + (", strip" if strip else "")
    rows = []
    for where, law, (factor, power), slack in zip(
            ("a < 2.7", "a > 2.7"), laws, (BELOW, ABOVE), (0.1, 0.06)):
        bars = ((within(power, slack), around(factor, 0.2))
                if r_i == SMALL else (None, None))
        rows += [Row(f"exponent, {where}, {what}", law.exponent, f"{power:g}",
                     bars[0]),
                 Row(f"factor, {where}, {what}", law.factor, f"{factor:g}",
                     bars[1])]
    return rows


def law_of_aspect(study):
    fig, (ax,) = make_panels(1, height=4.2)
    a, rows, y = np.array(ASPECTS), [], {}
    for r_i in (LARGE, SMALL):
        for strip in (0, STRIP):
            y[r_i, strip] = runouts(study, r_i, strip)
            rows += law_rows(r_i, strip, fit_two(a, y[r_i, strip], BREAK))
            ax.plot(a, y[r_i, strip], "x" if strip else "o",
                    color=COLOURS[r_i], mfc="none",
                    label=f"$r_i$ = {r_i:g} m"
                          + (f", strip {STRIP} $d$" if strip else ""))
    for (factor, power), x in ((BELOW, np.array([a[0], BREAK])),
                               (ABOVE, np.array([BREAK, a[-1]]))):
        ax.plot(x, factor * x ** power, ":", color="#777777",
                label=f"paper: {factor:g} $a^{{{power:g}}}$")
    set_log_axis(ax.xaxis, a)
    set_log_axis(ax.yaxis, np.concatenate(list(y.values())))
    ax.set(xlabel="$a$", ylabel=r"$(r_f - r_i)/r_i$")
    ax.legend()
    less = y[SMALL, 0] / y[LARGE, 0]
    rows.append(Row("run-out, small over large, most", less.max(), "< 1",
                    (0, 1)))
    study.finish(fig, rows)


FIGURES = {
    "30": ("run-out of cylinders against the friction at rest",
           sensitivity("mu_s", MU_S, -1, 0.2)),
    "31": ("run-out of cylinders against the rise of friction",
           sensitivity("delta_mu", DELTA_MU, -0.33, 0.12)),
    "32": ("run-out of cylinders against $I_0$",
           sensitivity("I0", I0, 0.1, 0.05)),
    "33": ("run-out of cylinders against the aspect ratio, eq. 10",
           law_of_aspect),
}
