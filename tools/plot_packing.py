#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Contours of the solid fraction and the speed of grains, of runs of
model = "four_state": figures 3 to 6 of [lee_huang_chiew_2015].

  tools/plot_packing.py DIR [DIR ...] [--times TIME ...] [--scale NUMBER]
                        [-o PICTURE]

A row for each TIME (default 0.5, 1, 2, 3), the nearest snapshot, in units of
SCALE (default: the parameter tau_c). Left the contours nu = 0.1, 0.3, 0.5, those
of further runs dashed over those of the first; right the speed of the grains of
the first run within nu = 0.1.
"""
import argparse
import pathlib
import sys

import run_data  # first: it says so if one of the next is missing
import matplotlib.pyplot as plt
import numpy as np

import plot

PACKING = "solid_fraction"
CONTOURS = [0.1, 0.3, 0.5]
STYLES = ["solid", "dashed", "dotted", "dashdot"]


def nearest(directory, time):
    """The snapshot nearest to a time."""
    snapshots = [run_data.Snapshot(path)
                 for path in run_data.find_snapshots(directory)]
    if not snapshots or PACKING not in snapshots[0].fields:
        sys.exit(f"plot_packing: '{directory}' holds no snapshots with the "
                 f"field {PACKING}, which model = \"four_state\" writes")
    return min(snapshots, key=lambda s: abs(s.time - time)).slice()


def draw_contours(ax, snapshot, window, style):
    spacing = plot.raster_spacing(snapshot, window)
    x, z, nu = snapshot.sample(snapshot.fields[PACKING],
                               plot.snap_window(window, snapshot, spacing),
                               spacing)
    ax.contour(x, z, np.nan_to_num(nu), CONTOURS, linewidths=0.8,
               colors=[plot.EARTH, plot.BLUE, "black"], linestyles=style)


def draw_speed(ax, snapshot, window, most):
    spacing = plot.raster_spacing(snapshot, window)
    window = plot.snap_window(window, snapshot, spacing)
    speed = np.linalg.norm(snapshot.fields[run_data.VELOCITY], axis=1)
    speed[snapshot.fields[PACKING] < CONTOURS[0]] = np.nan
    _, _, v = snapshot.sample(speed, window, spacing)
    return ax.imshow(v, origin="lower", extent=window, cmap="viridis", vmin=0,
                     vmax=most, interpolation="nearest")


def make_figure(directories, times, scale, words):
    rows = [[nearest(d, t * scale) for d in directories] for t in times]
    low = np.min([row[0].low[row[0].fields[PACKING] >= CONTOURS[0]].min(axis=0)
                  for row in rows], axis=0)
    high = np.max([row[0].high[row[0].fields[PACKING] >= CONTOURS[0]].max(
        axis=0) for row in rows], axis=0)
    window = [low[0], high[0] + 0.04 * (high[0] - low[0]),
              low[1], high[1] + 0.04 * (high[1] - low[1])]
    most = max(np.linalg.norm(row[0].fields[run_data.VELOCITY], axis=1)[
        row[0].fields[PACKING] >= CONTOURS[0]].max() for row in rows)
    fig, axes = plt.subplots(len(rows), 2, squeeze=False, sharex=True,
                             sharey=True, figsize=(10, 1.8 * len(rows) + 0.6),
                             layout="constrained")
    for axs, row, time in zip(axes, rows, times):
        for snapshot, style in zip(row, STYLES):
            draw_contours(axs[0], snapshot, window, style)
        image = draw_speed(axs[1], row[0], window, most)
        axs[0].set_title(f"$t$ = {time:g} {words}", loc="left", fontsize=9)
        for ax in axs:
            ax.set_aspect("equal")
    fig.colorbar(image, ax=axes[:, 1].tolist(), label="speed (m/s)")
    for ax in axes[-1]:
        ax.set_xlabel("x (m)")
    return fig


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("directories", metavar="DIR", type=pathlib.Path,
                        nargs="+", help="runs with snapshots")
    parser.add_argument("--times", metavar="TIME", type=float, nargs="+",
                        default=[0.5, 1, 2, 3], help="in units of SCALE")
    parser.add_argument("--scale", type=float, help="unit of the times, s")
    parser.add_argument("-o", "--output", metavar="PICTURE", type=pathlib.Path,
                        help="default DIR/packing.png")
    options = parser.parse_args()
    first = options.directories[0]
    scale = options.scale or run_data.number(run_data.read_parameters(first),
                                             "tau_c") or 1
    words = r"$\tau_c$" if not options.scale else f"x {scale:g} s"
    path = options.output or first / "packing.png"
    make_figure(options.directories[:len(STYLES)], options.times, scale,
                words).savefig(path, dpi=150)
    print(path)


if __name__ == "__main__":
    main()
