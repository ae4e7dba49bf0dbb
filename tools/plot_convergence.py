#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""report.csv of tests/convergence as a table and as pictures.

  tools/plot_convergence.py report.csv

Prints the rows, then those that failed once more, and draws one picture per
case beside the file, NAME.png: a panel for each norm. Values on several levels
stand over the cells along an edge, 2^level, a line per grid, errors with
slopes of order 1 and 2; values on one level stand beside each other by grid;
and norms with a single value share a panel, as parts of their bars. A short
dash is a bar, a red ring a row that failed. Without matplotlib only the table.
"""
import csv
import math
import pathlib
import re
import sys

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.lines import Line2D
    from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator
except ImportError:
    plt = None

COLUMNS = ["case", "grid", "norm", "level", "value", "order", "bar", "verdict"]
RIGHT = {"level", "value", "order"}
INK, RED, GREY = "#222222", "#b5382b", "#999999"
COLOURS = ["#24639c", "#8a5a22", "#3d7d3a", "#7a4b9a", "#c8862a", "#4aa0a8",
           "#555555"]
MARKERS = "osD^vP*"


def read_rows(path):
    """The rows, with numbers as text; those cut short are filled with ""."""
    with open(path, newline="", encoding="utf-8") as f:
        return [{name: row.get(name) or "" for name in COLUMNS}
                for row in csv.DictReader(f)]


def number(text):
    try:
        return float(text)
    except ValueError:
        return math.nan


# Table


def print_rows(rows):
    """Columns as wide as they must be, a line between cases."""
    heading = {name: name for name in COLUMNS}
    width = {name: max(len(row[name]) for row in [heading] + rows)
             for name in COLUMNS}
    before = None
    for row in [heading] + rows:
        repeated = row["case"] == before
        if not repeated and before is not None:
            print("-" * (sum(width.values()) + 2 * len(COLUMNS) - 2))
        before = row["case"]
        cells = dict(row, case="" if repeated else row["case"])
        print("  ".join(
            cells[name].rjust(width[name]) if name in RIGHT
            else cells[name].ljust(width[name]) for name in COLUMNS).rstrip())


def print_report(rows):
    if rows:
        print_rows(rows)
    failed = [row for row in rows if row["verdict"] != "pass"]
    print(f"\n{len(rows)} rows, {len(failed)} failed")
    if failed:
        print()
        print_rows(failed)


# What a row says


class Point:
    """A row with numbers: value, and the bar it must keep to, if any."""

    def __init__(self, row):
        self.grid = row["grid"]
        self.level = number(row["level"])
        self.value = number(row["value"])
        self.has_order = row["order"] != ""
        self.failed = row["verdict"] != "pass"
        self.bar, self.at_least = math.nan, False
        for part in row["bar"].split(";"):
            match = re.fullmatch(r"\s*([<>])= (\S+)\s*", part)
            if match:
                self.at_least = match.group(1) == ">"
                self.bar = number(match.group(2))

    def part_of_bar(self):
        """0: far from the bar, 1: at it, more: beyond."""
        low, high = ((self.bar, self.value) if self.at_least
                     else (self.value, self.bar))
        return low / high if high > 0 else math.nan


def gather(rows):
    """{norm: {grid: [points by level]}} of the rows with a number."""
    norms = {}
    for row in rows:
        point = Point(row)
        if math.isfinite(point.value) and math.isfinite(point.level):
            norms.setdefault(row["norm"], {}).setdefault(
                point.grid, []).append(point)
    for grids in norms.values():
        for points in grids.values():
            points.sort(key=lambda point: point.level)
    return norms


def has_levels(grids):
    return any(len({p.level for p in points}) > 1 for points in grids.values())


def wants_log(points):
    """Errors, and what spreads over more than a factor of ten."""
    values = [p.value for p in points] + [
        p.bar for p in points if math.isfinite(p.bar)]
    if min(values) <= 0:
        return False
    return any(p.has_order for p in points) or max(values) > 10 * min(values)


# Panels


def draw_points(ax, x, points, colour, marker, line):
    """Values, rings around those that failed, and dashes at their bars."""
    ax.plot(x, [p.value for p in points], line, color=colour, marker=marker,
            ms=5, lw=1.3, zorder=3)
    bars = [(a, p.bar) for a, p in zip(x, points) if math.isfinite(p.bar)]
    if bars:
        ax.plot(*zip(*bars), "_", color=colour, ms=15, mew=1.6, zorder=2)
    failed = [(a, p.value) for a, p in zip(x, points) if p.failed]
    if failed:
        ax.plot(*zip(*failed), "o", mfc="none", mec=RED, ms=11, mew=1.4,
                zorder=4)


def draw_slopes(ax, levels, points):
    """Orders 1 and 2, from above the largest error on the first level."""
    ends = min(levels), max(levels)
    start = 2 * max(p.value for p in points if p.level == ends[0])
    for order, line in ((1, "--"), (2, ":")):
        ax.plot([2.0 ** l for l in ends],
                [start * 2.0 ** (-order * (l - ends[0])) for l in ends],
                line, color=GREY, lw=0.8, zorder=1)


def handles_of(points, slopes):
    """Legend entries for the signs in use."""
    found = []
    if any(math.isfinite(p.bar) for p in points):
        found.append(Line2D([], [], ls="", marker="_", color=INK, ms=12,
                            mew=1.6, label="bar"))
    if any(p.failed for p in points):
        found.append(Line2D([], [], ls="", marker="o", mfc="none", mec=RED,
                            ms=9, mew=1.4, label="failed"))
    if slopes:
        found += [Line2D([], [], ls=line, color=GREY, lw=0.8,
                         label=f"order {order}")
                  for order, line in ((1, "--"), (2, ":"))]
    return found


def put_legend(ax, handles):
    if handles:
        ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1),
                  borderaxespad=0, fontsize=8)


def set_scale(ax, points):
    if wants_log(points):
        ax.set_yscale("log")
    else:
        ax.margins(y=0.15)
        if all(p.value == int(p.value) and p.value >= 0 for p in points):
            ax.set_ylim(bottom=0)  # counts
            ax.yaxis.set_major_locator(MaxNLocator(integer=True))


def draw_levels(ax, grids, style):
    """Values over the cells along an edge, a line per grid."""
    points = [p for series in grids.values() for p in series]
    levels = sorted({p.level for p in points})
    slopes = any(p.has_order for p in points) and wants_log(points)
    handles = []
    for grid, series in grids.items():
        colour, marker = style[grid]
        draw_points(ax, [2.0 ** p.level for p in series], series, colour,
                    marker, "-")
        handles.append(Line2D([], [], color=colour, marker=marker, ms=5,
                              lw=1.3, label=grid))
    if slopes:
        draw_slopes(ax, levels, points)
    set_scale(ax, points)
    ax.set_xscale("log", base=2)
    ax.xaxis.set_major_locator(FixedLocator([2.0 ** l for l in levels]))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.set_xticklabels([f"{2 ** l:g}" for l in levels])
    ax.margins(x=0.12)
    ax.set_xlabel("cells")
    put_legend(ax, handles + handles_of(points, slopes))


def draw_grids(ax, grids, style):
    """Values on one level, side by side."""
    points = [p for series in grids.values() for p in series]
    for k, (grid, series) in enumerate(grids.items()):
        draw_points(ax, [k] * len(series), series, *style[grid], "")
    set_scale(ax, points)
    ax.set_xlim(-0.6, len(grids) - 0.4)
    ax.set_xticks(range(len(grids)))
    ax.set_xticklabels(grids, rotation=30, ha="right", fontsize=8,
                       rotation_mode="anchor")
    put_legend(ax, handles_of(points, False))


def draw_parts(ax, singles, style):
    """Norms with one value: how much of the bar it takes."""
    most = 0
    for k, (norm, point) in enumerate(singles):
        part = point.part_of_bar()
        shown = min(max(part, 0), 2) if math.isfinite(part) else 2
        most = max(most, shown)
        colour, marker = style[point.grid]
        ax.plot([0, shown], [k, k], "-", color=colour, lw=1.3)
        ax.plot(shown, k, marker=">" if part > 2 else marker, color=colour,
                ms=5)
        if point.failed:
            ax.plot(shown, k, "o", mfc="none", mec=RED, ms=11, mew=1.4)
        ax.annotate(f"{point.value:.3g}", (1.02, k), fontsize=8, va="center",
                    xycoords=("axes fraction", "data"), color=INK)
    ax.axvline(1, color=INK, lw=1)
    ax.set_xlim(0, 1.1 * max(1, most))
    ax.set_ylim(len(singles) - 0.5, -0.5)
    ax.set_yticks(range(len(singles)))
    ax.set_yticklabels([f"{norm} ({point.grid})" if point.grid else norm
                        for norm, point in singles], fontsize=8)
    ax.set_xlabel("part of the bar (line); value on the right")


def panels_of(norms):
    """[(title, function that draws)]: norms on levels, then those on one
    level, then the single ones."""
    levels = [n for n, grids in norms.items() if has_levels(grids)]
    singles = [(n, points[0]) for n, grids in norms.items() if len(grids) == 1
               for points in grids.values() if len(points) == 1]
    lonely = {n for n, _ in singles}
    beside = [n for n in norms if n not in levels and n not in lonely]
    barred = [s for s in singles if math.isfinite(s[1].bar)]
    panels = [(n, lambda ax, style, n=n: draw_levels(ax, norms[n], style))
              for n in levels]
    panels += [(n, lambda ax, style, n=n: draw_grids(ax, norms[n], style))
               for n in beside]
    if barred:
        panels.append(("single values",
                       lambda ax, style: draw_parts(ax, barred, style)))
    return panels


def draw_case(name, rows, path):
    """False if the case has nothing to show."""
    norms = gather(rows)
    panels = panels_of(norms)
    if not panels:
        return False
    grids = list(dict.fromkeys(g for grids in norms.values() for g in grids))
    style = {g: (COLOURS[k % len(COLOURS)], MARKERS[k % len(MARKERS)])
             for k, g in enumerate(grids)}
    columns = 1 if len(panels) == 1 else 2
    lines = -(-len(panels) // columns)
    fig, axes = plt.subplots(lines, columns, squeeze=False,
                             figsize=(6.2 * columns, 3.3 * lines + 0.3),
                             layout="constrained")
    for ax, (title, draw) in zip(axes.flat, panels):
        draw(ax, style)
        ax.set_title(title, loc="left", fontsize=10)
        ax.grid(axis="y", color="#e8e8e8", lw=0.6)
        ax.set_axisbelow(True)
    for ax in list(axes.flat)[len(panels):]:
        ax.axis("off")
    fig.suptitle(name, fontsize=11)
    fig.savefig(path, dpi=120)
    plt.close(fig)
    return True


def draw_report(rows, directory):
    plt.rcParams.update({
        "font.size": 9, "axes.edgecolor": INK, "axes.linewidth": 0.8,
        "axes.spines.top": False, "axes.spines.right": False,
        "legend.frameon": False
    })
    for name in dict.fromkeys(row["case"] for row in rows):
        draw_case(name, [row for row in rows if row["case"] == name],
                  directory / f"{name}.png")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    path = pathlib.Path(sys.argv[1])
    try:
        rows = read_rows(path)
    except OSError as error:
        sys.exit(f"plot_convergence: {error}")
    print_report(rows)
    if plt is None:
        print("no matplotlib: pictures are left out")
    else:
        draw_report(rows, path.parent)


if __name__ == "__main__":
    main()
