# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface of the grains of a snapshot in 3D, where their fraction is 1/2, as
triangles, from a raster of all cells."""
from typing import NamedTuple

import run_data  # first: it says so if numpy is missing
from run_data import VELOCITY
import numpy as np


class Raster(NamedTuple):
    """Cells of a box of edge `spacing` from `low` on: fraction of the grains and
    their speed, [nx][ny][nz]."""
    low: np.ndarray
    spacing: float
    fraction: np.ndarray
    speed: np.ndarray


def box_of_grains(snapshot):
    """(low, high) [3] of the leaves that hold grains, None without any."""
    keep = snapshot.grains() > 1e-3
    if not keep.any():
        return None
    return snapshot.low[keep].min(axis=0), snapshot.high[keep].max(axis=0)


def fill(snapshot, values, low, spacing, shape):
    """Values of the leaves on cells of a raster, all the leaves of a size at
    once."""
    out = np.zeros(shape)
    begin = np.rint((snapshot.low - low) / spacing).astype(int)
    size = np.rint((snapshot.high - snapshot.low)[:, 0] / spacing).astype(int)
    for n in np.unique(size):
        seen = (size == n) & (begin + n > 0).all(axis=1) & (
            begin < shape).all(axis=1)
        step = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"),
                        axis=-1).reshape(-1, 3)
        place = begin[seen][:, None, :] + step
        inside = ((place >= 0) & (place < shape)).all(axis=2)
        v = np.broadcast_to(values[seen][:, None], inside.shape)[inside]
        out[tuple(place[inside].T)] = v
    return out


def coarsen(v, factor):
    """Means over blocks of factor^3 cells, empty beyond the end."""
    more = [(0, -n % factor) for n in v.shape]
    nx, ny, nz = (n // factor for n in np.pad(v, more).shape)
    return np.pad(v, more).reshape(nx, factor, ny, factor, nz, factor).mean(
        axis=(1, 3, 5))


def mirror(raster, axis):
    """The raster and its image in the plane at its lower side of an axis."""
    low = raster.low.copy()
    low[axis] -= raster.spacing * raster.fraction.shape[axis]
    both = [np.concatenate([np.flip(v, axis), v], axis)
            for v in (raster.fraction, raster.speed)]
    return Raster(low, raster.spacing, *both)


def raster_of(snapshot, mirrors, most):
    """The grains on a raster of at most so many cells along an edge, before the
    mirrors [2] double it."""
    low, high = box_of_grains(snapshot)
    spacing = float((snapshot.high - snapshot.low).min())
    shape = np.rint((high - low) / spacing).astype(int)
    fraction = fill(snapshot, snapshot.grains(), low, spacing, shape)
    speed = fill(snapshot, np.linalg.norm(snapshot.fields[VELOCITY], axis=1),
                 low, spacing, shape)
    factor = -(-max(shape) // most)
    if factor > 1:
        mass = coarsen(fraction, factor)
        speed = coarsen(fraction * speed, factor) / np.maximum(mass, 1e-9)
        fraction, spacing = mass, spacing * factor
    raster = Raster(low, spacing, fraction, np.where(fraction > 0.01, speed, 0))
    side = snapshot.low.min(axis=0)
    for axis in range(2):
        if mirrors[axis] and abs(low[axis] - side[axis]) < 0.5 * spacing:
            raster = mirror(raster, axis)
    return raster


def soften(v):
    """Means of neighbours, weights 1, 2, 1 along each axis: fractions of cut
    cells are too steep for a smooth contour."""
    for axis in range(3):
        wide = np.pad(v, [(int(axis == d), int(axis == d)) for d in range(3)],
                      mode="edge")
        part = [np.take(wide, range(k, k + v.shape[axis]), axis)
                for k in range(3)]
        v = 0.25 * part[0] + 0.5 * part[1] + 0.25 * part[2]
    return v


# The six tetrahedra of a cube around its diagonal, corner k at the bits of k;
# and the edges that a surface cuts when the 1, 2, 3 highest of the corners of
# one, in order, are inside: triangles.
TETRAHEDRA = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7),
              (0, 4, 5, 7), (0, 5, 1, 7)]
CUTS = {1: [((0, 1), (0, 2), (0, 3))],
        2: [((0, 2), (0, 3), (1, 3)), ((0, 2), (1, 3), (1, 2))],
        3: [((0, 3), (1, 3), (2, 3))]}


def contour_triangles(v, level):
    """Where values at the nodes of a raster pass a level: triangles [n][3][3] in
    spacings from the first node, that wind around the way downwards."""
    corners = [(k & 1, k >> 1 & 1, k >> 2) for k in range(8)]
    n = np.array(v.shape) - 1
    at = np.stack([v[x:x + n[0], y:y + n[1], z:z + n[2]]
                   for x, y, z in corners])
    cut = (at.min(axis=0) < level) & (at.max(axis=0) >= level)
    at = at[:, cut]
    place = np.argwhere(cut)[:, None, :] + np.array(corners)  # [cells][8][3]
    found = []
    for tetrahedron in TETRAHEDRA:
        value = at[list(tetrahedron)].T
        order = np.argsort(-value, axis=1)
        value = np.take_along_axis(value, order, 1)
        node = np.take_along_axis(place[:, tetrahedron], order[..., None], 1)
        inside = (value >= level).sum(axis=1)
        for count, triangles in CUTS.items():
            w, x = value[inside == count], node[inside == count]
            # towards the lower corners
            out = x[:, count:].mean(axis=1) - x[:, :count].mean(axis=1)
            for edges in triangles:
                t = [(w[:, a] - level) / (w[:, a] - w[:, b]) for a, b in edges]
                p = np.stack([x[:, a] + s[:, None] * (x[:, b] - x[:, a])
                              for s, (a, b) in zip(t, edges)], axis=1)
                found.append(wind(p, out))
    return np.concatenate(found)


def normals(p):
    return np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def wind(p, out):
    """Triangles [n][3][3] in an order that makes their normals point out."""
    back = np.einsum("ij,ij->i", normals(p), out) < 0
    p[back] = p[back][:, ::-1]
    return p


class Surface(NamedTuple):
    """Triangles [n][3][3], m, and the speed of the grains below each of their
    corners [n][3]."""
    triangles: np.ndarray
    speed: np.ndarray


def surface_of(raster):
    """The surface of the grains, closed where they end at a side of the box."""
    fraction = np.pad(soften(raster.fraction), 1)
    p = contour_triangles(fraction, 0.5)
    n = normals(p)
    size = np.linalg.norm(n, axis=1)
    p, n = p[size > 1e-12], n[size > 1e-12] / size[size > 1e-12, None]
    # node k of the padded raster is cell k - 1; grains lie against the normal
    below = np.rint(p - 1 - 0.6 * n[:, None, :]).astype(int)
    below = np.clip(below, 0, np.array(raster.speed.shape) - 1)
    speed = raster.speed[tuple(np.moveaxis(below, 2, 0))]
    return Surface(raster.low + raster.spacing * (p - 0.5), speed)
