#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and a film of a run.

  tools/plot.py DIR [--reference FILE] [--time-scale SCALE] [--no-film] ...

Writes into DIR (or --output):
  outlines.png      the heap at the times of profile.csv, twelve of them at
                    most, and in each column what of its height belongs to each
                    tracer; left out where the surface is level
  fields-final.png  grid, speed, pressure, viscosity of the last snapshot
  history.png       front, height, energies, cells against time
  film.gif          all snapshots (film.mp4 too where ffmpeg is installed)

and of a run in 3D, whose film shows the surface of its heap,
  plan.png          height over x and y at six times, with contours
  heap.png          the surface of the grains in four snapshots (heap.py)

Each tracer has its colour, the same in all of them.

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

import heap
import run_data  # first: it says so if one of the next is missing
from run_data import VELOCITY, label
from sheet import (BLUE, EARTH, GRAINS, GREEN, GREY, INK, RED, SAND, RunWords,
                   Sheet, line)
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm, Normalize, to_rgb
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import (FuncFormatter, LogLocator, MaxNLocator,
                               NullLocator)

# In every picture: a run that replaces another removes those alone that have it
# (src/io/old_run.c).
SIGNATURE = "talus plot"

# Outlines


class Outline:
    """One panel: the heap at a time, and the reference if it has that time."""

    def __init__(self, profile, reference, scale):
        self.time, x, height, layers = profile
        half = 0.5 * (x[1] - x[0])  # up to the sides of the box
        self.x = np.r_[x[0] - half, x, x[-1] + half]
        self.height = np.r_[height[0], height, height[-1]]
        self.layers = {n: np.r_[h[0], h, h[-1]] for n, h in layers.items()}
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

    def draw(self, ax, run, reference_unit):
        ax.fill_between(self.x, self.height, color=SAND, lw=0)
        for name, height in self.layers.items():
            ax.plot(self.x, height, color=run.colour(name), lw=1.1)
        ax.plot(self.x, self.height, color=EARTH, lw=1.4)
        text = f"$t$ = {self.time:.3g} {run.units.time}"
        if self.other:
            ax.plot(*self.other, "o", ms=2.8, mfc="none", mec=BLUE, mew=0.8,
                    clip_on=False)
            text += (f"\nreference: {self.other_time:.3g} {reference_unit}, "
                     f"differs by {100 * self.difference:.2g} %")
        ax.set_title(text, loc="left", pad=3, fontsize=9)


def legend_of_outlines(run, outlines, reference):
    """Entries for what is not the outline alone."""
    layers = [line(run.colour(n), f"part in {n}") for n in outlines[0].layers]
    others = ([Line2D([], [], ls="", marker="o", ms=2.8, mfc="none", mec=BLUE,
                      mew=0.8, label=reference.name)]
              if any(o.other for o in outlines) else [])
    return ([line(EARTH, "height")] + layers + others if layers or others
            else [])


def has_shape(profiles):
    """Whether there is a heap to see, not only a level surface."""
    return any(np.ptp(p.height) > 1e-2 * p.height.max() for p in profiles)


def unit_of_reference(options, units, scale):
    """In which unit a reference has its times (run_data.parse_scale)."""
    if scale == 1:
        return units.time
    return "" if options.time_scale else r"$\sqrt{H_0/g}$"


def columns_of_outlines(count, width, height):
    """How many panels of these proportions stand side by side."""
    if count == 1 or width > 5 * height:
        return 1
    return min(3, count) if width < 0.8 * height or count > 6 else 2


def plot_outlines(options, run, reference, scale):
    profiles = run_data.without_repeat(
        [p for p in run_data.read_profiles(options.directory)
         if len(p.x) > 1])
    if not has_shape(profiles):
        print("plot: no outlines.png, as profile.csv holds "
              + ("no outline" if not profiles else "a level surface only"),
              file=sys.stderr)
        return None
    outlines = [Outline(p, reference, scale)
                for p in run_data.choose(profiles, 12)]
    left = min(o.x[0] for o in outlines)
    width = 1.03 * (max(o.right() for o in outlines) - left)
    height = 1.08 * max(o.top() for o in outlines)
    note = ", ".join((["along $x$ through the top"] if run.solid else []) + (
        [f"{len(outlines)} of {len(profiles)} times"]
        if len(profiles) > len(outlines) else []))
    other = any(o.other for o in outlines)
    sheet = Sheet(run, len(outlines),
                  columns_of_outlines(len(outlines), width, height),
                  width / height, bars=False, note=note,
                  handles=legend_of_outlines(run, outlines, reference),
                  lines=2 if other else 1, least=3.3 if other else 2.3)
    for ax, outline in zip(sheet.axes, outlines):
        outline.draw(ax, run, unit_of_reference(options, run.units, scale))
        ax.set_xlim(left, left + width)
        ax.set_ylim(0, height)
    sheet.name_axes(run.units)
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
    """Names of the tracers that grains are in."""
    return [n for n, title in snapshot.titles.items()
            if "tracer" in title and snapshot.has_grains()
            and snapshot.fields[n].max() > 0.5]


def legend_of_tracers(run, snapshot):
    return [line(run.colour(n), n, "--") for n in tracers_of(snapshot)]


def draw_contour(ax, window, x, z, v, colour, style):
    """Where a raster of fractions is 1/2, up to the sides of the window."""
    if min(v.shape) < 2 or not np.nanmin(v) < 0.5 < np.nanmax(v):
        return []
    x, z = np.r_[window[0], x, window[1]], np.r_[window[2], z, window[3]]
    return [ax.contour(x, z, np.pad(v, 1, mode="edge"), [0.5],
                       colors=[colour], linewidths=1.1, linestyles=[style])]


def draw_contours(ax, snapshot, window, spacing, run=None):
    """The surface of the grains, and (`run`) the borders of tracers in them,
    those that touch with the dashes of one in the gaps of the other; returns
    what was drawn."""
    x, z, grains = snapshot.sample(snapshot.grains(), window, spacing)
    drawn = draw_contour(ax, window, x, z, grains, INK, "-")
    for k, name in enumerate(tracers_of(snapshot) if run else []):
        v = snapshot.sample(snapshot.fields[name], window, spacing)[2]
        v = np.where(grains > 0.5, v, np.nan)
        lines = draw_contour(ax, window, x, z, v, run.colour(name),
                             (3 * (k % 2), (3, 3)))
        for contour in lines:
            edge_in_white(contour)
        drawn += lines
    return drawn


def edge_in_white(contour):
    """Let lines be seen on any ground."""
    effect = [withStroke(linewidth=2.2, foreground="white")]
    for artist in getattr(contour, "collections", [contour]):
        artist.set_path_effects(effect)


def tint_tracers(ax, snapshot, window, spacing, run):
    """The grains of each tracer in its colour."""
    c = snapshot.sample(snapshot.grains(), window, spacing)[2]
    for name in tracers_of(snapshot):
        v = snapshot.sample(snapshot.fields[name], window, spacing)[2]
        rgba = np.empty((*v.shape, 4))
        rgba[..., :3] = to_rgb(run.colour(name))
        rgba[..., 3] = 0.4 * np.clip(np.nan_to_num(np.minimum(v, c)), 0, 1)
        ax.imshow(rgba, origin="lower", extent=window, aspect="auto",
                  interpolation="nearest", zorder=1.5)  # above the cells


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
    """A raster of a field, as opaque as there are grains, or of the gas where
    there are none at all; returns the image."""
    image = ax.imshow(colours(snapshot, window, spacing, values, norm, cmap),
                      origin="lower", extent=window, interpolation="nearest",
                      aspect="auto")
    return image


def colours(snapshot, window, spacing, values, norm, cmap):
    _, _, v = snapshot.sample(values, window, spacing)
    rgba = plt.get_cmap(cmap)(norm(np.nan_to_num(v)))
    if snapshot.has_grains():
        _, _, c = snapshot.sample(snapshot.grains(), window, spacing)
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
    grains = snapshot.grains() > 0.5
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


def note_of_fields(run, snapshot):
    note = (f"$t$ = {snapshot.time:.4g} {run.units.time}, "
            f"{snapshot.nleaves} cells")
    if run.solid:
        note += f", cut at $y$ = {snapshot.cut:.3g} {run.units.length}"
    return note + ("" if snapshot.has_grains() else ", no grains, fields of the gas")


def plot_fields(options, run):
    paths = run_data.find_snapshots(options.directory)
    if not paths:
        return None
    snapshot = run_data.Snapshot(paths[-1]).slice()
    window = window_of(snapshot)
    spacing = raster_spacing(snapshot, window)
    window = snap_window(window, snapshot, spacing)
    panels = panels_of(snapshot, run.units)
    aspect = (window[1] - window[0]) / (window[3] - window[2])
    columns = 1 if aspect > 3.5 else 2 if aspect > 0.5 else 1 + len(panels)
    sheet = Sheet(run, 1 + len(panels), columns, aspect, bars=True,
                  note=note_of_fields(run, snapshot),
                  handles=legend_of_tracers(run, snapshot))
    draw_cells(sheet.axes[0], snapshot, window, snapshot.grains(),
               Normalize(0, 1), GRAINS, not options.no_grid)
    tint_tracers(sheet.axes[0], snapshot, window, spacing, run)
    draw_contours(sheet.axes[0], snapshot, window, spacing, run)
    draw_bar(sheet.bars[0], Normalize(0, 1), GRAINS)
    sheet.axes[0].set_title("grains" + ("" if options.no_grid
                                        else " and grid"), loc="left", pad=7)
    for ax, bar, (title, values, norm, cmap) in zip(
            sheet.axes[1:], sheet.bars[1:], panels):
        draw_grains(ax, snapshot, window, spacing, values, norm, cmap)
        draw_contours(ax, snapshot, window, spacing, run)
        draw_bar(bar, norm, cmap)
        ax.set_title(title, loc="left", pad=7)
    for ax in sheet.axes:
        ax.set_xlim(window[0], window[1])
        ax.set_ylim(window[2], window[3])
    sheet.name_axes(run.units)
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


def draw_length(ax, s, run):
    units = run.units
    radius = run.solid or units.across == "$r$"
    ax.plot(s["time"], s["front"], color=EARTH,
            label="radius of the front" if radius else "front")
    ax.plot(s["time"], s["height"], color=BLUE, label="height")
    ax.set_title("front and height of the heap", loc="left")
    ax.set_ylabel(label("length", units.length))
    if s["front"].min() >= 0:
        ax.set_ylim(bottom=0)


def draw_energy(ax, s, parameters, change):
    scale = abs(s["kinetic"][0] + s["potential"][0]) or 1.0
    for name, colour in (("potential", BLUE), ("kinetic", EARTH),
                         ("dissipated", RED), ("impact", GREEN),
                         ("numerical", GREY)):
        if name not in s:
            continue
        ax.plot(s["time"], s[name] / scale, color=colour, label=name_of_rest(
            parameters, change) if name == "numerical" else name)
    ax.set_title("energy of the grains", loc="left")
    ax.set_ylabel("energy / initial energy")


def draw_speed(ax, s, units):
    ax.plot(s["time"], s["max_speed"], color=GREEN)
    ax.set_ylabel(label("speed", units.field("m/s")))
    ax.set_ylim(bottom=0)
    rest = (run_data.arrest_time(s) if "mean_shear_rate" in s else None)
    text = "fastest grains"
    if rest is not None:
        text += f"; at rest after {rest:.3g} {units.time}"
        ax.axvline(rest, color=GREY, lw=0.8)
    ax.set_title(text, loc="left")


def draw_count(ax, s):
    ax.plot(s["time"], s["cells"], color=INK)
    ax.set_title("cells of the grid", loc="left")
    ax.set_ylabel("cells")
    ax.set_ylim(0, 1.05 * s["cells"].max())


def draw_column(ax, s, name):
    ax.plot(s["time"], s[name], color=INK)
    ax.set_title(name, loc="left")


def history_panels(s, run, change):
    """[function that draws on axes]: what the columns of the model allow, or
    else each of its columns but two."""
    panels = [
        (("front", "height"), lambda ax: draw_length(ax, s, run)),
        (("kinetic", "potential", "dissipated", "numerical"),
         lambda ax: draw_energy(ax, s, run.parameters, change)),
        (("max_speed",), lambda ax: draw_speed(ax, s, run.units)),
        (("cells",), lambda ax: draw_count(ax, s))]
    known = [draw for needs, draw in panels if all(n in s for n in needs)]
    return known or [lambda ax, n=name: draw_column(ax, s, n)
                     for name in s if name not in ("step", "time")]


def plot_history(options, run):
    s = run_data.read_series(options.directory)
    if len(s["time"]) < 2:
        return None
    volume = s.get("volume", np.ones(len(s["time"])))
    if not volume.any():
        print("plot: no history.png, as there are no grains", file=sys.stderr)
        return None
    change = volume / (volume[0] or volume.max()) - 1
    change = change[np.argmax(np.abs(change))]
    panels = history_panels(s, run, change)
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    fig, axes = plt.subplots(rows, columns, figsize=(4.8 * columns, 3.1 * rows),
                             sharex=True, squeeze=False, layout="constrained")
    for ax, draw in zip(axes.flat, panels):
        draw(ax)
        ax.margins(x=0)
        ax.grid(alpha=0.25, lw=0.6)
        if ax.get_legend_handles_labels()[0]:
            ax.legend(fontsize=9, loc="best")
    for ax in axes.flat[len(panels):]:
        ax.set_visible(False)
    for ax in axes.flat[len(panels) - columns:len(panels)]:  # lowest
        ax.set_xlabel(label("time", run.units.time))
        ax.tick_params(labelbottom=True)
    fig.suptitle("\n".join(run.title(4.8 * columns) + [words_on_volume(change)]),
                 fontsize=11)
    return save(fig, options, "history.png")


# Three dimensions


def plot_plan(options, run):
    if not run.solid:
        return None
    plans = run_data.choose(run_data.without_repeat(
        heap.read_plans(options.directory)), 6)
    if not plans or not any(p.height.any() for p in plans):
        return None
    plans = heap.around(plans)
    norm = Normalize(0, max(p.height.max() for p in plans))
    aspect = np.ptp(plans[0].x) / np.ptp(plans[0].y)
    sheet = Sheet(run, len(plans), min(3, len(plans)), aspect, bars=True,
                  note=label("height over the floor", run.units.length))
    for ax, bar, plan in zip(sheet.axes, sheet.bars, plans):
        heap.draw_plan(ax, plan, norm)
        draw_bar(bar, norm, heap.HEIGHTS)
        ax.set_title(f"$t$ = {plan.time:.3g} {run.units.time}", loc="left",
                     pad=3, fontsize=9)
    sheet.name_axes(run.units, "$y$")
    return save(sheet.fig, options, "plan.png")


def plot_heap(options, run):
    paths = run_data.find_snapshots(options.directory) if run.solid else []
    snapshots = [s for s in map(run_data.Snapshot, run_data.choose(paths, 4))
                 if s.has_grains() and VELOCITY in s.fields]
    if not snapshots:
        return None
    scene = heap.Scene(run, snapshots, options.renderer)
    norm = Normalize(0, max(map(top_speed, snapshots)) or 1.0)
    note = label("colour: speed", run.units.field("m/s"))
    sheet = Sheet(run, len(snapshots), min(2, len(snapshots)),
                  scene.view.aspect(), bars=True,
                  note=", ".join(filter(None, [note, scene.note()])))
    for ax, bar, snapshot in zip(sheet.axes, sheet.bars, snapshots):
        scene.prepare(ax)
        scene.draw(ax, snapshot, norm)
        draw_bar(bar, norm, heap.MOVING)
        ax.set_title(f"$t$ = {snapshot.time:.3g} {run.units.time}", loc="left",
                     pad=3, fontsize=9)
    return save(sheet.fig, options, "heap.png")


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
    values = values[snapshot.grains() > 0.5]
    return float(np.quantile(values, 0.99)) if values.size else 0.0


class SliceFilm:
    """Frames of a plane: the speed of the grains, their surface, tracers."""

    def __init__(self, run, snapshots):
        self.run = run
        window = film_window(snapshots)
        self.spacing = min(raster_spacing(s, window, 600) for s in snapshots)
        self.window = snap_window(window, snapshots[0], self.spacing)
        self.norm = Normalize(0, max(map(top_speed, snapshots)) or 1.0)
        aspect = (self.window[1] - self.window[0]) / (self.window[3]
                                                      - self.window[2])
        handles = {h.get_label(): h for snapshot in snapshots
                   for h in legend_of_tracers(run, snapshot)}
        self.sheet = Sheet(run, 1, 1, aspect, bars=True,
                           handles=[*handles.values()])
        self.ax = self.sheet.axes[0]
        self.image = draw_grains(self.ax, snapshots[0], self.window,
                                 self.spacing, speed(snapshots[0]), self.norm,
                                 "viridis")
        draw_bar(self.sheet.bars[0], self.norm, "viridis")
        self.sheet.name_axes(run.units)

    def draw(self, snapshot):
        """Draw a frame; returns what must go before the next one."""
        self.image.set_data(colours(snapshot, self.window, self.spacing,
                                    speed(snapshot), self.norm, "viridis"))
        return draw_contours(self.ax, snapshot, self.window, self.spacing,
                             self.run)


class SolidFilm:
    """Frames of the surface of a heap in 3D."""

    def __init__(self, run, snapshots, renderer):
        self.scene = heap.Scene(run, snapshots, renderer)
        self.norm = Normalize(0, max(map(top_speed, snapshots)) or 1.0)
        self.sheet = Sheet(run, 1, 1, self.scene.view.aspect(), bars=True,
                           note=self.scene.note())
        self.ax = self.sheet.axes[0]
        self.scene.prepare(self.ax)
        draw_bar(self.sheet.bars[0], self.norm, heap.MOVING)

    def draw(self, snapshot):
        return self.scene.draw(self.ax, snapshot, self.norm)


def film_of(options, run, snapshots):
    if run.solid and all(s.has_grains() for s in snapshots):
        return SolidFilm(run, snapshots, options.renderer)
    return SliceFilm(run, [s.slice() for s in snapshots])


def make_film(options, run):
    paths = run_data.choose(run_data.find_snapshots(options.directory),
                            options.max_frames)
    if len(paths) < 2:
        return []
    snapshots = [run_data.Snapshot(p) for p in paths]
    if VELOCITY not in snapshots[0].fields:
        return []
    film = film_of(options, run, snapshots)
    text = film.ax.set_title("", loc="left")
    writers = film_writers(options)
    for name, writer in writers:
        writer.setup(film.sheet.fig, options.output / name, dpi=90)
    for snapshot in snapshots:
        drawn = film.draw(snapshot)
        text.set_text(f"$t$ = {snapshot.time:.2f} {run.units.time}, "
                      + label("speed", run.units.field("m/s")))
        for _, writer in writers:
            writer.grab_frame()
        for artist in drawn:
            remove(artist)
    for _, writer in writers:
        writer.finish()
    sign_gif(options.output / "film.gif")
    plt.close(film.sheet.fig)
    return [options.output / name for name, _ in writers]


def film_writers(options):
    """[(name, writer)]."""
    writers = [("film.gif", PillowWriter(fps=options.fps))]
    if shutil.which("ffmpeg"):
        even = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
        writers.append(("film.mp4", FFMpegWriter(
            fps=options.fps, metadata={"comment": SIGNATURE}, extra_args=even)))
    return writers


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
    parser.add_argument("--renderer", choices=("vtk", "matplotlib"),
                        help="of surfaces in 3D, default vtk if it works")
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
    run = RunWords(parameters, options.directory)
    try:
        path = options.reference or run_data.find_reference(options.directory,
                                                            parameters)
        reference = run_data.Reference(path) if path else None
        scale = run_data.parse_scale(options.time_scale, parameters)
        written = [
            plot_outlines(options, run, reference, scale),
            plot_fields(options, run),
            plot_history(options, run),
            plot_plan(options, run),
            plot_heap(options, run),
        ]
        if not options.no_film:
            written += make_film(options, run)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"plot: {error}")
    for path in written:
        if path is not None:
            print(path)


if __name__ == "__main__":
    main()
