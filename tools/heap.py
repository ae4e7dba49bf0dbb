# SPDX-License-Identifier: GPL-3.0-or-later
"""The heap of a run in three dimensions: its plan and its surface.

Planes of symmetry at the lower x and y are undone in the view of its surface, so
that a quarter of a heap is shown as a whole one. It is seen from above, without
perspective, by VTK where that works (Debian: python3-vtk9 and a display, which
Xvfb can be), else by matplotlib, on a coarser raster.
"""
import functools
import math
import subprocess
import sys
from typing import NamedTuple

import run_data  # first: it says so if one of the next is missing
from run_data import label
from sheet import EARTH, INK, RED, SAND
from surface import box_of_grains, normals, raster_of, surface_of
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

MOVING = LinearSegmentedColormap.from_list("moving", [SAND, "#d98a2b", RED])
HEIGHTS = LinearSegmentedColormap.from_list("heights",
                                            ["#f7efe0", SAND, EARTH])

# Plan


class Plan(NamedTuple):
    """Heights [ny][nx] over columns at x [nx] and y [ny], 0 where there are no
    grains."""
    time: float
    x: np.ndarray
    y: np.ndarray
    height: np.ndarray


def read_plans(directory):
    """[Plan] in order of time, all on the same columns."""
    table = run_data.read_table(directory / "profile.csv")
    if "y" not in table or len(table["x"]) < 2:
        return []
    sides = []
    for name in "xy":
        places = np.unique(table[name])
        spacing = np.diff(places).min() if len(places) > 1 else 1.0
        count = 1 + int(round((places[-1] - places[0]) / spacing))
        sides.append(places[0] + spacing * np.arange(count))
    plans = []
    for time in np.unique(table["time"]):
        here = table["time"] == time
        height = np.zeros((len(sides[1]), len(sides[0])))
        place = [np.searchsorted(s, table[n][here] + 1e-9 * (s[-1] - s[0]),
                                 side="right") - 1
                 for n, s in zip("xy", sides)]
        height[place[1], place[0]] = table["height"][here]
        plans.append(Plan(time, *sides, height))
    return plans


def around(plans):
    """The plans cut to a margin around the grains of all of them, those at the
    lower sides of the box drawn out to these."""
    covered = np.any([p.height > 0 for p in plans], axis=0)
    ends = [1 + np.nonzero(covered.any(axis=axis))[0][-1] for axis in (0, 1)]
    return [grown(p, *(n + max(2, n // 12) for n in ends)) for p in plans]


def grown(plan, nx, ny):
    """The plan on so many columns, empty where there were none, and half a cell
    more at the lower sides."""
    def side(x, n):
        spacing = x[1] - x[0] if len(x) > 1 else 1.0
        return np.r_[x[0] - 0.5 * spacing, x[0] + spacing * np.arange(n)]
    height = plan.height[:ny, :nx]
    height = np.pad(height, ((1, ny - height.shape[0]),
                             (1, nx - height.shape[1])))
    height[0], height[:, 0] = height[1], height[:, 1]
    return Plan(plan.time, side(plan.x, nx), side(plan.y, ny), height)


def contour_levels(highest, count=8):
    """Round heights for lines of contour, none of them 0."""
    levels = MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]).tick_values(0, highest)
    return levels[(levels > 1e-9 * highest) & (levels < highest)]


def draw_plan(ax, plan, norm):
    """Colours of height, contours with their heights, and the front, where the
    height is half the width of a column."""
    spacing = plan.x[-1] - plan.x[-2]
    levels = contour_levels(norm.vmax)
    covered = np.ma.masked_equal(plan.height, 0)
    ax.pcolormesh(plan.x, plan.y, covered, norm=norm, cmap=HEIGHTS,
                  shading="nearest", rasterized=True)
    here = levels[(levels < plan.height.max()) & (levels > spacing)]
    if len(here):
        lines = ax.contour(plan.x, plan.y, plan.height, here, colors=INK,
                           linewidths=0.6)
        between = (plan.height > here[0]) & (plan.height < here[-1])
        if between.sum() > 0.3 * (plan.height > 0).sum():  # not too close
            ax.clabel(lines, here[::2], fontsize=6.5, fmt="%g",
                      inline_spacing=2)
    if 0.5 * spacing < plan.height.max():
        ax.contour(plan.x, plan.y, plan.height, [0.5 * spacing], colors=EARTH,
                   linewidths=1.2)
    ax.set_aspect("equal", anchor="SW")
    ax.set_xlim(plan.x[0], plan.x[-1])
    ax.set_ylim(plan.y[0], plan.y[-1])


# View


class View:
    """Parallel lines of sight onto a floor [x0, x1, y0, y1] at z0 and what stands
    on it, up to z1: from the front, `turn` to the right and `lift` upwards."""

    def __init__(self, floor, z0, z1, turn=math.radians(32),
                 lift=math.radians(30)):
        self.floor, self.z0, self.z1 = floor, z0, z1
        s, c = math.sin(turn), math.cos(turn)
        self.right = np.array([c, s, 0])
        self.up = np.array([-s * math.sin(lift), c * math.sin(lift),
                            math.cos(lift)])
        self.towards = np.cross(self.right, self.up)  # the eye
        corners = self.project([[x, y, z] for x in floor[:2]
                                for y in floor[2:] for z in (z0, z1)])
        self.low, self.high = corners.min(axis=0), corners.max(axis=0)
        room = 0.07 * (self.high[0] - self.low[0])  # for numbers
        self.low, self.high = self.low - room, self.high + 0.25 * room

    def project(self, points):
        points = np.asarray(points, dtype=float)
        return np.stack([points @ self.right, points @ self.up], axis=-1)

    def extent(self):
        return [self.low[0], self.high[0], self.low[1], self.high[1]]

    def aspect(self):
        return float((self.high - self.low)[0] / (self.high - self.low)[1])

    def light(self):
        """From over the left shoulder."""
        light = self.towards - 0.9 * self.right + 0.9 * self.up
        return light / np.linalg.norm(light)


def draw_by_matplotlib(ax, view, surface, norm):
    """Triangles that face the eye, the far ones first."""
    p = surface.triangles
    n = normals(p)
    keep = n @ view.towards > 0
    p, n = p[keep], n[keep] / np.linalg.norm(n[keep], axis=1)[:, None]
    order = np.argsort(p.mean(axis=1) @ view.towards)
    colour = MOVING(norm(surface.speed[keep].mean(axis=1)))[order]
    bright = 0.5 + 0.55 * np.maximum(n @ view.light(), 0)
    colour[:, :3] = np.clip(colour[:, :3] * bright[order, None], 0, 1)
    cells = PolyCollection(view.project(p)[order], facecolors=colour,
                           edgecolors=colour, linewidths=0.3, zorder=2)
    ax.add_collection(cells)
    return cells


@functools.lru_cache(maxsize=None)
def vtk_works():
    """Whether VTK is installed and has what to draw on: without a display it
    aborts, and so is asked in a process of its own."""
    trial = ("import vtk\nw = vtk.vtkRenderWindow()\n"
             "w.SetOffScreenRendering(True)\nw.Render()\n")
    return subprocess.run([sys.executable, "-c", trial], check=False,
                          stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL).returncode == 0


class Scene:
    """The heap of some snapshots on its floor, all in one view; renderer: "vtk",
    "matplotlib" or None, the better one that works."""

    def __init__(self, run, snapshots, renderer=None):
        self.run = run
        if renderer is None:
            renderer = "vtk" if vtk_works() else "matplotlib"
        self.vtk = renderer == "vtk"
        self.mirrors = [run.parameters.get(f"boundary.{side}") == "symmetry"
                        for side in ("left", "front")]
        boxes = [b for b in map(box_of_grains, snapshots) if b is not None]
        low = np.min([b[0] for b in boxes], axis=0)
        high = np.max([b[1] for b in boxes], axis=0)
        side = snapshots[0].low.min(axis=0)
        for axis in range(2):
            if self.mirrors[axis] and low[axis] <= side[axis]:
                low[axis] = 2 * low[axis] - high[axis]
        room = 0.06 * (high - low)[:2].max()
        floor = [low[0] - room, high[0] + room, low[1] - room, high[1] + room]
        self.view = View(floor, low[2], high[2])

    def note(self):
        """What is not as it was computed."""
        planes = [f"${n}$" for n, m in zip("xy", self.mirrors) if m]
        return f"mirrored along {' and '.join(planes)}" if planes else ""

    def draw(self, ax, snapshot, norm):
        """Draw the grains of a snapshot; returns what was drawn."""
        if box_of_grains(snapshot) is None:
            return []
        most = 160 if self.vtk else 48 // (2 if any(self.mirrors) else 1)
        surface = surface_of(raster_of(snapshot, self.mirrors, most))
        if not self.vtk:
            return [draw_by_matplotlib(ax, self.view, surface, norm)]
        import render_vtk  # where it is installed
        colours = 255 * MOVING(norm(surface.speed.ravel()))[:, :3]
        pixels = render_vtk.render(surface.triangles, colours, self.view)
        return [ax.imshow(pixels, origin="lower", extent=self.view.extent(),
                          aspect="auto", zorder=2)]

    def prepare(self, ax):
        """Axes in the plane of the picture, with the floor and numbers at its
        front edges."""
        view, (x0, x1, y0, y1) = self.view, self.view.floor
        ax.set_axis_off()
        ax.set_xlim(view.low[0], view.high[0])
        ax.set_ylim(view.low[1], view.high[1])
        z = view.z0
        edge = view.project([[x0, y0, z], [x1, y0, z], [x1, y1, z],
                             [x0, y1, z]])
        ax.add_patch(Polygon(edge, facecolor="#eef0f2", edgecolor="#b8bcc2",
                             lw=0.7, zorder=1))
        for axis, name in enumerate("xy"):
            self._number(ax, axis, name)

    def _number(self, ax, axis, name):
        """Ticks, numbers and a name at the edge along x in front, or along y at
        the right."""
        x0, x1, y0, y1 = self.view.floor
        ends = [(x0, x1), (y0, y1)][axis]
        out = 0.02 * max(x1 - x0, y1 - y0)

        def place(s, beyond):
            return self.view.project(
                [s, y0 - beyond, self.view.z0] if axis == 0
                else [x1 + beyond, s, self.view.z0])
        ticks = MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(*ends)
        for s in ticks[(ticks > ends[0]) & (ticks < ends[1])]:
            ax.plot(*np.stack([place(s, 0), place(s, out)], axis=-1),
                    color=INK, lw=0.6, zorder=1)
            ax.text(*place(s, 1.6 * out), f"{s:g}", fontsize=7, va="top",
                    ha="center" if axis == 0 else "left")
        ax.text(*place(0.5 * sum(ends), (8 if axis == 0 else 5) * out),
                label(f"${name}$", self.run.units.length), fontsize=8,
                va="top", ha="center" if axis == 0 else "left")
