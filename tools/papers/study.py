# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs and tables behind the figures of a paper."""
import csv
import math
from typing import NamedTuple, Optional

import run_data  # first: it says so if one of the next is missing
import run_cases
import sheet  # noqa: F401, sets the look
import matplotlib.pyplot as plt
import numpy as np

EXAMPLES = run_cases.ROOT / "examples"
LINE = 0.14  # inches, of the table below a figure
MOVING = 1e-3  # sqrt(g H0): slower grains rest


class Row(NamedTuple):
    """A quantity, ours and the paper's; a bar has two ends, of which one may be
    infinite."""
    what: str
    ours: float
    paper: str = ""
    bar: Optional[tuple] = None

    def verdict(self):
        if self.bar is None:
            return ""
        return "kept" if self.bar[0] <= self.ours <= self.bar[1] else "MISSED"

    def cells(self):
        low, high = self.bar or (None, None)
        ends = ["" if end is None or math.isinf(end) else f"{end:.4g}"
                for end in (low, high)]
        return [self.what, f"{self.ours:.4g}", self.paper, *ends,
                self.verdict()]


HEADER = ["quantity", "ours", "paper", "lowest", "highest", "bar"]


def around(value, part):
    """The bar from value (1 - part) to value (1 + part)."""
    return value * (1 - part), value * (1 + part)


def within(value, distance):
    return value - distance, value + distance


def table_text(rows):
    """The rows as lines with aligned columns."""
    cells = [HEADER] + [row.cells() for row in rows]
    used = [k for k in range(len(HEADER)) if any(c[k] for c in cells[1:])]
    width = [max(len(c[k]) for c in cells) for k in range(len(HEADER))]
    return ["  ".join(c[k].ljust(width[k]) if k in (0, 2, 5) else
                      c[k].rjust(width[k]) for k in used).rstrip()
            for c in cells]


class Collapse:
    """The run of a column of half-width 1 and height a, g = 1. Times here are
    in sqrt(H0/g), which is sqrt(a), lengths in the half-width."""

    def __init__(self, directory, a):
        self.directory, self.a, self.unit = directory, a, math.sqrt(a)
        self.series = run_data.read_series(directory)
        self.time = self.series["time"] / self.unit
        self.front = self.series["front"]
        self.runout = self.front[-1] - 1
        self.height = self.series["height"][-1]
        self.energy = self.series["potential"][0]  # at the start

    def arrest(self):
        """When the mean shear rate has fallen, nan if it has not."""
        time = run_data.arrest_time(self.series)
        return math.nan if time is None else time / self.unit

    def outlines(self, times):
        """[(time, x, height)] at those of profile.csv next to the times; x
        begins at the axis."""
        profiles = run_data.read_profiles(self.directory)
        near = [min(profiles, key=lambda p, t=t: abs(p.time / self.unit - t))
                for t in times]
        return [(p.time / self.unit, np.r_[0, p.x],
                 np.r_[p.height[0], p.height]) for p in near]

    def outline(self):
        """(x, height) at the end."""
        return self.outlines([self.time[-1]])[0][1:]

    def snapshots(self, times=None):
        """Those next to the times, or all."""
        known = [run_data.Snapshot(p)
                 for p in run_data.find_snapshots(self.directory)]
        if times is None:
            return known
        return [min(known, key=lambda s, t=t: abs(s.time / self.unit - t))
                for t in times]

    def flowing(self, snapshot):
        """Which leaves of grains move."""
        speed = np.linalg.norm(snapshot.fields[run_data.VELOCITY], axis=1)
        return (snapshot.grains() > 0.5) & (speed > MOVING * self.unit)


class Study:
    """The figures of a paper: where their runs are and what they came to."""

    def __init__(self, talus, output, cells, words):
        self.talus, self.output, self.words = talus, output, words
        self.cells = cells
        self.missed = 0
        self.name = self.title = ""

    def begin(self, name, title):
        self.name, self.title = name, title
        print(f"\nfigure {name}: {title}")

    def run(self, case, name, words, may_fail=False):
        """The directory of a run of examples/CASE.lua, called `name`; None if
        it fails and may."""
        directory = self.output / "runs" / name
        directory.parent.mkdir(parents=True, exist_ok=True)
        given = {w.partition("=")[0] for w in self.words}
        words = [f"{k}={v}" for k, v in words.items() if k not in given]
        status = run_cases.run_to_end(
            self.talus, EXAMPLES / f"{case}.lua", words + self.words,
            directory, name, may_fail)
        return directory if status == 0 else None

    def collapse(self, case, a, reach, cells, output, **physics):
        """The run of a column as tall as a whose grains stay below x = reach,
        `cells` to its half-width. Its name has the physics, but not the words
        for its output, so that figures share it."""
        cells = self.cells or cells
        size = 2 ** math.ceil(math.log2(max(reach, 1.25 * a)))
        name = "-".join([f"{case}-a{a:g}"] + [
            f"{key}{value}" for key, value in physics.items()]
            + [f"cells{cells}"])
        words = {"a": a, "size": size,
                 "level": max(round(math.log2(size * cells)), 5)}
        return Collapse(self.run(case, name, words | physics | output), a)

    def finish(self, fig, rows):
        """Print the table, write it, and the figure with it below."""
        lines = table_text(rows)
        print(*lines, sep="\n")
        self.missed += sum(row.verdict() == "MISSED" for row in rows)
        self.output.mkdir(parents=True, exist_ok=True)
        path = self.output / f"fig{self.name}.csv"
        with open(path, "w", newline="", encoding="utf-8") as f:
            writer = csv.writer(f, lineterminator="\n")
            writer.writerows([HEADER] + [row.cells() for row in rows])
        self._add_below(fig, lines)
        fig.suptitle(f"Fig. {self.name}: {self.title}", fontsize=11)
        fig.savefig(path.with_suffix(".png"))
        plt.close(fig)
        print(path, path.with_suffix(".png"), sep="\n")

    @staticmethod
    def _add_below(fig, lines):
        width, height = fig.get_size_inches()
        foot = LINE * (len(lines) + 1)
        fig.set_size_inches(width, height + foot)
        part = foot / (height + foot)
        fig.get_layout_engine().set(rect=(0, part, 1, 1 - part))
        text = fig.text(0.02, part - 0.3 * LINE / (height + foot),
                        "\n".join(lines), va="top", family="monospace",
                        fontsize=8)
        room = 0.97 * width / (text.get_window_extent().width / fig.dpi)
        text.set_fontsize(min(8, 8 * room))


def make_panels(count, columns=1, width=7.5, height=3.0, **kwargs):
    """(figure, axes) of equal panels; those that are left over are hidden."""
    rows = -(-count // columns)
    fig, axes = plt.subplots(rows, columns, squeeze=False, layout="constrained",
                             figsize=(width, 0.3 + height * rows), **kwargs)
    for ax in axes.flat[count:]:
        ax.set_visible(False)
    return fig, list(axes.flat[:count])


def shades(count):
    """Colours from light to dark, one for each value."""
    return [plt.get_cmap("copper_r")((k + 1) / (count + 0.5))
            for k in range(count)]
