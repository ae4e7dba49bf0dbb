#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and a film of a run.

  tools/plot.py DIR [--reference FILE] [--time-scale SCALE] [--no-film] ...

Writes into DIR (or --output):
  outlines.png      the heap at the times of profile.csv; left out where the
                    surface is level
  fields-final.png  grid, speed, pressure, viscosity of the last snapshot
  history.png       front, height, energies, cells against time
  film.gif          all snapshots (film.mp4 too where ffmpeg is installed)

Outlines are laid over those of a reference (run_data.Reference) where the
parameter `reference` of the case names a file or --reference gives one, its
heights scaled to the area of the heap; SCALE is one unit of its time in units
of the run's, a number or sqrt(number), by default sqrt(a). Units: those the
parameters `length_unit` and `time_unit` name; without them L0 and sqrt(L0/g)
in a case with |gravity| = 1, else m and s.
"""
import argparse
import pathlib
import shutil
import sys

import run_data  # first: it says so if one of the next is missing
from run_data import FRACTION, VELOCITY, Units, label
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.ticker import (FuncFormatter, LogLocator, MaxNLocator,
                               NullLocator)

SAND, EARTH, INK = "#e3c48d", "#8a5a22", "#222222"
BLUE, RED, GREEN, GREY = "#24639c", "#b5382b", "#3d7d3a", "#777777"
# In every picture: a run that replaces another removes those alone that have it
# (src/io/old_run.c).
SIGNATURE = "talus plot"
GRAINS = LinearSegmentedColormap.from_list("grains", ["#f7f9fb", SAND])

plt.rcParams.update({
    "figure.dpi": 110,
    "savefig.dpi": 150,
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.edgecolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
})


def title_of(parameters, directory):
    title = parameters.get("title", "").strip()
    return title or pathlib.Path(directory).resolve().name


class Sheet:
    """Panels of one shape in rows and columns, laid out in inches, each with
    room for a colour bar if `bars`; the titles have room however narrow the
    panels are."""

    def __init__(self, count, columns, aspect, bars, lines=1, width=9.6):
        rows = -(-count // columns)
        head, foot, left, gap = 0.06 + 0.23 * lines, 0.5, 0.78, 0.36
        right = 0.75 if bars else 0.25
        w = width / columns - left - right
        h = min(max(w / aspect, 0.5), 6.0)
        w = min(w, h * aspect) if h == 6.0 else w
        step = h + gap + (0.12 if columns == 1 else 0.15)
        pitch = max(left + w + right, 2.3)
        total = max(columns * pitch, 4.8), head + rows * step + foot - 0.1
        self.fig = plt.figure(figsize=total)
        self.columns = columns
        self.axes, self.bars = [], []
        for k in range(count):
            x = (left + (k % columns) * pitch
                 + 0.5 * (total[0] - columns * pitch))
            y = total[1] - head - (k // columns + 1) * step + 0.1
            self.axes.append(self._add(x, y, w, h))
            if bars:
                self.bars.append(self._add(x + w + 0.08, y, 0.12, h))

    def _add(self, x, y, w, h):
        full = self.fig.get_size_inches()
        return self.fig.add_axes([x / full[0], y / full[1], w / full[0],
                                  h / full[1]])

    def name_axes(self, units):
        """Numbers at every panel, names at the outer ones only."""
        for k, ax in enumerate(self.axes):
            ax.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
            if k % self.columns == 0:
                ax.set_ylabel(label("height", units.length))
            if k + self.columns >= len(self.axes):
                ax.set_xlabel(label("$x$", units.length), labelpad=2)
            else:
                ax.tick_params(labelbottom=False)

    def head(self, text):
        size = self.fig.get_size_inches()
        title = self.fig.text(0.5, 1 - 0.08 / size[1], text, ha="center",
                              va="top", fontsize=11)
        width = title.get_window_extent().width / self.fig.dpi
        title.set_fontsize(11 * min(1, (size[0] - 0.2) / width))


# Outlines


class Outline:
    """One panel: the heap at a time, and the reference if it has that time."""

    def __init__(self, profile, reference, scale):
        self.time, x, height = profile
        half = 0.5 * (x[1] - x[0])  # up to the sides of the box
        self.x = np.r_[x[0] - half, x, x[-1] + half]
        self.height = np.r_[height[0], height, height[-1]]
        self.other = None
        heights = reference.at(self.time / scale) if reference else None
        if heights is None:
            return
        self.difference, factor = run_data.compare(x, height, reference.x,
                                                   heights)
        last = np.max(np.nonzero(heights)[0], initial=0) + 1
        self.other = reference.x[:last], factor * heights[:last]
        self.other_time = self.time / scale

    def right(self):
        return max([self.x[-1]] + ([self.other[0][-1]] if self.other else []))

    def top(self):
        return max([self.height.max()]
                   + ([self.other[1].max()] if self.other else []))

    def draw(self, ax, units, name, reference_unit):
        ax.fill_between(self.x, self.height, color=SAND, lw=0)
        ax.plot(self.x, self.height, color=EARTH, lw=1.4, label="Talus")
        text = f"$t$ = {self.time:.3g} {units.time}"
        if self.other:
            ax.plot(*self.other, "o", ms=2.8, mfc="none", mec=BLUE, mew=0.8,
                    label=name, clip_on=False)
            text += (f"  (reference: {self.other_time:.3g} {reference_unit}; "
                     f"differs by {100 * self.difference:.2g} %)")
        ax.set_title(text, loc="left", pad=3, fontsize=9)


def has_shape(profiles):
    """Whether there is a heap to see, not only a level surface."""
    return any(np.ptp(height) > 1e-2 * height.max()
               for _, _, height in profiles)


def unit_of_reference(options, units, scale):
    """In which unit a reference has its times (run_data.parse_scale)."""
    if scale == 1:
        return units.time
    return "" if options.time_scale else r"$\sqrt{H_0/g}$"


def plot_outlines(options, parameters, units, reference, scale):
    profiles = run_data.without_repeat(
        [p for p in run_data.read_profiles(options.directory)
         if len(p[1]) > 1])
    if not has_shape(profiles):
        return None
    outlines = [Outline(p, reference, scale)
                for p in run_data.choose(profiles, 6)]
    left = min(o.x[0] for o in outlines)
    width = 1.03 * (max(o.right() for o in outlines) - left)
    height = 1.08 * max(o.top() for o in outlines)
    columns = 1 if len(outlines) == 1 or width > 5 * height else 2
    if width < 0.8 * height:
        columns = min(3, len(outlines))
    sheet = Sheet(len(outlines), columns, width / height, bars=False)
    name = reference.name if reference else ""
    for ax, outline in zip(sheet.axes, outlines):
        outline.draw(ax, units, name,
                     unit_of_reference(options, units, scale))
        ax.set_xlim(left, left + width)
        ax.set_ylim(0, height)
    sheet.name_axes(units)
    drawn = [ax for ax, o in zip(sheet.axes, outlines) if o.other]
    if drawn:
        drawn[0].legend(loc="upper right", fontsize=9)
    solid = parameters.get("dimension") == "3"
    sheet.head(title_of(parameters, options.directory)
               + (", along $x$ through the top" if solid else ""))
    return save(sheet.fig, options, "outlines.png")


# Fields


def window_of(snapshot, margin=0.06):
    """[x0, x1, z0, z1] around the grains, within the box."""
    x0, x1, z0, z1 = snapshot.box_of_grains()
    width, height = x1 - x0, z1 - z0
    x0, x1 = x0 - margin * width, x1 + margin * width
    z1 += max(0.15 * height, 0.03 * width)
    box = [snapshot.low[:, 0].min(), snapshot.high[:, 0].max(),
           snapshot.low[:, 1].min(), snapshot.high[:, 1].max()]
    return [max(x0, box[0]), min(x1, box[1]), z0, min(z1, box[3])]


def raster_spacing(snapshot, window, most=1500):
    """The finest cell, or coarser if the raster would be too large."""
    spacing = float((snapshot.high - snapshot.low).min())
    while (window[1] - window[0]) / spacing > most:
        spacing *= 2
    return spacing


def snap_window(window, snapshot, spacing):
    """The window moved outwards to edges of the raster of the cells."""
    origin = snapshot.low.min(axis=0)
    out = []
    for k, d in enumerate((0, 0, 1, 1)):
        place = (window[k] - origin[d]) / spacing
        place = np.floor(place + 1e-6) if k % 2 == 0 else np.ceil(place - 1e-6)
        out.append(origin[d] + spacing * place)
    return out


def tracers_of(snapshot):
    return [n for n, title in snapshot.titles.items()
            if "tracer" in title and snapshot.fields[n].max() > 0.5]


def draw_contours(ax, snapshot, window, spacing, core):
    """The surface of the grains, and in the colour `core` the tracers; returns
    what was drawn."""
    drawn = []
    for name, colour, style in [(FRACTION, INK, "-")] + [
            (n, core, "--") for n in tracers_of(snapshot)]:
        if name not in snapshot.fields:
            continue
        x, z, v = snapshot.sample(snapshot.fields[name], window, spacing)
        if min(v.shape) < 2 or np.nanmin(v) > 0.5 or np.nanmax(v) < 0.5:
            continue
        # up to the sides of the window
        x, z = np.r_[window[0], x, window[1]], np.r_[window[2], z, window[3]]
        drawn.append(ax.contour(x, z, np.pad(v, 1, mode="edge"), [0.5],
                                colors=[colour], linewidths=0.9,
                                linestyles=[style]))
    return drawn


def remove(contour):
    if hasattr(contour, "remove"):  # matplotlib 3.8 and later
        contour.remove()
    else:
        for artist in contour.collections:
            artist.remove()


def draw_cells(ax, snapshot, window, values, norm, cmap, lines):
    """Every cell of the window in its colour, with its edges."""
    low, high = snapshot.low, snapshot.high
    keep = ((high[:, 0] > window[0]) & (low[:, 0] < window[1])
            & (high[:, 1] > window[2]) & (low[:, 1] < window[3]))
    low, high = low[keep], high[keep]
    squares = np.stack([low, np.c_[high[:, 0], low[:, 1]], high,
                        np.c_[low[:, 0], high[:, 1]]], axis=1)
    cells = PolyCollection(squares, array=values[keep], norm=norm, cmap=cmap)
    cells.set_edgecolor((0, 0, 0, 0.45) if lines else "face")
    # thinner where there are many
    pixels = 1400 * (high - low).min() / (window[1] - window[0])
    cells.set_linewidth(min(0.35, 0.06 * pixels) if lines else 0.2)
    ax.add_collection(cells)


def draw_grains(ax, snapshot, window, spacing, values, norm, cmap):
    """A raster of a field, as opaque as there are grains; returns the image."""
    image = ax.imshow(colours(snapshot, window, spacing, values, norm, cmap),
                      origin="lower", extent=window, interpolation="nearest",
                      aspect="auto")
    return image


def colours(snapshot, window, spacing, values, norm, cmap):
    _, _, v = snapshot.sample(values, window, spacing)
    rgba = plt.get_cmap(cmap)(norm(np.nan_to_num(v)))
    if FRACTION in snapshot.fields:
        _, _, c = snapshot.sample(snapshot.fields[FRACTION], window, spacing)
        rgba[..., 3] = np.clip(np.nan_to_num(c), 0, 1)
    return rgba


def draw_bar(cax, norm, cmap):
    bar = cax.figure.colorbar(ScalarMappable(norm, cmap), cax=cax)
    log = isinstance(norm, LogNorm)
    bar.outline.set_linewidth(0.5)
    bar.locator = LogLocator(numticks=5) if log else MaxNLocator(4)
    bar.formatter = FuncFormatter(
        lambda v, _: f"$10^{{{round(np.log10(v))}}}$" if log else f"{v:.3g}")
    bar.update_ticks()
    bar.ax.yaxis.set_minor_locator(NullLocator())
    bar.ax.tick_params(labelsize=8)


def norm_of(values, log=False):
    """A scale over the values, logarithmic only if it pays."""
    low, high = float(values.min()), float(values.max())
    if log and low > 0 and high > 10 * low:
        return LogNorm(low, high)
    return Normalize(min(0.0, low), high if high > low else low + 1.0)


def panels_of(snapshot, units):
    """[(title, values, norm, cmap)] of the fields to show."""
    fields = snapshot.fields
    grains = fields[FRACTION] > 0.5 if FRACTION in fields else np.ones(
        len(snapshot.low), bool)
    if not grains.any():
        grains[:] = True
    found = []
    if VELOCITY in fields:
        found.append((VELOCITY, "speed", np.linalg.norm(fields[VELOCITY], axis=1),
                      "viridis", False))
    for name, cmap, log in (("pressure", "magma", False),
                            ("viscosity", "cividis", True)):
        if name in fields:
            found.append((name, name, fields[name], cmap, log))
    return [(label(title, units.field(snapshot.units[name])), values,
             norm_of(values[grains], log), cmap)
            for name, title, values, cmap, log in found]


def plot_fields(options, parameters, units):
    paths = run_data.find_snapshots(options.directory)
    if not paths:
        return None
    snapshot = run_data.Snapshot(paths[-1]).slice()
    window = window_of(snapshot)
    spacing = raster_spacing(snapshot, window)
    window = snap_window(window, snapshot, spacing)
    panels = panels_of(snapshot, units)
    fraction = snapshot.fields.get(FRACTION, np.ones(len(snapshot.low)))
    aspect = (window[1] - window[0]) / (window[3] - window[2])
    columns = 1 if aspect > 3.5 else 2 if aspect > 0.5 else 1 + len(panels)
    sheet = Sheet(1 + len(panels), columns, aspect, bars=True, lines=2)
    draw_cells(sheet.axes[0], snapshot, window, fraction, Normalize(0, 1),
                GRAINS, not options.no_grid)
    draw_contours(sheet.axes[0], snapshot, window, spacing, RED)
    draw_bar(sheet.bars[0], Normalize(0, 1), GRAINS)
    sheet.axes[0].set_title("grains" + ("" if options.no_grid
                                        else " and grid"), loc="left", pad=4)
    for ax, bar, (title, values, norm, cmap) in zip(
            sheet.axes[1:], sheet.bars[1:], panels):
        draw_grains(ax, snapshot, window, spacing, values, norm, cmap)
        draw_contours(ax, snapshot, window, spacing, "white")
        draw_bar(bar, norm, cmap)
        ax.set_title(title, loc="left", pad=4)
    for ax in sheet.axes:
        ax.set_xlim(window[0], window[1])
        ax.set_ylim(window[2], window[3])
    sheet.name_axes(units)
    note = "".join(f"; dashed: {n}" for n in tracers_of(snapshot)[:1])
    sheet.head(f"{title_of(parameters, options.directory)}\n"
               f"$t$ = {snapshot.time:.4g} {units.time}, "
               f"{snapshot.nleaves} cells{note}")
    return save(sheet.fig, options, "fields-final.png")


# History


def driven(parameters):
    """Whether gravity does work for ever: along a direction that repeats."""
    sides = {"2": ("left", "bottom"), "3": ("left", "front", "bottom")}
    return any(g != 0 and parameters.get(f"boundary.{side}") == "periodic"
               for g, side in zip(run_data.gravity_of(parameters),
                                  sides.get(parameters.get("dimension"), ())))


def name_of_rest(parameters, change):
    """What the initial energy less all the known ones is."""
    causes = ([" work of gravity,"] if driven(parameters) else []) + (
        [" grains that left,"] if change < -1e-3 else [])
    return (f"not accounted for:\n{''.join(causes).strip()} numerical" if causes
            else "numerical")


def words_on_volume(change):
    if change < -1e-3:
        return f"grains left in the box: {100 * (1 + change):.2g} %"
    words = f"{abs(change):.1e}" if change else "none"
    return f"relative change of the volume of grains: {words}"


def plot_history(options, parameters, units):
    s = run_data.read_series(options.directory)
    if len(s["time"]) < 2:
        return None
    t = s["time"]
    change = s["volume"] / (s["volume"][0] or 1.0) - 1
    change = change[np.argmax(np.abs(change))]
    fig, axes = plt.subplots(2, 2, figsize=(9.6, 6.2), sharex=True,
                             layout="constrained")
    ax = axes[0, 0]
    ax.plot(t, s["front"], color=EARTH, label="front")
    ax.plot(t, s["height"], color=BLUE, label="height")
    ax.set_ylabel(label("length", units.length))
    if s["front"].min() >= 0:
        ax.set_ylim(bottom=0)

    ax = axes[0, 1]
    scale = abs(s["kinetic"][0] + s["potential"][0]) or 1.0
    for name, colour in (("potential", BLUE), ("kinetic", EARTH),
                         ("dissipated", RED), ("numerical", GREY)):
        ax.plot(t, s[name] / scale, color=colour, label=name_of_rest(
            parameters, change) if name == "numerical" else name)
    ax.set_ylabel("energy / initial energy")

    ax = axes[1, 0]
    ax.plot(t, s["max_speed"], color=GREEN, label="fastest grains")
    ax.set_ylabel(label("speed", units.field("m/s")))
    ax.set_ylim(bottom=0)

    ax = axes[1, 1]
    ax.plot(t, s["cells"], color=INK, label="cells of the grid")
    ax.set_ylabel("cells")
    ax.set_ylim(bottom=0)
    for ax in axes.flat:
        ax.margins(x=0)
        ax.grid(alpha=0.25, lw=0.6)
        if len(ax.lines) > 1:
            ax.legend(fontsize=9, loc="best")
        else:
            ax.set_title(ax.lines[0].get_label(), loc="left")
    axes[0, 0].set_title("front and height of the heap", loc="left")
    axes[0, 1].set_title("energy of the grains", loc="left")
    rest = (run_data.arrest_time(s) if "mean_shear_rate" in s else None)
    if rest is not None:
        axes[1, 0].set_title(f"fastest grains; at rest after {rest:.3g} "
                             f"{units.time}", loc="left")
        axes[1, 0].axvline(rest, color=GREY, lw=0.8)
    for ax in axes[1]:
        ax.set_xlabel(label("time", units.time))
    fig.suptitle(f"{title_of(parameters, options.directory)}\n"
                 + words_on_volume(change), fontsize=11)
    return save(fig, options, "history.png")


# Film


def film_window(snapshots):
    """The union of the windows of all frames."""
    windows = np.array([window_of(s, margin=0.04) for s in snapshots])
    return [windows[:, 0].min(), windows[:, 1].max(), windows[:, 2].min(),
            windows[:, 3].max()]


def speed(snapshot):
    return np.linalg.norm(snapshot.fields[VELOCITY], axis=1)


def top_speed(snapshot):
    """Of all grains but the fastest, which are few and would leave the rest
    dark."""
    values = speed(snapshot)
    if FRACTION in snapshot.fields:
        values = values[snapshot.fields[FRACTION] > 0.5]
    return float(np.quantile(values, 0.99)) if values.size else 0.0


def make_film(options, parameters, units):
    paths = run_data.choose(run_data.find_snapshots(options.directory),
                   options.max_frames)
    if len(paths) < 2:
        return []
    snapshots = [run_data.Snapshot(p).slice() for p in paths]
    if VELOCITY not in snapshots[0].fields:
        return []
    window = film_window(snapshots)
    spacing = min(raster_spacing(s, window, 600) for s in snapshots)
    window = snap_window(window, snapshots[0], spacing)
    norm = Normalize(0, max(map(top_speed, snapshots)) or 1.0)
    cmap = "viridis"
    aspect = (window[1] - window[0]) / (window[3] - window[2])
    sheet = Sheet(1, 1, aspect, bars=True)
    ax = sheet.axes[0]
    image = draw_grains(ax, snapshots[0], window, spacing, speed(snapshots[0]),
                        norm, cmap)
    draw_bar(sheet.bars[0], norm, cmap)
    sheet.name_axes(units)
    text = ax.set_title("", loc="left")
    sheet.head(title_of(parameters, options.directory))

    writers = [("film.gif", PillowWriter(fps=options.fps))]
    if shutil.which("ffmpeg"):
        even = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
        writers.append(("film.mp4", FFMpegWriter(
            fps=options.fps, metadata={"comment": SIGNATURE}, extra_args=even)))
    for name, writer in writers:
        writer.setup(sheet.fig, options.output / name, dpi=90)
    for snapshot in snapshots:
        image.set_data(colours(snapshot, window, spacing, speed(snapshot), norm,
                               cmap))
        contours = draw_contours(ax, snapshot, window, spacing, "white")
        text.set_text(f"$t$ = {snapshot.time:.2f} {units.time}, "
                      + label("speed", units.field("m/s")))
        for _, writer in writers:
            writer.grab_frame()
        for contour in contours:
            remove(contour)
    for _, writer in writers:
        writer.finish()
    sign_gif(options.output / "film.gif")
    plt.close(sheet.fig)
    return [options.output / name for name, _ in writers]


def sign_gif(path):
    """Adds SIGNATURE as a comment before the byte that ends a GIF."""
    data = path.read_bytes()
    words = SIGNATURE.encode()
    path.write_bytes(data[:-1] + b"\x21\xfe" + bytes([len(words)]) + words
                     + b"\x00" + data[-1:])


def save(fig, options, name):
    path = options.output / name
    fig.savefig(path, metadata={"Software": SIGNATURE})
    plt.close(fig)
    return path


def parse_options():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path)
    parser.add_argument("-o", "--output", metavar="OUT", type=pathlib.Path,
                        help="where to write the pictures, default DIR")
    parser.add_argument("--reference", metavar="FILE", type=pathlib.Path,
                        help="outlines to compare with")
    parser.add_argument("--time-scale", metavar="SCALE",
                        help="unit of time of the reference")
    parser.add_argument("--no-grid", action="store_true",
                        help="no lines of the grid in fields-final.png")
    parser.add_argument("--no-film", action="store_true",
                        help="pictures only")
    parser.add_argument("--fps", type=int, default=15,
                        help="frames a second of the film, default 15")
    parser.add_argument("--max-frames", type=int, default=150,
                        help="at most so many snapshots, default 150")
    options = parser.parse_args()
    options.output = options.output or options.directory
    return options


def main():
    options = parse_options()
    if not (options.directory / "series.csv").is_file():
        print(f"talus: error: '{options.directory}' holds no run (no series.csv)",
              file=sys.stderr)
        sys.exit(2)
    options.output.mkdir(parents=True, exist_ok=True)
    parameters = run_data.read_parameters(options.directory)
    units = Units(parameters)
    try:
        path = options.reference or run_data.find_reference(options.directory,
                                                            parameters)
        reference = run_data.Reference(path) if path else None
        scale = run_data.parse_scale(options.time_scale, parameters)
        written = [
            plot_outlines(options, parameters, units, reference, scale),
            plot_fields(options, parameters, units),
            plot_history(options, parameters, units),
        ]
        if not options.no_film:
            written += make_film(options, parameters, units)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"plot: {error}")
    for path in written:
        if path is not None:
            print(path)


if __name__ == "__main__":
    main()
