#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case over the values of a parameter and compares how it ends.

  tools/sweep.py CASE.lua name=v1,v2,... [name=value ...] [-o DIR]
                 [--base LENGTH] [--talus build/talus]

The first name is swept, further ones hold for all runs. DIR (default: case and
name, as in sensitivity-mu_s) gets one directory per run and
  sweep.csv    front, height, run-out, arrest time of each; run-out = (front -
               base)/base, base being that of the column (--base, default 1);
               last_speed, that of the fastest grains in the last step, says
               whether the heap was at rest by then
  sweep.png    run-out and height against the parameter, with a power law
               through the run-outs
  panels.png   the outlines of each run in a panel
The table is printed too, the exponent, and what was written. The arrest time is
the last at which the mean shear rate exceeds 1 % of its largest value; there is
none if it still does at the end. A run that is there with the same parameters
is not repeated.
"""
import argparse
import csv
import pathlib
import subprocess
import sys

import run_data  # first: it says so if one of the next is missing
import matplotlib.pyplot as plt
import numpy as np

COLOUR, GREY = "#8a5a22", "#777777"


class Run:
    """One finished run of the sweep."""

    def __init__(self, value, directory, base):
        series = run_data.read_series(directory)
        self.value, self.directory = value, directory
        self.front = series["front"][-1]
        self.height = series["height"][-1]
        self.runout = (self.front - base) / base
        self.arrest = run_data.arrest_time(series)
        self.time = series["time"][-1]
        self.speed = series["max_speed"][-1]

    def row(self):
        arrest = "" if self.arrest is None else f"{self.arrest:.6g}"
        return [self.value, *(f"{x:.6g}" for x in (
            self.front, self.height, self.runout)), arrest,
            f"{self.speed:.3g}"]


HEADER = ["front", "height", "runout", "arrest_time", "last_speed"]


def parse_sweep(words):
    name, _, values = words[0].partition("=")
    if not values:
        sys.exit(f"sweep: '{words[0]}' is not of the form name=v1,v2,...")
    return name, values.split(","), words[1:]


def run_one(options, words, directory):
    """Run unless just that run is there, complete."""
    stamp = directory / "sweep.txt"
    text = options.case.read_text(encoding="utf-8") + "\n".join(words)
    if stamp.exists() and stamp.read_text(encoding="utf-8") == text:
        return
    subprocess.run([options.talus, "run", options.case, *words, "--quiet",
                    "-o", directory], check=True)
    stamp.write_text(text, encoding="utf-8")


def numbers(runs):
    """The values of the parameter as numbers, or None if some are words."""
    try:
        return np.array([float(run.value) for run in runs])
    except ValueError:
        return None


def exponent(x, y):
    """(n, C) of y = C x^n by least squares of the logarithms, None if they
    cannot be taken."""
    if x is None or len(x) < 2 or np.any(x <= 0) or np.any(y <= 0):
        return None
    slope, log_c = np.polyfit(np.log(x), np.log(y), 1)
    return float(slope), float(np.exp(log_c))


def write_table(path, name, runs):
    with open(path, "w", newline="", encoding="utf-8") as f:
        writer = csv.writer(f)
        writer.writerow([name, *HEADER])
        writer.writerows(run.row() for run in runs)


def units_of(runs):
    return run_data.Units(run_data.read_parameters(runs[0].directory))


def plot_sweep(path, name, x, runs, fit):
    units = units_of(runs)
    fig, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for ax, what in zip(axes, ("runout", "height")):
        y = np.array([getattr(run, what) for run in runs])
        ax.plot(x, y, "o", color=COLOUR)
        if what == "runout" and fit:
            fine = np.geomspace(x.min(), x.max(), 50)
            ax.plot(fine, fit[1] * fine ** fit[0], color=GREY,
                    label=f"{fit[1]:.3g} {run_data.symbol(name)}"
                    f"$^{{{fit[0]:.2f}}}$")
            ax.legend(frameon=False)
        if x.min() > 0 and x.max() > 5 * x.min():
            ax.set_xscale("log")
        ax.set_xlabel(run_data.symbol(name))
        ax.set_ylabel("run-out / base" if what == "runout" else
                      run_data.label("height", units.length))
    fig.savefig(path, dpi=150)
    plt.close(fig)


def plot_panels(path, name, runs):
    """At most five times, evenly spread, in each panel."""
    units = units_of(runs)
    fig, axes = plt.subplots(len(runs), 1, sharex=True, sharey=True,
                             squeeze=False, layout="constrained",
                             figsize=(7, 0.4 + 1.25 * len(runs)))
    right = 0
    for ax, run in zip(axes[:, 0], runs):
        profiles = run_data.without_repeat(
            run_data.read_profiles(run.directory))
        count = min(5, len(profiles))
        chosen = np.linspace(0, len(profiles) - 1, count).round().astype(int)
        for k, i in enumerate(chosen):
            time, x, height = profiles[i]
            shade = plt.get_cmap("copper_r")((k + 1) / (count + 1))
            ax.plot(x, height, color=shade, lw=1.2,
                    label=f"$t$ = {time:.3g} {units.time}")
            right = max(right, x[np.nonzero(height)[0][-1]])
        ax.set_title(f"{run_data.symbol(name)} = {run.value}", loc="left",
                     fontsize=9, pad=2)
        ax.spines[["top", "right"]].set_visible(False)
    axes[0, 0].set_xlim(0, 1.02 * right)
    axes[0, 0].set_ylim(bottom=0)
    axes[0, 0].legend(fontsize=7, frameon=False, loc="upper right", ncol=2)
    axes[-1, 0].set_xlabel(run_data.label("$x$", units.length))
    fig.supylabel(run_data.label("height", units.length), fontsize="medium")
    fig.savefig(path, dpi=150)
    plt.close(fig)


def write_results(output, name, runs):
    table = output / "sweep.csv"
    write_table(table, name, runs)
    print(table.read_text(encoding="utf-8"), end="")
    x = numbers(runs)
    fit = exponent(x, np.array([run.runout for run in runs]))
    if fit:
        print(f"run-out = {fit[1]:.4g} {name}^{fit[0]:.3f}")
    print(table)
    if x is not None:
        plot_sweep(output / "sweep.png", name, x, runs, fit)
        print(output / "sweep.png")
    plot_panels(output / "panels.png", name, runs)
    print(output / "panels.png")


def parse_options():
    here = pathlib.Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("case", metavar="CASE.lua", type=pathlib.Path,
                        help="the case to run")
    parser.add_argument("words", nargs="+", metavar="name=value",
                        help="first the values to run, then what all runs get")
    parser.add_argument("-o", "--output", metavar="DIR", type=pathlib.Path,
                        help="where to run and write, default CASE-name")
    parser.add_argument("--base", metavar="LENGTH", type=float, default=1.0,
                        help="of the column at the start, default 1")
    parser.add_argument("--talus", type=pathlib.Path,
                        default=here / "build" / "talus",
                        help="the program, default that of build/")
    return parser.parse_args()


def main():
    options = parse_options()
    name, values, fixed = parse_sweep(options.words)
    output = options.output or pathlib.Path(f"{options.case.stem}-{name}")
    output.mkdir(parents=True, exist_ok=True)
    runs = []
    for value in values:
        directory = output / value
        try:
            run_one(options, [f"{name}={value}", *fixed], directory)
        except subprocess.CalledProcessError as error:
            sys.exit(f"sweep: {name}={value} ended with status "
                     f"{error.returncode}")
        runs.append(Run(value, directory, options.base))
    write_results(output, name, runs)


if __name__ == "__main__":
    main()
