# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what a run of talus leaves in its directory."""
import csv
import math
import pathlib
import re
import sys
from typing import NamedTuple

try:  # here for all tools, which import this file before any of these
    import h5py
    import matplotlib
    import numpy as np
except ImportError:
    sys.exit(f"{pathlib.Path(sys.argv[0]).name}: needs numpy, h5py, matplotlib:"
             " run it with a python3 that has them, such as /usr/bin/python3")

from matplotlib.mathtext import MathTextParser

matplotlib.use("Agg")

FRACTION, VELOCITY = "fraction", "velocity"  # names of fields in snapshots


def read_parameters(directory):
    """{name: text} of parameters.csv; of two rows with one name the first."""
    path = pathlib.Path(directory) / "parameters.csv"
    if not path.exists():
        return {}
    with open(path, newline="", encoding="utf-8") as f:
        parameters = {}
        for row in list(csv.reader(f))[1:]:
            if len(row) >= 2:
                parameters.setdefault(row[0], row[1])
    return parameters


def number(parameters, name, default=None):
    """A parameter as a number, `default` if missing or no number."""
    try:
        return float(parameters[name])
    except (KeyError, ValueError):
        return default


def gravity_of(parameters):
    """Components of gravity; none if the run does not say."""
    return [float(s) for s in parameters.get("gravity", "").split(",")
            if s.strip()]


class Units:
    """Words for the axes: `across`, the coordinate, and the units that the parameters `length_unit` and
    `time_unit` name; without them L0 and sqrt(L0/g) where |gravity| = 1, else m
    and s. Where |gravity| = 1 fields are in these, g and the density rho of the
    grains."""

    def __init__(self, parameters):
        self.plain = abs(math.hypot(*gravity_of(parameters)) - 1) < 1e-12
        length, time = ((r"$L_0$", r"$\sqrt{L_0/g}$") if self.plain
                        else ("m", "s"))
        rings = parameters.get("coordinates") == "axisymmetric"
        self.across = "$r$" if rings else "$x$"
        self.length = parameters.get("length_unit", length)
        self.time = parameters.get("time_unit", time)

    def field(self, unit):
        """The unit of a field that the file gives in `unit`, "" if none."""
        if not self.plain:
            return "" if unit == "1" else re.sub(r"\^(\d)", r"$^\1$", unit)
        l = self.length.strip("$")
        one = l if re.fullmatch(r"[A-Za-z](_\w)?", l) else f"({l})"
        return {"m/s": rf"$\sqrt{{g\,{l}}}$", "1/s": rf"$\sqrt{{g/{one}}}$",
                "m^2/s^2": rf"$g\,{l}$", "Pa": rf"$\rho g\,{l}$",
                "Pa s": rf"$\rho\sqrt{{g\,{one}^3}}$"}.get(unit, "")


def title_lines(parameters, directory, most):
    """The title of the case, else the name of the directory, in lines of about
    `most` letters; a text that is no mathematics is taken as it is."""
    text = " ".join(parameters.get("title", "").split())
    text = text or pathlib.Path(directory).resolve().name
    try:
        MathTextParser("path").parse(text)
    except ValueError:
        text = text.replace("$", r"\$")
    lines = [""]
    for word in re.findall(r"(?:\$[^$]*\$|\S)+", text):  # formulas in one piece
        if lines[-1] and len(lines[-1]) + 1 + len(word) > most:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return lines


def label(text, unit):
    return f"{text} ({unit})" if unit else text


GREEK = {"alpha", "beta", "gamma", "delta", "epsilon", "eta", "theta", "kappa",
         "lambda", "mu", "nu", "rho", "sigma", "tau", "phi", "chi", "omega"}


def symbol(name):
    """A parameter's name as mathematics where it looks like it: mu_s, I0,
    delta_mu; else as it is."""
    if name.startswith("delta_"):
        return rf"$\Delta\{name[6:]}$" if name[6:] in GREEK else name
    match = re.fullmatch(r"([A-Za-z]+?)(?:_?([0-9]+)|_([A-Za-z]+))?", name)
    if not match or (len(match[1]) > 1 and match[1] not in GREEK):
        return name
    head = "\\" + match[1] if match[1] in GREEK else match[1]
    index = match[2] or match[3] or ""
    if len(index) > 1:
        index = rf"\mathrm{{{index}}}"
    return f"${head}_{{{index}}}$" if index else f"${head}$"


def read_table(path):
    """{column: array} of a csv file of numbers; a row cut short is left out."""
    with open(path, newline="", encoding="utf-8") as f:
        rows = list(csv.reader(f))
    header, rows = rows[0], [r for r in rows[1:] if len(r) == len(rows[0])]
    data = np.array(rows, dtype=float).reshape(len(rows), len(header))
    return {name: data[:, k] for k, name in enumerate(header)}


def read_series(directory):
    return read_table(pathlib.Path(directory) / "series.csv")


def arrest_time(series, part=0.01):
    """When a flow comes to rest: the last time at which the mean shear rate of
    the grains exceeds a `part` of its largest value. None if it never falls so
    far, or does not stay there. A regularised fluid only creeps; the rate falls
    by orders of magnitude within sqrt(H0/g), so the part matters little
    [valette_2019, section 3.5.1]."""
    rate = series["mean_shear_rate"]
    moving = np.nonzero(rate > part * rate.max())[0]
    if len(moving) == 0 or moving[-1] == len(rate) - 1:
        return None
    return float(series["time"][moving[-1]])


class Profile(NamedTuple):
    """The outline of a heap: heights over x [n], and of each tracer its part
    of them."""
    time: float
    x: np.ndarray
    height: np.ndarray
    layers: dict


def read_profiles(directory):
    """[Profile] in order of time. In 3D the row of columns along x that holds
    the highest one."""
    table = read_table(pathlib.Path(directory) / "profile.csv")
    names = [n for n in table if n not in ("time", "x", "y", "height")]
    profiles = []
    for time in np.unique(table["time"]):
        here = table["time"] == time
        if "y" in table:
            peak = np.argmax(np.where(here, table["height"], -1))
            here &= table["y"] == table["y"][peak]
        order = np.argsort(table["x"][here])
        x, height, *layers = (table[n][here][order]
                              for n in ("x", "height", *names))
        profiles.append(Profile(time, x, height, dict(zip(names, layers))))
    return profiles


def without_repeat(profiles, part=0.03):
    """The profiles without a last one so soon after the one before it, by a
    `part` of the time they span, that it shows the same."""
    if len(profiles) < 3:
        return profiles
    first, before, last = (profiles[k][0] for k in (0, -2, -1))
    return profiles[:-1] if last - before < part * (last - first) else profiles


def choose(items, most):
    """At most so many of a list, evenly, with the first and the last."""
    if len(items) <= most:
        return items
    return [items[round(k * (len(items) - 1) / (most - 1))]
            for k in range(most)]


class Reference:
    """Outlines to compare with: a csv file with lines of comment (#), a header
    `x,t=0.66,...` and a row per x; or a header `time,x,height`, the first under
    any name, and a row per point, heights 0 where there is none."""

    def __init__(self, path):
        self.name = pathlib.Path(path).stem.replace("_", " ")
        with open(path, encoding="utf-8") as f:
            lines = f.read().splitlines()
        self.comments = [s[1:].strip() for s in lines if s.startswith("#")]
        rows = list(csv.reader(s for s in lines
                               if s.strip() and not s.startswith("#")))
        data = np.array(rows[1:], dtype=float)
        if [s.strip() for s in rows[0][1:]] == ["x", "height"]:
            self.times, at = np.unique(data[:, 0], return_inverse=True)
            self.x, column = np.unique(data[:, 1], return_inverse=True)
            self.heights = np.zeros((len(self.times), len(self.x)))
            self.heights[at, column] = data[:, 2]
        else:
            self.times = np.array([float(re.sub(r"^t\s*=\s*", "", s))
                                   for s in rows[0][1:]])
            self.x, self.heights = data[:, 0], data[:, 1:].T

    def at(self, time, tolerance=5e-3):
        """The outline at a time, or None if there is none within a relative
        `tolerance`."""
        k = int(np.argmin(np.abs(self.times - time)))
        close = abs(self.times[k] - time) <= tolerance * max(time, 1e-9)
        return self.heights[k] if close else None


def find_reference(directory, parameters):
    """The file that the parameter `reference` names, or None. Looked for as it
    stands, beside the run, and in the examples."""
    name = parameters.get("reference", "")
    if not name:
        return None
    here = pathlib.Path(__file__).resolve().parent
    for base in (pathlib.Path("."), pathlib.Path(directory),
                 pathlib.Path(directory).resolve().parent,
                 here.parent / "examples"):
        if (base / name).is_file():
            return base / name
    return None


def parse_scale(text, parameters):
    """A length of time: a number, sqrt(number), or None for the default: the
    parameter `reference_time`, or else sqrt(a), a being the parameter of that
    name (the reference counts in sqrt(H0/g), the run in sqrt(L0/g), H0 = a
    L0)."""
    if text is None:
        return number(parameters, "reference_time",
                      math.sqrt(number(parameters, "a", 1.0)))
    match = re.fullmatch(r"\s*sqrt\((.*)\)\s*", text)
    return math.sqrt(float(match.group(1))) if match else float(text)


def integral(y, x):
    return float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x)))


class Outlines(NamedTuple):
    """Two outlines at the same points, the second one, of a reference, with its
    heights multiplied by `scale` so that both have the same area."""
    x: np.ndarray
    height: np.ndarray
    reference: np.ndarray
    scale: float


def align(x, height, reference_x, reference_height):
    """Outlines, taken as straight between their points and 0 beyond the last.
    """
    low = min(x[0], reference_x[0])
    high = max(x[-1], reference_x[-1])
    step = min(np.min(np.diff(x)), np.min(np.diff(reference_x))) / 4
    fine = np.linspace(low, high, int(math.ceil((high - low) / step)) + 1)
    h = np.interp(fine, x, height, right=0)
    r = np.interp(fine, reference_x, reference_height, right=0)
    scale = integral(h, fine) / integral(r, fine)
    return Outlines(fine, h, scale * r, scale)


def compare(x, height, reference_x, reference_height):
    """Symmetric difference of two outlines as a part of the area, with the
    heights of the reference scaled as in `align`: (difference, scale)."""
    fine, h, r, scale = align(x, height, reference_x, reference_height)
    return integral(np.abs(h - r), fine) / integral(h, fine), scale


def open_file(path):
    """The HDF5 file, or an error that names it."""
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise OSError(f"{path} cannot be read ({error}): it is damaged, or "
                      "was cut short as the disk was full; take it away to "
                      "draw the others") from None


class Snapshot:
    """One snapshot-*.h5: cells and the fields on them."""

    def __init__(self, path):
        with open_file(path) as f:
            vertices, cells = f["vertices"][:], f["cells"][:]
            self.time = float(f.attrs["time"])
            self.step = int(f.attrs["step"])
            names = _text(f.attrs["fields"]).split()
            self.fields = {name: f[name][:] for name in names}
            self.units = {n: _text(f[n].attrs["unit"]) for n in names}
            self.titles = {n: _text(f[n].attrs["title"]) for n in names}
            self.level = f["level"][:]
        self.dimension = vertices.shape[1]
        self.nleaves = len(cells)
        self.low = vertices[cells[:, 0]]
        self.high = vertices[cells[:, 2 if self.dimension == 2 else 6]]

    def slice(self):
        """In 3D the cells cut by a plane of constant y, as a snapshot of 2D:
        the plane through the heap's highest point next to its axis."""
        if self.dimension == 2:
            return self
        grains = self.fields[FRACTION] > 0.5 if FRACTION in self.fields else None
        top = self.high[:, 2].copy()
        if grains is not None and grains.any():
            top[~grains] = -np.inf
        peak = int(np.argmax(top))
        y = 0.5 * (self.low[peak, 1] + self.high[peak, 1])
        cut = (self.low[:, 1] <= y) & (y < self.high[:, 1])
        flat = Snapshot.__new__(Snapshot)
        flat.__dict__.update(self.__dict__)
        flat.dimension, flat.cut = 2, y
        flat.low, flat.high = self.low[cut][:, ::2], self.high[cut][:, ::2]
        flat.level = self.level[cut]
        flat.fields = {n: v[cut] for n, v in self.fields.items()}
        if VELOCITY in flat.fields:
            flat.fields[VELOCITY] = flat.fields[VELOCITY][:, [0, 2, 1]]
        return flat

    def grains(self):
        """The fraction of grains, 1 in a run without gas."""
        return self.fields.get(FRACTION, np.ones(len(self.low)))

    def has_grains(self):
        return bool(self.grains().any())

    def box_of_grains(self, part=0.999):
        """[x0, x1, z0, z1] of all but the outermost grains."""
        c = self.fields.get(FRACTION)
        low, high = self.low, self.high
        if c is None or not (c > 0.5).any():
            return [low[:, 0].min(), high[:, 0].max(),
                    low[:, 1].min(), high[:, 1].max()]
        box = []
        keep = c > 0.5
        weight = (c * np.prod(high - low, axis=1))[keep]
        for d in range(2):
            order = np.argsort(high[keep, d])
            sum_ = np.cumsum(weight[order])
            last = order[np.searchsorted(sum_, part * sum_[-1])]
            box += [low[keep, d].min(), high[keep, d][last]]
        return box

    def sample(self, values, window, spacing):
        """Values of the cells on a raster of the window [x0, x1, z0, z1]:
        (x, z, array [nz][nx]) at the centres of squares of edge `spacing`."""
        nx = max(1, int(round((window[1] - window[0]) / spacing)))
        nz = max(1, int(round((window[3] - window[2]) / spacing)))
        out = np.full((nz, nx), np.nan)
        origin = np.array([window[0], window[2]])
        begin = np.rint((self.low - origin) / spacing).astype(int)
        end = np.rint((self.high - origin) / spacing).astype(int)
        seen = ((end > 0) & (begin < [nx, nz])).all(axis=1)
        # a cell smaller than the raster still colours its own square
        end = np.maximum(end, begin + 1)
        begin = np.maximum(begin, 0)
        for i in np.nonzero(seen)[0]:
            out[begin[i, 1]:end[i, 1], begin[i, 0]:end[i, 0]] = values[i]
        x = window[0] + spacing * (np.arange(nx) + 0.5)
        z = window[2] + spacing * (np.arange(nz) + 0.5)
        return x, z, out


def _text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def find_snapshots(directory):
    return sorted(pathlib.Path(directory).glob("snapshot-*.h5"))
