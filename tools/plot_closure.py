#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Friction, and solid fraction where known, against the inertial number.

  tools/plot_closure.py "NAME [p=..] [key=value ..]" ... [-o PICTURE]
                        [--talus build/talus] [--linear]
                        [--dilatancy NU_0 A DELTA]

One curve for each argument, as `talus rheology ... --csv` prints it: solid
lines where contact carries 1 % of the pressure or more (state below 3), dotted
from there, with a dot at the first such row. --dilatancy adds 1/nu = 1/nu_0 + a
I^delta, dashed. What is drawn is written beside the picture, fig1.csv for
fig1.png: a row for each point with the number of its curve. Figure 1 of
lee_huang_chiew_2015 is

  tools/plot_closure.py -o fig1.png --linear --dilatancy 0.6 0.28 0.58 \\
    "lee_huang p=1000 eta_S=0.38 d=5e-4 e_eff=0.46" \\
    "lee_huang p=1000 eta_S=0.38 d=5e-4 e_eff=0.58" \\
    "lee_huang p=1000 eta_S=0.38 d=5e-4 e_eff=0.70"
"""
import argparse
import csv
import pathlib
import subprocess
import sys

import run_data  # first: it says so if one of the next is missing
import matplotlib.pyplot as plt
import numpy as np

INERTIAL = 3
COLOURS = ["#24639c", "#b5382b", "#3d7d3a", "#8a5a22", "#777777"]


def read_curve(talus, words):
    """Columns of the curve by name; NaN where a field is empty."""
    text = subprocess.run([talus, "rheology", *words, "--csv"], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    rows = list(csv.DictReader(text.splitlines()))
    return {name: np.array([float(row[name] or "nan") for row in rows])
            for name in rows[0]}


def draw(axes, curve, name, colour, label):
    """One quantity, split at the first inertial row, which ends both parts."""
    inertial = np.flatnonzero(curve["state"] >= INERTIAL)
    kink = inertial[0] if len(inertial) else len(curve["I"]) - 1
    I, y = curve["I"], curve[name]
    axes.plot(I[:kink + 1], y[:kink + 1], color=colour, label=label)
    if len(inertial):
        axes.plot(I[kink:], y[kink:], ":", color=colour)
        axes.plot(I[kink], y[kink], "o", color=colour, markersize=4)


def write_data(path, curves, arguments):
    """All curves in one table; the arguments as lines of comment."""
    names = list(curves[0])
    with open(path, "w", newline="", encoding="utf-8") as f:
        for k, argument in enumerate(arguments):
            f.write(f"# curve {k}: {argument}\n")
        writer = csv.writer(f, lineterminator="\n")
        writer.writerow(["curve", *names])
        for k, curve in enumerate(curves):
            for row in zip(*(curve[name] for name in names)):
                writer.writerow([k, *(f"{x:.6g}" for x in row)])


def shared_words(arguments):
    """Words that all curves have: no need to say them of each."""
    words = [argument.split() for argument in arguments]
    return {w for w in words[0]
            if len(words) > 1 and all(w in x for x in words)}


def in_symbols(words):
    """Words of a curve as a text with parameters as mathematics."""
    parts = [word.partition("=") for word in words]
    return ", ".join(f"{run_data.symbol(name)} = {value}" if equals
                     else name for name, equals, value in parts)


def parse_options():
    here = pathlib.Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("curves", metavar="CURVE", nargs="+",
                        help="a closure with its parameters, in quotes")
    parser.add_argument("-o", "--output", metavar="PICTURE", type=pathlib.Path,
                        default=pathlib.Path("closure.png"),
                        help="default closure.png")
    parser.add_argument("--talus", default=here / "build" / "talus",
                        help="the program, default that of build/")
    parser.add_argument("--linear", action="store_true",
                        help="a linear axis of I instead of a logarithmic one")
    parser.add_argument("--dilatancy", nargs=3, type=float,
                        metavar=("NU_0", "A", "DELTA"),
                        help="adds 1/nu = 1/nu_0 + a I^delta")
    return parser.parse_args()


def main():
    options = parse_options()

    try:
        curves = [read_curve(options.talus, argument.split())
                  for argument in options.curves]
    except subprocess.CalledProcessError as error:
        sys.exit(error.returncode)  # talus has said why
    except OSError as error:
        sys.exit(f"plot_closure: {error}")
    names = ["mu"]
    if any(np.isfinite(curve["nu"]).any() for curve in curves):
        names.append("nu")
    shared = shared_words(options.curves)
    figure, panels = plt.subplots(1, len(names), squeeze=False,
                                  figsize=(5 * len(names), 4))
    for axes, name in zip(panels[0], names):
        for k, (curve, argument) in enumerate(zip(curves, options.curves)):
            label = in_symbols(w for w in argument.split() if w not in shared)
            draw(axes, curve, name, COLOURS[k % len(COLOURS)],
                 label or "default parameters")
        axes.set_xlabel("inertial number $I$")
        axes.set_xscale("linear" if options.linear else "log")
    panels[0][0].set_ylabel(r"friction $\tau/p$")
    if "nu" in names:
        axes = panels[0][1]
        axes.set_ylabel(r"solid fraction $\nu$")
        if options.dilatancy:
            nu_0, a, delta = options.dilatancy
            I = np.linspace(*axes.get_xlim(), 400).clip(1e-4)
            axes.plot(I, 1 / (1 / nu_0 + a * I**delta), "k--", linewidth=0.8,
                      label="dilatancy law")
    handles, labels = panels[0][-1].get_legend_handles_labels()
    lines = -(-len(labels) // len(names))  # below the panels
    figure.set_figheight(4 + 0.22 * lines)
    figure.legend(handles, labels, frameon=False, loc="lower center",
                  ncol=len(names), fontsize=9)
    figure.suptitle(in_symbols(w for w in options.curves[0].split()
                               if w in shared), fontsize=11)
    figure.tight_layout(rect=(0, 0.24 * lines / figure.get_figheight(), 1, 1))
    table = options.output.with_suffix(".csv")
    figure.savefig(options.output, dpi=120)
    write_data(table, curves, options.curves)
    print(options.output, table, sep="\n")


if __name__ == "__main__":
    main()
