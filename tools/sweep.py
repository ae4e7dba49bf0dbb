#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case over the values of a parameter and compares how it ends.

  tools/sweep.py CASE.lua name=v1,v2,... [name=value ...] [-o DIR]
                 [--base LENGTH] [--log-log] [--break X|find]
                 [--talus build/talus]

The first name is swept, further ones hold for all runs. Where the case wants a
number, a further value may be an expression of other parameters of the case,
with + - * / ^, brackets, pi, sqrt, exp, log, sin, cos, tan, abs, min, max,
floor, ceil: stop='5*sqrt(a)'. DIR (default: case and name, as in
sensitivity-mu_s) gets one directory per run and
  sweep.csv    front, height, run-out, arrest time of each; run-out = (front -
               base)/base, base being that of the column (--base, default 1);
               last_speed, that of the fastest grains in the last step, says
               whether the heap was at rest by then; then the expressions
  fits.csv     power laws through run-outs and heights, with the standard
               errors of their exponents; of two values there is none
  sweep.png    run-out and height against the parameter, with the power laws
  panels.png   the outlines of each run in a panel
The table and the power laws are printed too, and what was written. --break
gives the parameter where one power law ends and another begins; `find` takes
the place that fits best. The arrest time is the last at which the mean shear
rate exceeds 1 % of its largest value; there is none if it still does at the
end. A run that is there with the same parameters is not repeated; one that was
stopped before its end (Ctrl-C) is continued, and nothing is compared until all
have ended.

Example: run-outs of columns, each to the time at which it rests, with the break
between short and tall ones
  tools/sweep.py examples/column.lua a=0.5,0.8,1.2,2,3,4.5,7,10 \\
    stop='6*sqrt(a)' size=64 level=10 --break find
"""
import argparse
import csv
import pathlib

import run_data  # first: it says so if one of the next is missing
import expression
import power_law
import run_cases
from run_cases import fail, split_word, text_of
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import (FuncFormatter, LogLocator, MaxNLocator,
                               NullFormatter, NullLocator)

COLOUR, GREY, BLUE = "#8a5a22", "#777777", "#24639c"
TITLES = {"runout": "run-out", "height": "height"}
HEADER = ["front", "height", "runout", "arrest_time", "last_speed"]


class Run:
    """One finished run of the sweep."""

    def __init__(self, value, directory, base, derived):
        series = run_data.read_series(directory)
        self.value, self.directory, self.derived = value, directory, derived
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
            f"{self.speed:.3g}", *self.derived.values()]


# Parameters


def is_plain(value):
    """Whether a value is a number or a list of numbers as it stands."""
    try:
        return all(float(part) == float(part) for part in value.split(","))
    except ValueError:
        return False


def evaluate_word(name, text, values, pending):
    """The value of one parameter as the command line takes it; None if it
    waits for one of the `pending` ones."""
    try:
        trees = expression.parse(text)
        if any(expression.names(tree) & pending for tree in trees):
            return None
        known = {n: float(v) for n, v in values.items() if is_plain(v)
                 and "," not in v and n not in pending}
        return ",".join(text_of(expression.evaluate(tree, known))
                        for tree in trees)
    except expression.ExpressionError as error:
        return fail(f"{name}={text}: {error}")


def ask_case(options, words):
    return run_cases.ask_case(options.talus, options.case, words)


def resolve(options, swept, fixed):
    """The words of one run with expressions replaced by what they are worth:
    (words, {name: value} of those that were expressions)."""
    given = dict(map(split_word, fixed))
    waiting = {n: v for n, v in given.items() if not is_plain(v)}
    words = [swept] + [w for w in fixed if split_word(w)[0] not in waiting]
    derived = {}
    if waiting:  # those for a text are no expressions
        values = ask_case(options, words)
        for name in [n for n in waiting if not is_plain(values.get(n, "text"))]:
            words.append(f"{name}={waiting.pop(name)}")
    while waiting:
        values = ask_case(options, words)
        ready = {n: evaluate_word(n, text, values, set(waiting))
                 for n, text in waiting.items()}
        ready = {n: value for n, value in ready.items() if value is not None}
        if not ready:
            fail("each of these is an expression of another: "
                 + ", ".join(f"{n}={text}" for n, text in waiting.items()))
        for name, value in ready.items():
            words.append(f"{name}={value}")
            derived[name] = value
            del waiting[name]
    return words, {n: derived[n] for n in given if n in derived}


def base_of(options, words):
    """The length that --base names for one run."""
    if is_plain(options.base):
        return float(options.base)
    value = evaluate_word("--base", options.base, ask_case(options, words),
                          set())
    return float(value)


# Runs


def run_all(options, name, values, fixed, output):
    done = []
    for value in values:
        words, derived = resolve(options, f"{name}={value}", fixed)
        base, directory = base_of(options, words), output / value
        run_cases.run_to_end(options.talus, options.case, words, directory,
                             f"{name}={value}")
        done.append(Run(value, directory, base, derived))
    return done


# Power laws


def numbers(runs):
    """The values of the parameter as numbers, or None if some are words."""
    try:
        return np.array([float(run.value) for run in runs])
    except ValueError:
        return None


def column(runs, what):
    return np.array([getattr(run, what) for run in runs])


def place_of_break(options, name, x, runs):
    """Where two power laws meet, None where there is one only. One that is to
    be found is that of the run-outs."""
    if options.break_at is None or x is None:
        return None
    if options.break_at != "find":
        return float(options.break_at)
    place = power_law.find_break(x, column(runs, "runout"))
    if place is None:
        fail(f"--break find: at least {power_law.FEWEST_TO_SEARCH} values of "
             f"{name} with a run-out > 0 are needed")
    print(f"break at {name} = {place:.4g}")
    return place


def fits_of(x, runs, place):
    """{quantity: [law, ...]} of the ranges in which there is one. Values that
    have no logarithm are left out, with a word."""
    fits = {}
    for what in TITLES:
        y = column(runs, what)
        out = [run.value for run, v in zip(runs, y) if v <= 0]
        if out and x is not None:
            print(f"{TITLES[what]} <= 0, in no power law: {', '.join(out)}")
        laws = ([] if x is None else [power_law.fit_one(x, y)]
                if place is None else power_law.fit_two(x, y, place))
        fits[what] = [law for law in laws if law]
    return fits


def say_fits(name, fits, ranges):
    for what, laws in fits.items():
        for law in laws:
            error = "" if law.error is None else f" +- {law.error:.2g}"
            where = (f"  ({law.count} values, {name} = {law.low:g} to "
                     f"{law.high:g})" if ranges else "")
            print(f"{TITLES[what]} = {law.factor:.4g} {name}^"
                  f"{law.exponent:.3f}{error}{where}")


def write_fits(path, name, fits):
    with open(path, "w", newline="", encoding="utf-8") as f:
        writer = csv.writer(f, lineterminator="\n")
        writer.writerow(["quantity", f"{name}_from", f"{name}_to", "values",
                         "factor", "exponent", "standard_error"])
        for what, laws in fits.items():
            for law in laws:
                error = "" if law.error is None else f"{law.error:.6g}"
                writer.writerow([what, f"{law.low:g}", f"{law.high:g}",
                                 law.count, f"{law.factor:.6g}",
                                 f"{law.exponent:.6g}", error])


# Table and pictures


def write_table(path, name, runs):
    with open(path, "w", newline="", encoding="utf-8") as f:
        writer = csv.writer(f, lineterminator="\n")
        writer.writerow([name, *HEADER, *runs[0].derived])
        writer.writerows(run.row() for run in runs)


def units_of(runs):
    return run_data.Units(run_data.read_parameters(runs[0].directory))


def set_log_axis(axis, values):
    """A logarithmic axis with plain numbers, three or more of them however
    short it is."""
    low, high = values.min(), values.max()
    axis.axes.set(**{f"{axis.axis_name}scale": "log"})
    decades = np.log10(high / low) if low > 0 else 0
    if decades < 0.7:
        axis.set_major_locator(MaxNLocator(5))
        axis.set_minor_locator(NullLocator())
    else:
        subs = (1, 2, 5) if decades < 3 else (1,)
        axis.set_major_locator(LogLocator(subs=subs, numticks=20))
    axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axis.set_minor_formatter(NullFormatter())


def draw_law(ax, name, law, place, colour):
    """A law over its range, up to the break at `place`."""
    ends = [law.low, law.high] + ([] if place is None else [place])
    fine = np.geomspace(min(ends), max(ends), 50)
    error = "" if law.error is None else rf" \pm {law.error:.2g}"
    ax.plot(fine, law.at(fine), color=colour,
            label=f"{law.factor:.3g} {run_data.symbol(name)}"
            f"$^{{{law.exponent:.2f}{error}}}$")


def draw_quantity(ax, name, x, runs, what, laws, place, log_log):
    """One panel. Values that a logarithmic axis cannot hold are left out."""
    y = column(runs, what)
    keep = (y > 0) if log_log else np.ones(len(y), bool)
    for law, colour in zip(laws, (GREY, BLUE)):
        draw_law(ax, name, law, place, colour)
    ax.plot(x[keep], y[keep], "o", color=COLOUR)
    if laws:
        ax.legend(frameon=False)
    if place is not None:
        ax.axvline(place, color=GREY, lw=0.8, ls=":")
    if log_log or (x.min() > 0 and x.max() > 5 * x.min()):
        set_log_axis(ax.xaxis, x)
    if log_log and keep.any():
        set_log_axis(ax.yaxis, y[keep])


def plot_sweep(path, name, x, runs, fits, place, log_log):
    units = units_of(runs)
    fig, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for ax, what in zip(axes, TITLES):
        draw_quantity(ax, name, x, runs, what, fits[what], place, log_log)
        ax.set_xlabel(run_data.symbol(name))
        ax.set_ylabel("run-out / base" if what == "runout" else
                      run_data.label("height", units.length))
        ax.spines[["top", "right"]].set_visible(False)
    fig.savefig(path, dpi=150)
    plt.close(fig)


def draw_outlines(ax, profiles, unit):
    """The outlines of one run; returns how far to the right they go."""
    right = 0.0
    for k, (time, x, height, _) in enumerate(profiles):
        shade = plt.get_cmap("copper_r")((k + 1) / (len(profiles) + 1))
        half = 0.5 * (x[1] - x[0])  # up to the side of the column
        ax.plot(np.r_[x[0] - half, x], np.r_[height[0], height], color=shade,
                lw=1.2, label=f"$t$ = {time:.3g} {unit}")
        right = max(right, x[np.nonzero(height)[0][-1]])
    ax.margins(x=0)
    ax.set_ylim(bottom=0)
    return right


def plot_panels(path, name, runs):
    """At most five times, evenly spread, in each panel; the panels have axes
    in common if the heaps are alike in size."""
    units = units_of(runs)
    chosen = [run_data.choose(run_data.without_repeat(
        [p for p in run_data.read_profiles(run.directory) if len(p.x) > 1]),
        5) for run in runs]
    tops = [max(p.height.max() for p in profiles) for profiles in chosen
            if profiles]
    alike = bool(not tops or max(tops) < 3 * min(tops))
    fig, axes = plt.subplots(len(runs), 1, sharex=alike, sharey=alike,
                             squeeze=False, layout="constrained",
                             figsize=(7, 0.4 + (1.25 if alike else 1.5)
                                      * len(runs)))
    rights = [draw_outlines(ax, profiles, units.time)
              for ax, profiles in zip(axes[:, 0], chosen)]
    for ax, run, profiles, right in zip(axes[:, 0], runs, chosen, rights):
        if profiles:
            ax.set_xlim(right=1.02 * (max(rights) if alike else right))
        ax.set_title(f"{run_data.symbol(name)} = {run.value}"
                     + ("" if profiles else ": no grains"), loc="left",
                     fontsize=9, pad=2)
        ax.spines[["top", "right"]].set_visible(False)
        if profiles:
            ax.legend(fontsize=7, frameon=False, loc="upper right", ncol=2)
    axes[-1, 0].set_xlabel(run_data.label(units.across, units.length))
    fig.supylabel(run_data.label("height", units.length), fontsize="medium")
    fig.savefig(path, dpi=150)
    plt.close(fig)


def write_results(options, name, runs, output):
    table = output / "sweep.csv"
    write_table(table, name, runs)
    print(table.read_text(encoding="utf-8"), end="")
    x = numbers(runs)
    place = place_of_break(options, name, x, runs)
    fits = fits_of(x, runs, place)
    say_fits(name, fits, place is not None)
    print(table)
    if any(fits.values()):
        write_fits(output / "fits.csv", name, fits)
        print(output / "fits.csv")
    if x is not None:
        plot_sweep(output / "sweep.png", name, x, runs, fits, place,
                   options.log_log or place is not None)
        print(output / "sweep.png")
    plot_panels(output / "panels.png", name, runs)
    print(output / "panels.png")


def parse_options():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("case", metavar="CASE.lua", type=pathlib.Path,
                        help="the case to run")
    parser.add_argument("words", nargs="+", metavar="name=value",
                        help="first the values to run, then what all runs get")
    parser.add_argument("-o", "--output", metavar="DIR", type=pathlib.Path,
                        help="where to run and write, default CASE-name")
    parser.add_argument("--base", metavar="LENGTH", default="1",
                        help="of the column at the start, a number or an\n"
                        "expression, default 1")
    parser.add_argument("--log-log", action="store_true",
                        help="logarithmic axes; they are with --break")
    parser.add_argument("--break", metavar="X|find", dest="break_at",
                        help="two power laws that meet there")
    parser.add_argument("--talus", type=pathlib.Path,
                        default=run_cases.TALUS,
                        help="the program, default that of build/")
    return parser.parse_intermixed_args()


def check_options(options, name, values):
    """Refuse what cannot be drawn before anything is run."""
    if "" in values:
        fail(f"{name}={','.join(values)}: a value is empty")
    if is_plain(options.base) and not ("," not in options.base
                                       and float(options.base) > 0):
        fail(f"--base {options.base}: a length > 0 is needed")
    positive = all(is_plain(v) and float(v) > 0 for v in values)
    wants = "--break" if options.break_at else "--log-log"
    if (options.log_log or options.break_at) and not positive:
        fail(f"{wants}: all values of {name} must be numbers > 0")
    at = options.break_at
    if at and at != "find" and not (is_plain(at) and "," not in at
                                    and float(at) > 0):
        fail(f"--break {at}: a number > 0 or `find` is needed")
    if at == "find" and len(set(values)) < power_law.FEWEST_TO_SEARCH:
        fail(f"--break find: {power_law.FEWEST_TO_SEARCH} values of {name} or "
             f"more are needed, {len(set(values))} given")


def main():
    options = parse_options()
    name, values = split_word(options.words[0])
    values = values.split(",")
    check_options(options, name, values)
    if not options.case.is_file():
        fail(f"there is no case '{options.case}'")
    options.talus = run_cases.check_program(options.talus)
    output = options.output or pathlib.Path(f"{options.case.stem}-{name}")
    output.mkdir(parents=True, exist_ok=True)
    runs = run_all(options, name, values, options.words[1:], output)
    write_results(options, name, runs, output)


if __name__ == "__main__":
    main()
