#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Map of the states of the grains, from the snapshots of a run.

  tools/plot_state.py DIR [TIME ...] [--scale NUMBER|PARAMETER]
                      [--field state] [-o PICTURE]

One panel for the snapshot nearest to each TIME (default: the last), times in
units of SCALE: a number, or a parameter of the case (default: tau_c if the case
has it, else 1). Of the field `state`, which the closure lee_huang gives, the
colours are those of its states and the part of the grains in each is printed;
of any other (nu, T, pE_over_p, shear_rate, ...) a scale. What is drawn is
written beside the picture, state.csv for state.png: time, centre, edges and
value of each cell of grains.
"""
import argparse
import csv
import pathlib
import sys

import run_data  # first: it says so if one of the next is missing
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap, Normalize
from matplotlib.patches import Patch

import plot

STATES = ["solid", "quasi-static", "dense", "inertial", "beyond"]
COLOURS = ListedColormap(["#b9b2a7", "#24639c", "#e3b04d", "#b5382b",
                          "#5a1a12"])


def scale_of(text, parameters):
    """(scale, words for it) of the times."""
    if text is None and "tau_c" in parameters:
        text = "tau_c"
    unit = run_data.Units(parameters).time
    value = run_data.number(parameters, text)
    if value is not None:
        return value, run_data.symbol(text)
    value = float(text or 1)
    return value, unit if value == 1 else rf"$\times$ {value:g} {unit}"


def nearest(paths, times):
    """The snapshots nearest to the times, of all the paths."""
    known = [run_data.Snapshot(path) for path in paths]
    if not times:
        return [known[-1]]
    return [min(known, key=lambda s, t=t: abs(s.time - t)) for t in times]


def print_parts(snapshot, scale):
    """How much of the grains is in each state."""
    flat = snapshot.fields[run_data.FRACTION]
    grains = flat > 0.5
    weight = (flat * np.prod(snapshot.high - snapshot.low, axis=1))[grains]
    state = snapshot.fields["state"][grains]
    parts = [weight[state == k].sum() / weight.sum()
             for k in range(len(STATES))]
    print(f"t = {snapshot.time / scale:.3g}: "
          + ", ".join(f"{name} {part:.3f}"
                      for name, part in zip(STATES, parts)))


def draw(ax, snapshot, window, field, norm, cmap):
    spacing = plot.raster_spacing(snapshot, window)
    window = plot.snap_window(window, snapshot, spacing)
    _, _, v = snapshot.sample(snapshot.fields[field], window, spacing)
    _, _, c = snapshot.sample(snapshot.fields[run_data.FRACTION], window,
                              spacing)
    rgba = plt.get_cmap(cmap)(norm(np.nan_to_num(v)))
    rgba[..., 3] = np.nan_to_num(c) > 0.5
    ax.imshow(rgba, origin="lower", extent=window, interpolation="nearest")
    plot.draw_contours(ax, snapshot, window, spacing)


def colours_of(snapshots, field):
    if field == "state":
        return BoundaryNorm(np.arange(len(STATES) + 1) - 0.5, len(STATES)), \
            COLOURS
    values = np.concatenate([s.fields[field][s.fields[run_data.FRACTION] > 0.5]
                             for s in snapshots])
    return Normalize(values.min(), values.max()), "viridis"


def make_figure(snapshots, times, units, field):
    """A panel for each snapshot, with the words for its time."""
    windows = np.array([plot.window_of(s) for s in snapshots])
    window = [windows[:, 0].min(), windows[:, 1].max(), windows[:, 2].min(),
              windows[:, 3].max()]
    aspect = (window[1] - window[0]) / (window[3] - window[2])
    rows = len(snapshots)
    fig, axes = plt.subplots(rows, 1, squeeze=False, sharex=True,
                             figsize=(7, 0.8 + rows * (0.3 + 6.2 / aspect)),
                             layout="constrained")
    norm, cmap = colours_of(snapshots, field)
    words = "" if field == "state" else ": " + run_data.label(
        snapshots[0].titles[field], units.field(snapshots[0].units[field]))
    for ax, snapshot, time in zip(axes[:, 0], snapshots, times):
        draw(ax, snapshot, window, field, norm, cmap)
        ax.set_xlim(window[:2])
        ax.set_ylim(window[2:])
        ax.set_title(f"$t$ = {time}{words}", loc="left", fontsize=9)
        ax.set_ylabel(run_data.label("height", units.length))
    axes[-1, 0].set_xlabel(run_data.label(units.across, units.length))
    if field == "state":
        fig.get_layout_engine().set(rect=(0, 0.3 / fig.get_figheight(), 1,
                                          1 - 0.3 / fig.get_figheight()))
        fig.legend(handles=[Patch(color=COLOURS(k), label=name)
                            for k, name in enumerate(STATES)],
                   loc="lower center", ncol=len(STATES), fontsize=8,
                   frameon=False)
    else:
        fig.colorbar(plt.cm.ScalarMappable(norm, cmap), ax=axes[:, 0].tolist())
    return fig


def write_data(path, snapshots, field):
    """The cells of grains in all panels, in the units of the run."""
    with open(path, "w", newline="", encoding="utf-8") as f:
        writer = csv.writer(f, lineterminator="\n")
        writer.writerow(["time", "x", "y", "width", "height", field])
        for s in snapshots:
            grains = s.fields[run_data.FRACTION] > 0.5
            low, high = s.low[grains], s.high[grains]
            for row in zip(*(low + high).T / 2, *(high - low).T,
                           s.fields[field][grains]):
                writer.writerow(f"{x:.6g}" for x in (s.time, *row))


def parse_options():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path,
                        help="a run with snapshots")
    parser.add_argument("times", metavar="TIME", type=float, nargs="*",
                        help="in units of SCALE, default the last")
    parser.add_argument("--scale", help="number or parameter of the case")
    parser.add_argument("--field", default="state",
                        help="what to draw, default state")
    parser.add_argument("-o", "--output", metavar="PICTURE", type=pathlib.Path,
                        help="default DIR/FIELD.png")
    return parser.parse_args()


def main():
    options = parse_options()
    paths = run_data.find_snapshots(options.directory)
    if not paths:
        sys.exit(f"plot_state: '{options.directory}' holds no snapshots")
    parameters = run_data.read_parameters(options.directory)
    try:
        scale, words = scale_of(options.scale, parameters)
    except ValueError:
        sys.exit(f"plot_state: '{options.scale}' is no number and no parameter "
                 "of the case that is one")
    snapshots = [s.slice() for s in
                 nearest(paths, [t * scale for t in options.times])]
    if options.field not in snapshots[0].fields:
        sys.exit(f"plot_state: no field '{options.field}' in the snapshots, "
                 f"which have {', '.join(sorted(snapshots[0].fields))}")
    if options.field == "state":
        for snapshot in snapshots:
            print_parts(snapshot, scale)
    path = options.output or options.directory / f"{options.field}.png"
    make_figure(snapshots,
                [f"{s.time / scale:.3g} {words}" for s in snapshots],
                run_data.Units(parameters), options.field).savefig(path,
                                                                   dpi=150)
    write_data(path.with_suffix(".csv"), snapshots, options.field)
    print(path, path.with_suffix(".csv"), sep="\n")


if __name__ == "__main__":
    main()
